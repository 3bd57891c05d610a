// What the browser tests stand on: a database of the drawn region, a running `netcert serve`, a browser, and a page that
// remembers every error and every request that leaves the machine.
//
// Environment: NETCERT the program, CHROMIUM the browser, NETCERT_TEST_DB a database instead of the drawn region's.

import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { copyFileSync, existsSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { after, before, test } from "node:test";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";
import { chromium } from "playwright-core";
import { proxy } from "../tools/proxy.mjs";

export const root = join(dirname(fileURLToPath(import.meta.url)), "../..");

const first = (paths) => paths.find((path) => path && existsSync(path));
export const program = first([process.env.NETCERT, join(root, "target/release/netcert"), join(root, "target/debug/netcert")]);
export const browserPath = first([process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"]);

/** Why browser tests cannot run here, or false. */
export const missing = !program
  ? "no netcert program: cargo build --release"
  : !browserPath
    ? "no Chromium: apt install chromium, or set CHROMIUM"
    : false;

/** A TypeScript module of the page, loaded as it is built. */
export async function load(path) {
  const entry = join(root, "web/src", path);
  const made = await build({ entryPoints: [entry], bundle: true, format: "esm", write: false, platform: "neutral", mainFields: ["module"] });
  return import(`data:text/javascript;base64,${Buffer.from(made.outputFiles[0].contents).toString("base64")}`);
}

/** The drawn region, certified for two vehicles under two policies. */
export function demoDatabase(folder) {
  if (process.env.NETCERT_TEST_DB) return process.env.NETCERT_TEST_DB;
  const db = join(folder, "demo.gpkg");
  const run = (...args) => execFileSync(program, ["--quiet", ...args], { stdio: ["ignore", "ignore", "inherit"] });
  const vehicles = ["--vehicle", "AU-SEMI19", "--vehicle", "AU-ATRIPLE53"];
  run("ingest", join(root, "data/demo.osm.pbf"), "--db", db, ...vehicles);
  run("certify", "--db", db, ...vehicles, "--corridor", "carriageway", "--needs", "all");
  return db;
}

/**
 * Two databases of the drawn region, `old.gpkg` and `new.gpkg`: in the newer one a road is measured narrower and another one wider, a
 * third one has a limit of weight, a fourth one is gone, and there is a new one. The newer one has a lake and a town, too.
 */
export function twoDatabases(folder) {
  const [before, db] = ["old.gpkg", "new.gpkg"].map((name) => join(folder, name));
  const run = (...args) => execFileSync(program, ["--quiet", ...args], { stdio: "ignore" });
  const extract = join(root, "data/demo.osm.pbf");
  run("ingest", extract, "--db", before, "--vehicle", "AU-SEMI19", "--vehicle", "AU-ATRIPLE53");
  copyFileSync(before, db);
  const measured = ["quantity,value,unit,way_id,source", "carriageway_width,5.4,m,15,tape", "carriageway_width,9,m,57,tape", "max_weight,12,t,36,sign"];
  writeFileSync(join(folder, "measured.csv"), measured.join("\n"));
  run("evidence", "add", join(folder, "measured.csv"), "--db", db);
  const gone = '<delete><way id="49" version="99"/></delete>';
  const node = '<node id="900001" version="1" lat="-30.2" lon="126.06"/>';
  const way = '<way id="900002" version="1"><nd ref="158"/><nd ref="900001"/><tag k="highway" v="primary"/><tag k="width" v="12"/><tag k="name" v="New Ring Road"/></way>';
  const shore = Array.from({ length: 24 }, (_, k) => {
    const [angle, reach] = [(2 * Math.PI * k) / 24, 1 + 0.15 * Math.sin(k * 1.7)];
    return [126.02 + 0.02 * reach * Math.cos(angle), -30.226 + 0.007 * reach * Math.sin(angle)];
  }).map(([lon, lat], k) => `<node id="${900010 + k}" version="1" lat="${lat.toFixed(7)}" lon="${lon.toFixed(7)}"/>`);
  const round = [...shore.keys(), 0].map((k) => `<nd ref="${900010 + k}"/>`).join("");
  const lake = `${shore.join("")}<way id="900050" version="1">${round}<tag k="natural" v="water"/></way>`;
  const town = '<node id="900060" version="1" lat="-30.215" lon="126"><tag k="place" v="town"/><tag k="name" v="Laketon"/></node>';
  writeFileSync(join(folder, "later.osc"), `<osmChange version="0.6">${gone}<create>${node}${way}${lake}${town}</create></osmChange>`);
  run("update", "--db", db, join(folder, "later.osc"), "--extract", extract);
  return { before, db };
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

/** Database, server and browser together; `close` ends all three. `compared` adds an older database. */
async function everything({ compared = false } = {}) {
  const folder = mkdtempSync(join(tmpdir(), "netcert-page-"));
  const { before: older, db } = compared ? twoDatabases(folder) : { db: demoDatabase(folder) };
  const server = await serve(db, ...(older ? ["--before", older] : []));
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
