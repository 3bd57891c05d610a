// Takes the pictures of docs/serve.md and docs/how-to/survey.md, with databases of the drawn region and of four real extracts:
//
//     node tools/screenshots.mjs FOLDER [NAME…]      FOLDER holds demo.gpkg, heidelberg.gpkg, andorra.gpkg, columbus.gpkg, victoria.gpkg; of
//                                                    `changes`, old.gpkg and new.gpkg, which are made if they are missing
//
// The extracts are not part of the repository; each picture says in its scene what it shows of them.

import { existsSync } from "node:fs";
import { mkdir, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { root, twoDatabases } from "../test/databases.mjs";
import { edgePixel, idle, launch, open, serve } from "../test/support.mjs";

const size = { width: 1280, height: 800 };
const wait = (page, ms) => page.waitForTimeout(ms);

/** The places of docs/how-to/survey.md. */
const survey = "126.026942,-30.203315;126.046615,-30.205563";

/** The page's answer under conditions. */
async function conditional(page) {
  await page.waitForSelector(".verdict.is-conditional", { timeout: 120_000 });
  await wait(page, 1500);
}

const scenes = {
  // Of the drawn region, certified for AU-ATRIPLE53 in its own lane and on the whole carriageway.
  "../how-to/survey/route": { db: "demo", hash: `#v=AU-ATRIPLE53&route=${survey}`, png: true, play: conditional },
  "../how-to/survey/slider": {
    db: "demo",
    hash: `#v=AU-ATRIPLE53&route=${survey}`,
    png: true,
    async play(page) {
      await conditional(page);
      await page.locator(".why").first().click();
      await page.click(".suppose-need button");
      await page.waitForSelector(".suppose-opens ul");
      await page.locator(".suppose").evaluate((section) => section.scrollIntoView({ block: "end" }));
    },
  },
  "../how-to/survey/sheet": {
    db: "demo",
    hash: `#v=AU-ATRIPLE53&route=${survey}`,
    png: true,
    async play(page) {
      await conditional(page);
      const href = await page.locator(".sheets a").first().getAttribute("href");
      const sheet = await page.context().newPage();
      await sheet.goto(new URL(href, page.url()).href);
      return sheet;
    },
  },
  heidelberg: {
    db: "heidelberg",
    hash: "#v=EU-SEMI16.5&at=13.6,49.4035,8.6815",
    async play(page) {
      const at = await edgePixel(page, "unsafe", -0.6);
      await page.mouse.click(at.x, at.y);
      await page.waitForSelector(".scene img");
      await page.mouse.move(180, 30); // where nothing is to hover over
    },
  },
  andorra: { db: "andorra", hash: "#v=EU-SEMI16.5", play: (page) => wait(page, 2500) },
  columbus: { db: "columbus", hash: "#v=US-WB40&with=US-WB67&at=12.2,39.968,-82.99", dark: true, play: (page) => wait(page, 2500) },
  victoria: {
    db: "victoria",
    hash: "#v=AU-ATRIPLE53&at=11,-37.69,145.44&route=145.46054,-37.68349;145.41485,-37.70221",
    play: (page) => drive(page, 0.52),
  },
  changes: {
    db: "new",
    before: "old",
    hash: "#v=AU-SEMI19&changes=1",
    async play(page) {
      await page.locator(".change-roads button", { hasText: "Bypass" }).click();
      await page.waitForSelector(".scene img");
      await page.locator(".changes").evaluate((section) => section.scrollIntoView());
      await page.mouse.move(180, 30);
    },
  },
  numbers: { db: "columbus", hash: "#v=US-WB67&stats=1", play: (page) => page.waitForSelector(".stats table").then(() => page) },
  drive: {
    db: "heidelberg-whole",
    hash: "#v=EU-SEMI16.5&policy=carriageway&route=8.6585,49.4065;8.675,49.41",
    dark: true,
    play: (page) => drive(page, 0.815),
  },
};

/** Opens the drive and stops at a share of the way. */
async function drive(page, share) {
  await page.click("text=Drive it", { timeout: 120_000 });
  await page.waitForSelector(".dock");
  await wait(page, 1000);
  await page.keyboard.press("Space");
  await page.evaluate((part) => {
    const slider = document.querySelector(".strip input");
    slider.value = String(part * Number(slider.max));
    slider.dispatchEvent(new Event("input"));
  }, share);
  await wait(page, 1500);
}

/** As WebP, by the browser's own encoder. */
async function webp(page, png) {
  const text = await page.evaluate(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [image.width, image.height];
    canvas.getContext("2d").drawImage(image, 0, 0);
    return canvas.toDataURL("image/webp", 0.72).split(",")[1];
  }, png.toString("base64"));
  return Buffer.from(text, "base64");
}

const [folder, ...names] = process.argv.slice(2);
const out = join(root, "docs/serve");
await mkdir(out, { recursive: true });
const browser = await launch();
for (const name of names.length > 0 ? names : Object.keys(scenes)) {
  const { db, before, hash, dark, png, play } = scenes[name];
  const [file, older] = [db, before].map((one) => one && join(folder, `${one}.gpkg`));
  if (older && !existsSync(older)) twoDatabases(folder);
  const server = await serve(file, ...(older ? ["--before", older] : []));
  const { page, close } = await open(browser, server.address, hash, { viewport: size, colorScheme: dark ? "dark" : "light" });
  await idle(page);
  const shown = (await play(page)) ?? page;
  await idle(page);
  await wait(page, 600);
  const picture = await shown.screenshot();
  const bytes = png ? picture : await webp(page, picture);
  const image = `${name}.${png ? "png" : "webp"}`;
  await mkdir(dirname(join(out, image)), { recursive: true });
  await writeFile(join(out, image), bytes);
  console.log(`${image} ${bytes.length} bytes`);
  await close();
  await server.stop();
}
await browser.close();
