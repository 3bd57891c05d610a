// What the browser tests stand on: a running `netcert serve`, a browser, and a page that remembers every error and every request that
// leaves the machine.
//
// Environment: CHROMIUM the browser.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { appendFileSync, existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { after, before, test } from "node:test";
import { join } from "node:path";
import { build } from "esbuild";
import { chromium } from "playwright-core";
import { proxy } from "../tools/proxy.mjs";
import { demoDatabase, first, program, root, twoDatabases } from "./databases.mjs";

export const browserPath = first([process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"]);

/** Why browser tests cannot run here, or false. */
export const missing = !program
  ? "no netcert program: cargo build --release"
  : !browserPath
    ? "no Chromium: apt install chromium, or set CHROMIUM"
    : false;
// `.ci/run` lists what was skipped, and fails where the browser is there after all.
if (missing && process.env.NETCERT_SKIPPED) {
  appendFileSync(process.env.NETCERT_SKIPPED, `${program ? "chromium" : "judge of the page"}\t${missing}\n`);
}

/** A TypeScript module of the page, loaded as it is built. */
export async function load(path) {
  const entry = join(root, "web/src", path);
  const made = await build({ entryPoints: [entry], bundle: true, format: "esm", write: false, platform: "neutral", mainFields: ["module"] });
  return import(`data:text/javascript;base64,${Buffer.from(made.outputFiles[0].contents).toString("base64")}`);
}

/**
 * Starts `netcert serve` on a free port, and before it the page of `dist`: what is tested is what would be committed, whatever
 * page the program was built with.
 */
export async function serve(db, ...more) {
  const child = spawn(program, ["serve", "--db", db, "--addr", "127.0.0.1:0", ...more], { stdio: ["ignore", "pipe", "pipe"] });
  let said = "";
  child.stderr.on("data", (chunk) => (said += chunk));
  const address = await new Promise((done, failed) => {
    let out = "";
    child.stdout.on("data", (chunk) => {
      out += chunk;
      const found = out.match(/http:\/\/[^\s]+/);
      if (found) done(found[0].replace(/\/$/, ""));
    });
    child.on("exit", (code) => failed(new Error(`netcert serve ended with ${code}: ${said}`)));
  });
  const page = await proxy(address, 0);
  const stop = () =>
    new Promise((done) => {
      page.close();
      page.closeAllConnections();
      child.on("exit", done);
      child.kill("SIGINT");
    });
  return { address: `http://127.0.0.1:${page.address().port}`, direct: address, stop };
}

export function launch() {
  return chromium.launch({
    executablePath: browserPath,
    args: [
      "--no-sandbox",
      "--disable-quic",
      "--no-first-run",
      "--disable-background-networking",
      "--disable-component-update",
      "--disable-sync",
      // WebGL without a graphics card.
      "--use-angle=swiftshader",
      "--enable-unsafe-swiftshader",
      "--ignore-gpu-blocklist",
    ],
  });
}

/** Database, server and browser together; `close` ends all three. `compared` adds an older database. `more` are arguments of the server. */
async function everything({ compared = false, more = [] } = {}) {
  const folder = mkdtempSync(join(tmpdir(), "netcert-page-"));
  const { before: older, db } = compared ? twoDatabases(folder) : { db: demoDatabase(folder) };
  const server = await serve(db, ...(older ? ["--before", older] : []), ...more);
  const browser = await launch();
  const close = async () => {
    await browser.close();
    await server.stop();
    rmSync(folder, { recursive: true, force: true });
  };
  return { address: server.address, direct: server.direct, db, browser, close };
}

/** Opens the page and waits until the map is drawn. `errors` and `strangers` fill as it is used. */
export async function open(browser, address, hash = "", options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, reducedMotion: "no-preference", ...options });
  const page = await context.newPage();
  const errors = [];
  const strangers = [];
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type()) && !harmless(message.text())) errors.push(message.text());
  });
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("request", (request) => {
    if (!request.url().startsWith(address) && !/^(data|blob):/.test(request.url())) strangers.push(request.url());
  });
  await page.goto(`${address}/${hash}`);
  await page.waitForFunction(() => globalThis.netcert?.map.loaded(), null, { timeout: 60_000 });
  return { page, errors, strangers, close: () => context.close() };
}

/** Of software rendering, not of the page. */
function harmless(text) {
  return /GPU stall|GL Driver Message|swiftshader|WebGL: CONTEXT_LOST|Automatic fallback to software/i.test(text);
}

/** Waits until tiles have come and nothing moves. */
export function idle(page) {
  return page.waitForFunction(() => {
    const { map } = globalThis.netcert;
    return map.loaded() && map.areTilesLoaded() && !map.isMoving();
  });
}

/** A pixel on an edge with this verdict and at least so much margin, away from the panels; `null` if there is none in sight. */
export function edgePixel(page, verdict, least_m = -1e9) {
  return page.evaluate(([wanted, least]) => {
    const { map } = globalThis.netcert;
    const layer = `edge-${wanted}`;
    const edges = map.getStyle().layers.map((one) => one.id).filter((id) => id.startsWith("edge-"));
    // No edge of another verdict lies so near that the pointer could mean it.
    const alone = (x, y) => map.queryRenderedFeatures([[x - 6, y - 6], [x + 6, y + 6]], { layers: edges }).every((one) => one.layer.id === layer);
    const canvas = map.getCanvas().getBoundingClientRect();
    for (let y = canvas.height * 0.2; y < canvas.height * 0.8; y += 3) {
      for (let x = canvas.width * 0.35; x < canvas.width * 0.65; x += 3) {
        const found = map.queryRenderedFeatures([x, y], { layers: [layer] });
        if (found.length > 0 && (found[0].properties.rsc_m ?? least) >= least && alone(x, y)) return { x: canvas.left + x, y: canvas.top + y, id: String(found[0].properties.edge_id) };
      }
    }
    return null;
  }, [verdict, least_m]);
}

/** The text that is seen of an element. */
export function text(page, selector) {
  return page.locator(selector).innerText();
}

/**
 * The drawn region for one file of tests, from its first test to its last. `inPage` makes tests with a page of their own, after which no
 * error may have been seen and nothing asked of strangers. `ask` asks the server. `all` is empty before the first test.
 */
export function drawnRegion(options) {
  const all = {};
  before(async () => {
    if (!missing) Object.assign(all, await everything(options));
  });
  after(() => all.close?.());
  const ask = (path) => fetch(all.address + path).then((answer) => answer.json());
  const inPage = (name, hash, run, context) =>
    test(name, { skip: missing }, async () => {
      const opened = await open(all.browser, all.address, hash, context);
      try {
        await idle(opened.page);
        await run(opened.page, opened);
        assert.deepEqual(opened.errors, []);
        assert.deepEqual(opened.strangers, []);
      } finally {
        // A request that a test has taken over may still be under way.
        await opened.page.unrouteAll({ behavior: "ignoreErrors" });
        await opened.close();
      }
    });
  return { all, ask, inPage };
}
