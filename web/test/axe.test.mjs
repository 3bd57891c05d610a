// WCAG 2.2 AA, as far as axe-core can tell, in the states in which people meet the page.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { drawnRegion, edgePixel } from "./support.mjs";

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const options = {
  runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"],
  // Off by default, because it is new.
  rules: { "label-content-name-mismatch": { enabled: true }, "target-size": { enabled: true } },
};

const { inPage } = drawnRegion({ more: ["--edit"] });

const CORNER = "v=AU-ATRIPLE53&policy=carriageway&route=126.026942,-30.203315;126.046615,-30.205563";
const narrow = { viewport: { width: 390, height: 780 } };
const dark = { colorScheme: "dark" };

async function explained(page, verdict) {
  const at = await edgePixel(page, verdict);
  await page.mouse.click(at.x, at.y);
  await page.waitForSelector(".explain .verdict");
  await page.click(".explain-details summary");
}

const states = [
  ["the welcome", "", () => {}],
  ["the welcome on a phone", "", () => {}, narrow],
  ["the page itself, in the dark", "#v=AU-SEMI19", () => {}, dark],
  ["roads by their strip, in the dark", "#v=AU-SEMI19&policy=carriageway&by=strip", (page) => page.waitForSelector(".strip-note"), dark],
  ["a road that is not certified", "#v=AU-ATRIPLE53", (page) => explained(page, "unsafe")],
  ["the form for a measurement, in the dark", "#v=AU-ATRIPLE53", async (page) => {
    await explained(page, "unsafe");
    await page.locator(".measure summary").first().click();
  }, dark],
  ["a certified road, in the dark", "#v=AU-SEMI19", (page) => explained(page, "safe"), dark],
  ["the fields of a route with suggestions", "#v=AU-SEMI19", async (page) => {
    await page.keyboard.press("r");
    await page.click("text=Add a stop");
    await page.keyboard.type("highway");
    await page.waitForSelector(".trip .hits [role=option]");
  }],
  ["a route under conditions", `#${CORNER}`, (page) => page.waitForSelector(".route .verdict.is-conditional", { timeout: 120_000 })],
  ["a blocked route, on a phone", "#v=AU-SEMI19", async (page) => {
    // The search for conditions is never answered.
    await page.route(/conditions=search/, () => {});
    await page.evaluate((hash) => (location.hash = hash), CORNER);
    await page.waitForSelector(".route .verdict.is-blocked", { timeout: 120_000 });
  }, narrow],
  ["a certified route and other ways", "#", async (page) => {
    await page.click(".welcome .primary");
    await page.waitForSelector(".route .verdict.is-safe", { timeout: 120_000 });
    await page.click(".others");
    await page.waitForSelector(".other-way, .route .note", { timeout: 120_000 });
  }],
  ["the drive", "#", async (page) => {
    await page.click(".welcome .primary");
    await page.waitForSelector(".route .verdict.is-safe", { timeout: 120_000 });
    await page.click("text=Drive it");
    await page.waitForSelector(".dock");
  }],
  ["two vehicles side by side", "#v=AU-SEMI19&with=AU-ATRIPLE53", (page) => page.waitForSelector(".pane-head .vehicle-certified")],
  ["the numbers", "#v=AU-SEMI19&stats=1", (page) => page.waitForSelector(".stats table")],
  ["the vehicles", "#v=AU-SEMI19", (page) => page.keyboard.press("v")],
  ["the help, in the dark", "#v=AU-SEMI19", (page) => page.keyboard.press("?"), dark],
];

for (const [name, hash, reach, more] of states) {
  inPage(`axe finds nothing in ${name}`, hash, async (page) => {
    await reach(page);
    // Colours are judged when nothing fades any more.
    await page.waitForTimeout(600);
    await page.evaluate(axe);
    const { violations, passes } = await page.evaluate((asked) => globalThis.axe.run(document, asked), options);
    const told = violations.map(({ id, help, nodes }) => `${id}: ${help}\n  ${nodes.slice(0, 3).map(({ html, any }) => `${html.slice(0, 160)} ${any[0]?.message ?? ""}`).join("\n  ")}`);
    assert.deepEqual(told, []);
    assert.ok(passes.length > 15 && passes.some(({ id }) => id === "label-content-name-mismatch" || id === "color-contrast"), "axe has looked");
  }, more);
}
