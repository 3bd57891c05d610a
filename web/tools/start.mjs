// How long it takes from starting `netcert serve` until a browser that is already open shows the region's roads:
//
//     node tools/start.mjs REGION.gpkg [RUNS]
//
// WebGL is drawn by the processor here, which a graphics card would spare. So the last tile is noted, too.

import { launch, missing, serve } from "../test/support.mjs";

const [db, runs = "5"] = process.argv.slice(2);
if (missing || !db) throw new Error(missing || "usage: node tools/start.mjs REGION.gpkg [RUNS]");
const browser = await launch();
console.log("| run | ready | page loaded | last tile of the first view | roads painted | tiles |");
console.log("| --- | --- | --- | --- | --- | --- |");
for (let run = 1; run <= Number(runs); run += 1) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
  const page = await context.newPage();
  const begin = performance.now();
  const since = () => `${((performance.now() - begin) / 1000).toFixed(2)} s`;
  let [tiles, last] = [0, ""];
  page.on("requestfinished", (request) => {
    if (!request.url().includes("/tiles/")) return;
    [tiles, last] = [tiles + 1, since()];
  });
  const server = await serve(db);
  const ready = since();
  await page.goto(server.direct);
  const loaded = since();
  await page.waitForFunction(
    () => {
      const map = globalThis.netcert?.map;
      if (!map?.loaded() || !map.areTilesLoaded()) return false;
      const layers = map.getStyle().layers.map((layer) => layer.id).filter((id) => /^(edge|overview)-/.test(id));
      return map.queryRenderedFeatures({ layers }).length > 0;
    },
    null,
    { timeout: 60_000, polling: "raf" },
  );
  console.log(`| ${run} | ${ready} | ${loaded} | ${last} | ${since()} | ${tiles} |`);
  await context.close();
  await server.stop();
}
await browser.close();
