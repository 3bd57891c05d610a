// What lies behind the roads: from the database, under every road, and not there where the extract has none of it.

import assert from "node:assert/strict";
import { drawnRegion, idle } from "./support.mjs";

const { ask, inPage } = drawnRegion({ compared: true });

const layers = (page) => page.evaluate(() => globalThis.netcert.map.getStyle().layers.map(({ id }) => id));

inPage("a lake lies under the roads, and the town's name over them", "#v=AU-SEMI19&at=10.5,-30.226,126.01", async (page) => {
  const found = await page.evaluate(() => {
    const { map } = globalThis.netcert;
    const seen = (layer) => map.queryRenderedFeatures({ layers: [layer] }).map(({ properties }) => properties);
    return { water: seen("backdrop-water"), wood: seen("backdrop-wood"), places: seen("backdrop-places") };
  });
  assert.deepEqual(found, { water: [{ kind: "water" }], wood: [], places: [{ kind: "town", name: "Laketon" }] });
  const order = await layers(page);
  const roads = order.flatMap((id, at) => (/^(edge|overview|turn)-/.test(id) ? [at] : []));
  assert.ok(order.indexOf("backdrop-water") < Math.min(...roads) && order.indexOf("backdrop-places") > Math.max(...roads), order.join());
});

inPage("it changes its colours with the theme and asks for no tile beyond its deepest zoom", "#v=AU-SEMI19&at=15.5,-30.226,126.01", async (page) => {
  const colour = () => page.evaluate(() => globalThis.netcert.map.getPaintProperty("backdrop-water", "fill-color"));
  const before = await colour();
  assert.equal((await page.evaluate(() => globalThis.netcert.map.queryRenderedFeatures({ layers: ["backdrop-water"] }).length)) > 0, true);
  await page.emulateMedia({ colorScheme: "dark" });
  await page.waitForFunction((before) => globalThis.netcert.map.getPaintProperty("backdrop-water", "fill-color") !== before, before);
  await idle(page);
  const { backdrop } = await ask("/api/region");
  const asked = await page.evaluate(() => performance.getEntriesByType("resource").map(({ name }) => name.match(/\/backdrop\/(\d+)\//)?.[1]).filter(Boolean));
  assert.ok(asked.length > 0 && asked.every((zoom) => Number(zoom) <= backdrop.max_zoom), asked.join());
});
