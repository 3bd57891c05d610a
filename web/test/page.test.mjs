// The page in a real browser, on the drawn region: what people do, and what may go wrong.

import assert from "node:assert/strict";
import { test } from "node:test";
import { drawnRegion, edgePixel, idle, load, missing, open, text } from "./support.mjs";

const { palettes } = await load("map/palette.ts");

const { all, ask, inPage } = drawnRegion();

inPage("shows roads, a vehicle and how much of the roads it may use", "#v=AU-SEMI19", async (page) => {
  const drawn = await page.evaluate(() => globalThis.netcert.map.queryRenderedFeatures({ layers: ["edge-safe", "edge-unsafe"] }).length);
  assert.ok(drawn > 20, `${drawn} edges`);
  assert.match(await text(page, ".vehicle-name"), /\S/);
  await page.waitForSelector(".headline strong");
  assert.match(await text(page, ".headline"), /km\s+certified/);
  assert.match(await text(page, ".maplibregl-ctrl-attrib"), /OpenStreetMap/);
});

inPage("a certified lane that both directions share has a stripe, and the legend says what it means", "#v=AU-SEMI19", async (page) => {
  // A service road without lanes.
  await page.evaluate(() => globalThis.netcert.map.jumpTo({ center: [126.0642, -30.2308], zoom: 15 }));
  await idle(page);
  const found = await page.evaluate(() => globalThis.netcert.map.querySourceFeatures("roads", { sourceLayer: "edge" }).map(({ properties }) => properties));
  const shared = found.find(({ verdict, shared }) => verdict === "safe" && shared);
  const own = found.find(({ verdict, shared }) => verdict === "safe" && !shared);
  for (const [edge, is] of [[shared, true], [own, false]]) {
    const said = await ask(`/api/explain/${edge.edge_id}?vehicle=AU-SEMI19&policy=lane`);
    assert.equal(said.road.lane_shared, is, edge.edge_id);
  }
  const striped = await page.evaluate(() => globalThis.netcert.map.queryRenderedFeatures({ layers: ["edge-shared"] }).map(({ properties }) => properties.edge_id));
  assert.ok(striped.includes(shared.edge_id) && !striped.includes(own.edge_id), `${striped}`);
  assert.match(await text(page, ".shared-key"), /oncoming traffic waits/);
  await page.evaluate(() => globalThis.netcert.store.set({ policy: "carriageway" }));
  await page.waitForSelector(".shared-key", { state: "hidden" });
});

inPage("roads have the colour of the narrowest strip that is certified, and the legend its kilometres", "#v=AU-ATRIPLE53&policy=carriageway&by=strip&at=15,-30.2150,126.0500", async (page) => {
  const { strips } = palettes.light;
  const drawn = await page.evaluate(() => globalThis.netcert.map.queryRenderedFeatures({ layers: ["edge-safe"] }).map(({ properties }) => [properties.edge_id, properties.uses]));
  const kinds = new Set(drawn.map(([, uses]) => uses));
  assert.ok(kinds.has("lane") && kinds.has("carriageway"), `${[...kinds]}`);
  const colour = await page.evaluate(() => globalThis.netcert.map.getPaintProperty("edge-safe", "line-color"));
  for (const uses of ["lane", "carriageway"]) {
    assert.equal(colour[colour.indexOf(uses) + 1], strips[uses]);
    // The API says of the same road under which policies it is safe.
    const [id] = drawn.find(([, known]) => known === uses);
    const { certificates } = await ask(`/api/edges/${id}`);
    const safe = certificates.filter(({ vehicle, verdict }) => vehicle === "AU-ATRIPLE53" && verdict === "safe").map(({ policy }) => policy);
    assert.equal(safe.includes("lane"), uses === "lane", id);
  }
  const told = await ask("/api/stats?policy=carriageway");
  await page.waitForFunction(() => /km/.test(document.querySelector('[data-strip="none"] .legend-km')?.textContent ?? ""));
  for (const uses of ["lane", "carriageway", null]) {
    const km = told.strips.filter((row) => row.vehicle === "AU-ATRIPLE53" && row.uses === uses).reduce((sum, row) => sum + row.km, 0);
    const shown = Number((await text(page, `[data-strip="${uses ?? "none"}"] .legend-km`)).replace(/[^0-9.]/g, ""));
    assert.ok(Math.abs(shown - km) <= 0.5, `${uses}: ${shown} for ${km}`);
  }
  // Nothing was asked of the strip between: the legend has no line for it and says so.
  assert.equal(await page.locator('[data-strip="direction"]').count(), 0);
  assert.match(await text(page, ".strip-note"), /Own direction/);
  // A road that is not certified in its lane shows on which strip it is.
  await page.evaluate(() => globalThis.netcert.store.set({ policy: "lane" }));
  await idle(page);
  const lane = await page.evaluate(() => globalThis.netcert.map.queryRenderedFeatures({ layers: ["edge-unsafe"] }).map(({ properties }) => properties.uses));
  assert.ok(lane.includes("carriageway"), `${lane}`);
});

inPage("kilometres are those of the API", "#v=AU-ATRIPLE53", async (page) => {
  const { certificates } = await ask("/api/stats?policy=lane");
  const km = certificates.filter((row) => row.vehicle === "AU-ATRIPLE53" && row.verdict === "safe").reduce((sum, row) => sum + row.km, 0);
  await page.waitForSelector(".headline strong");
  const shown = Number((await text(page, ".headline strong")).replace(/[^0-9.]/g, ""));
  assert.ok(Math.abs(shown - km) <= 0.5, `${shown} for ${km}`);
});

inPage("a vehicle is chosen with the keyboard; the map, the link and the numbers follow", "#v=AU-SEMI19", async (page) => {
  await page.keyboard.press("v");
  const row = page.locator(".vehicle-row", { hasText: "AU-ATRIPLE53" });
  await row.focus();
  const tile = page.waitForResponse((response) => /\/tiles\/lane\/AU-ATRIPLE53\//.test(response.url()));
  await page.keyboard.press("Enter");
  assert.equal((await tile).status(), 200);
  assert.match(page.url(), /v=AU-ATRIPLE53/);
  assert.match(await text(page, ".vehicle-name"), /road train/i);
  await page.goBack();
  await page.waitForFunction(() => globalThis.netcert.store.state.vehicle === "AU-SEMI19");
});

inPage("hovering tells the number, clicking tells why", "#v=AU-SEMI19", async (page) => {
  const at = await edgePixel(page, "unsafe");
  await page.mouse.move(at.x, at.y);
  await page.waitForSelector(".hovercard:not([hidden])");
  assert.match(await text(page, ".hover-number"), /missing|narrow|Hinge|Steering/);
  await page.mouse.click(at.x, at.y);
  await page.waitForSelector(".explain .verdict");
  const id = new URL(page.url()).hash.match(/id=(\d+)/)[1];
  const { vehicle, policy } = await page.evaluate(() => globalThis.netcert.store.state);
  const said = await ask(`/api/explain/${id}?vehicle=${vehicle}&policy=${policy}`);
  assert.equal(said.verdict, "unsafe");
  await page.click(".explain-details summary");
  const shown = await text(page, ".explain");
  for (const sentence of said.reasons) assert.ok(shown.includes(sentence.replaceAll("`", "")), sentence);
  assert.ok(shown.includes(said.scope.replaceAll("`", "")), "the scope is said");
  if (said.picture) await page.waitForSelector(".scene img");
  await page.keyboard.press("Escape");
  await page.waitForSelector("#drawer", { state: "hidden" });
});

inPage("verdicts can be hidden, and the filter is part of the link", "#v=AU-SEMI19", async (page) => {
  await page.locator("[data-verdict=unsafe]").uncheck();
  await page.waitForFunction(() => globalThis.netcert.map.queryRenderedFeatures({ layers: ["edge-unsafe"] }).length === 0);
  assert.match(page.url(), /hide=unsafe/);
  await page.locator("[data-verdict=unsafe]").check();
  await page.waitForFunction(() => globalThis.netcert.map.queryRenderedFeatures({ layers: ["edge-unsafe"] }).length > 0);
});

inPage("a road is found by name and by id", "#v=AU-SEMI19", async (page) => {
  const at = await edgePixel(page, "safe");
  await page.keyboard.press("/");
  await page.keyboard.type(at.id);
  await page.waitForSelector(".hits [role=option]");
  await page.keyboard.press("Enter");
  await page.waitForSelector(".explain .verdict");
  assert.match(page.url(), new RegExp(`id=${at.id}`));
  const name = await page.evaluate(() => {
    const named = globalThis.netcert.map.queryRenderedFeatures({ layers: ["edge-safe", "edge-unsafe"] });
    return named.map((feature) => feature.properties.name).find(Boolean);
  });
  await page.keyboard.press("/");
  await page.keyboard.type(name);
  await page.waitForFunction((wanted) => document.querySelector(".hits")?.innerText.includes(wanted), name);
});

/** Pixels of what the map shows as chosen, by layer. */
const chosen = (page) =>
  page.evaluate(() => {
    const { map } = globalThis.netcert;
    const layers = ["glow", "selected-edge", "glow-afar"];
    return Object.fromEntries(layers.map((layer) => [layer, map.queryRenderedFeatures({ layers: [layer] }).length]));
  });

inPage("a road found by its name is chosen as by a click, seen near by and from afar, and part of the link", "#v=AU-SEMI19", async (page) => {
  const [hit] = await ask("/api/search?q=highway");
  assert.notEqual(hit.kind, "edge");
  await page.keyboard.press("/");
  await page.keyboard.type("highway");
  await page.waitForSelector(".hits [role=option]");
  await page.keyboard.press("Enter");
  await page.waitForSelector(".explain .verdict");
  assert.equal(await page.evaluate(() => globalThis.netcert.store.state.selected), hit.edge_id);
  assert.match(page.url(), new RegExp(`id=${hit.edge_id}`));
  const [edge] = await ask(`/api/search?q=${hit.edge_id}`);
  await page.evaluate(({ lon, lat }) => globalThis.netcert.map.jumpTo({ center: [lon, lat], zoom: 12 }), edge);
  await idle(page);
  const near = await chosen(page);
  assert.ok(near.glow > 0 && near["selected-edge"] > 0 && near["glow-afar"] === 0, JSON.stringify(near));
  await page.evaluate(() => globalThis.netcert.map.jumpTo({ zoom: 9 }));
  await idle(page);
  const far = await chosen(page);
  assert.ok(far.glow === 0 && far["selected-edge"] === 0 && far["glow-afar"] > 0, JSON.stringify(far));
  // Another theme changes the whole style.
  await page.keyboard.press("d");
  await page.waitForFunction(() => document.documentElement.dataset.theme === "dark");
  await idle(page);
  assert.deepEqual(await chosen(page), far);
  // Who is given the link sees the same.
  const again = await open(all.browser, all.address, new URL(page.url()).hash);
  await again.page.waitForSelector(".explain .verdict");
  await idle(again.page);
  assert.deepEqual(await chosen(again.page), far);
  await again.close();
  await page.keyboard.press("Escape");
  await idle(page);
  assert.deepEqual(await chosen(page), { glow: 0, "selected-edge": 0, "glow-afar": 0 });
});

inPage("numbers of roads stand on shields, in light and dark", "#v=AU-SEMI19", async (page) => {
  const { edge_id } = (await ask("/api/search?q=A87"))[0];
  const [edge] = await ask(`/api/search?q=${edge_id}`);
  await page.evaluate(({ lon, lat }) => globalThis.netcert.map.jumpTo({ center: [lon, lat], zoom: 13 }), edge);
  for (const theme of ["light", "dark"]) {
    if (theme === "dark") await page.keyboard.press("d");
    await page.waitForFunction((id) => globalThis.netcert.map.hasImage(id), `shield-${theme}`);
    await idle(page);
    const shown = await page.evaluate(() => globalThis.netcert.map.queryRenderedFeatures({ layers: ["shields"] }).map((one) => one.properties.ref));
    assert.ok(shown.includes("A87"), `${theme}: ${shown}`);
  }
});

inPage("each tile of the first view is asked for once", "#v=AU-SEMI19", async (page) => {
  const tiles = await page.evaluate(() => performance.getEntriesByType("resource").map((one) => one.name).filter((name) => name.includes("/tiles/")));
  assert.ok(tiles.length > 0);
  assert.deepEqual(tiles, [...new Set(tiles)]);
});

/** What the map shows of an explanation: how many shapes, by layer. */
const shapes = (page) =>
  page.evaluate(() => {
    const { map } = globalThis.netcert;
    const layers = ["ground", "swept", "path", "body", "label"].map((name) => `own-shapes-${name}`).filter((id) => map.getLayer(id));
    return Object.fromEntries(layers.map((id) => [id.replace("own-shapes-", ""), map.queryRenderedFeatures({ layers: [id] }).length]));
  });

inPage("an explained turn is drawn on the map with a key, in both themes, and closing removes it", "#v=AU-SEMI19&policy=carriageway", async (page) => {
  const turn = await page.evaluate(async () => {
    const edges = globalThis.netcert.map.queryRenderedFeatures({ layers: ["edge-safe"] });
    for (const id of new Set(edges.map(({ properties }) => String(properties.edge_id)))) {
      const { turns } = await (await fetch(`/api/edges/${id}?vehicle=AU-SEMI19&policy=carriageway`)).json();
      const found = turns.find((one) => one.verdict === "safe");
      if (found) return found.turn_id;
    }
    return null;
  });
  assert.ok(turn, "the drawn region has a safe turn");
  const said = await ask(`/api/explain/${turn}/map.geojson?vehicle=AU-SEMI19&policy=carriageway`);
  const tightest = said.features.find(({ properties }) => properties.part === "tightest");
  assert.deepEqual(await shapes(page), {}, "nothing is drawn at first");
  await page.evaluate((selected) => globalThis.netcert.store.set({ selected }), turn);
  await page.waitForSelector(".map-key li");
  await page.evaluate((center) => globalThis.netcert.map.jumpTo({ center, zoom: 18 }), tightest.geometry.coordinates);
  await idle(page);
  await page.waitForFunction(() => globalThis.netcert.map.queryRenderedFeatures({ layers: ["own-shapes-label"] }).length > 0);
  const drawn = await shapes(page);
  for (const [layer, count] of Object.entries(drawn)) assert.ok(count > 0, layer);
  assert.equal(Object.keys(drawn).length, 5);
  // The key names each unit, in words.
  const key = await text(page, ".map-key");
  for (const words of ["this turn may use", "Planned path", "least room", "prime mover sweeps", "semi-trailer sweeps"]) assert.ok(key.includes(words), words);
  // The ring stands at the tightest place and not at the node.
  const off = await page.evaluate((at) => {
    const ring = document.querySelector(".limit").getBoundingClientRect();
    const canvas = globalThis.netcert.map.getCanvas().getBoundingClientRect();
    const { x, y } = globalThis.netcert.map.project(at);
    return Math.hypot(ring.x + ring.width / 2 - canvas.x - x, ring.y + ring.height / 2 - canvas.y - y);
  }, tightest.geometry.coordinates);
  assert.ok(off < 3, `${off} px`);
  const edge = () => page.evaluate(() => globalThis.netcert.map.getPaintProperty("own-shapes-edge", "line-color"));
  const before = await edge();
  await page.keyboard.press("d");
  await page.waitForFunction((was) => globalThis.netcert.map.getPaintProperty("own-shapes-edge", "line-color") !== was, before);
  await idle(page);
  assert.deepEqual(Object.keys(await shapes(page)), Object.keys(drawn));
  await page.click(".drawer-close");
  await page.waitForFunction(() => globalThis.netcert.map.queryRenderedFeatures({ layers: ["own-shapes-ground", "own-shapes-swept", "own-shapes-path"] }).length === 0);
  assert.equal(await page.locator(".limit").count(), 0);
});

inPage("a road that was found is shown whole, with what is certified of it and the way to its worst piece", "#v=AU-SEMI19", async (page) => {
  const [hit] = await ask("/api/search?q=highway");
  await page.keyboard.press("/");
  await page.keyboard.type("highway");
  await page.waitForSelector(".hits [role=option]");
  await page.keyboard.press("Enter");
  await page.waitForSelector(".whole-road:not([hidden]) button.link");
  const { vehicle, policy } = await page.evaluate(() => globalThis.netcert.store.state);
  const ref = hit.by_ref === null ? "" : `&ref=${encodeURIComponent(hit.by_ref)}`;
  const { summary, scope } = await ask(`/api/road?way=${hit.id}${ref}&vehicle=${vehicle}&policy=${policy}`);
  const shown = await text(page, ".whole-road");
  assert.ok(shown.includes(`${summary.pieces} pieces`) && shown.includes("certified"), shown);
  assert.ok(shown.includes(scope.replaceAll("`", "")), "the scope is said");
  await idle(page);
  assert.ok((await page.evaluate(() => globalThis.netcert.map.queryRenderedFeatures({ layers: ["own-whole-road"] }).length)) > 0);
  await page.locator(".whole-road button.link").click();
  await page.waitForFunction((id) => globalThis.netcert.store.state.selected === id, summary.worst.edge_id);
  await page.locator(".whole-road header button").click();
  await page.waitForSelector(".whole-road", { state: "hidden" });
  await idle(page);
  assert.equal(await page.evaluate(() => globalThis.netcert.map.queryRenderedFeatures({ layers: ["own-whole-road"] }).length), 0);
});

inPage("coordinates lead to the place", "#v=AU-SEMI19", async (page) => {
  await page.keyboard.press("/");
  await page.keyboard.type("-30.2, 126.03");
  await page.waitForSelector(".hits [role=option]");
  await page.keyboard.press("Enter");
  await page.waitForSelector(".whole-road:not([hidden])");
  await page.waitForFunction(() => Math.abs(globalThis.netcert.map.getCenter().lat + 30.2) < 0.01);
  assert.equal(await page.evaluate(() => globalThis.netcert.store.state.selected), null);
});

inPage("a search without result says so", "#v=AU-SEMI19", async (page) => {
  await page.keyboard.press("/");
  await page.keyboard.type("no such road anywhere");
  await page.waitForSelector(".hits .nothing");
});

inPage("a link to an edge that does not exist is answered in words", "#id=1234567890123", async (page, opened) => {
  await page.waitForSelector(".explain .problem");
  assert.match(await text(page, ".explain .problem"), /1234567890123/);
  // The browser itself reports the refusal.
  assert.ok(opened.errors.every((error) => /404/.test(error)), opened.errors.join("\n"));
  opened.errors.length = 0;
  const at = await edgePixel(page, "safe");
  await page.mouse.click(at.x, at.y);
  await page.waitForSelector(".explain .verdict");
});

inPage("a spoilt link shows the page as it is at first", "#v=nobody&policy=x&at=1,2&id=%27%3B--&route=a;b&hide=<b>", async (page) => {
  assert.equal(await page.evaluate(() => globalThis.netcert.store.state.selected), null);
  await page.waitForSelector(".headline strong");
});

/** Two places with a certified route between them: the ends of a certified edge that is long enough. */
async function routed(page) {
  return page.evaluate(() => {
    const edges = globalThis.netcert.map.queryRenderedFeatures({ layers: ["edge-safe"] });
    const lines = edges.flatMap(({ geometry }) => (geometry.type === "LineString" ? [geometry.coordinates] : geometry.coordinates));
    const span = (line) => Math.hypot(line.at(-1)[0] - line[0][0], line.at(-1)[1] - line[0][1]);
    const line = lines.sort((a, b) => span(b) - span(a))[0];
    const along = (share) => {
      const at = share * (line.length - 1);
      const [a, b] = [line[Math.floor(at)], line[Math.ceil(at)]];
      return a.map((degrees, axis) => degrees + (at % 1) * (b[axis] - degrees));
    };
    return [along(0.3), along(0.7)];
  });
}

inPage("two clicks give a certified route, and the drive runs in step with the strip", "#v=AU-SEMI19&policy=carriageway", async (page) => {
  await page.keyboard.press("r");
  await page.waitForSelector(".route .prompt");
  const ends = await routed(page);
  const pixels = await page.evaluate(([a, b]) => {
    const { map } = globalThis.netcert;
    const box = [Math.min(a[0], b[0]), Math.min(a[1], b[1]), Math.max(a[0], b[0]), Math.max(a[1], b[1])];
    map.fitBounds(box, { padding: { left: 420, right: 480, top: 150, bottom: 150 }, maxZoom: 16, animate: false });
    return [map.project(a), map.project(b)].map(({ x, y }) => ({ x, y }));
  }, ends);
  for (const { x, y } of pixels) await page.mouse.click(x, y);
  await page.waitForSelector(".route .verdict", { timeout: 60_000 });
  assert.match(await text(page, ".route"), /Certified as a whole/);
  assert.match(await text(page, ".route .scope"), /no permit/);
  assert.match(page.url(), /route=[-\d.,;]+/);
  await page.click("text=Drive it");
  await page.waitForSelector(".dock");
  const place = () => page.evaluate(() => Number(document.querySelector(".strip input").value));
  const from = await place();
  await page.waitForFunction((start) => Number(document.querySelector(".strip input").value) > start + 1, from, { timeout: 90_000 });
  assert.ok(await page.evaluate(() => Boolean(globalThis.netcert.map.getLayer("own-drive"))));
  // Another theme in between leaves the drive where it is.
  await page.keyboard.press("d");
  await page.waitForFunction(() => document.documentElement.dataset.theme === "dark" && globalThis.netcert.map.getLayer("own-drive"));
  await page.keyboard.press("Space");
  const stopped = await place();
  await page.waitForTimeout(300);
  assert.equal(await place(), stopped);
  await page.keyboard.press("Escape");
  await page.waitForSelector(".dock", { state: "detached" });
  assert.ok(await page.evaluate(() => !globalThis.netcert.map.getLayer("own-drive")));
});

inPage("two vehicles side by side move as one", "#v=AU-SEMI19&with=AU-ATRIPLE53", async (page) => {
  await page.waitForFunction(() => document.querySelectorAll(".maplibregl-canvas").length === 2);
  await page.waitForSelector(".pane-head .vehicle-certified");
  const seen = await page.evaluate(async () => {
    const { map } = globalThis.netcert;
    map.jumpTo({ zoom: map.getZoom() + 1 });
    return document.querySelectorAll(".maplibregl-ctrl-scale").length === 2 && [...document.querySelectorAll(".maplibregl-ctrl-scale")].map((scale) => scale.textContent);
  });
  assert.equal(seen[0], seen[1]);
  await page.keyboard.press("Escape");
  await page.waitForFunction(() => document.querySelectorAll(".maplibregl-canvas").length === 1);
});

inPage("the region in numbers, for every vehicle", "#v=AU-SEMI19", async (page) => {
  await page.keyboard.press("n");
  await page.waitForSelector(".stats table");
  const rows = await page.locator(".stats table >> nth=0 >> tbody >> tr").count();
  assert.equal(rows, 2);
  assert.match(await text(page, ".stats"), /What limits most/);
  // Each amount stands in its column, under its heading.
  const aside_px = await page.evaluate(() => {
    const table = document.querySelector(".stats table");
    const [heads, cells] = ["thead th", "tbody tr:first-child > *"].map((cell) => [...table.querySelectorAll(cell)].map((one) => one.getBoundingClientRect()));
    return heads.map((head, column) => Math.abs(head.right - cells[column].right));
  });
  assert.ok(Math.max(...aside_px) < 1, `${aside_px}`);
  assert.match(page.url(), /stats=1/);
  await page.keyboard.press("Escape");
  await page.waitForFunction(() => !location.hash.includes("stats"));
});

inPage("`safe` is never said without its scope", "#v=AU-SEMI19", async (page) => {
  await page.keyboard.press("?");
  await page.waitForSelector(".help[open]");
  await page.keyboard.press("Escape");
  const at = await edgePixel(page, "safe");
  await page.mouse.click(at.x, at.y);
  await page.waitForSelector(".explain .verdict");
  const bare = await page.evaluate(() => {
    const found = [];
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) {
      const { parentElement: parent, data } = walker.currentNode;
      if (/\bsafe\b/i.test(data) && !parent.closest(".scope, script, noscript")) found.push(data);
    }
    return found;
  });
  // In a sentence of the server's about another strip of road; the scope stands below in the same panel.
  const scope = await page.locator(".explain .scope").count();
  assert.ok(bare.length === 0 || scope === 1, bare.join("\n"));
  assert.ok(!(await text(page, "#side .legend")).match(/\bsafe\b/i));
});

inPage("a server that is busy for a moment is asked again, for tiles and for numbers", "#v=AU-SEMI19", async (page, opened) => {
  const asked = new Map();
  await page.route(/\/(api\/stats|api\/vehicles\?|api\/region|tiles\/)/, (route) => {
    const path = new URL(route.request().url()).pathname;
    asked.set(path, (asked.get(path) ?? 0) + 1);
    if (asked.get(path) > 1) return route.continue();
    const body = JSON.stringify({ title: "Busy just now", status: 503 });
    return route.fulfill({ status: 503, headers: { "retry-after": "1" }, contentType: "application/problem+json", body });
  });
  await page.reload();
  await page.waitForFunction(() => globalThis.netcert?.map.loaded(), null, { timeout: 60_000 });
  await idle(page);
  await page.waitForSelector(".headline strong");
  const drawn = await page.evaluate(() => globalThis.netcert.map.queryRenderedFeatures({ layers: ["edge-safe", "edge-unsafe"] }).length);
  assert.ok(drawn > 20, `${drawn} edges`);
  assert.ok(asked.has("/api/region") && asked.has("/api/stats") && [...asked.keys()].some((path) => path.startsWith("/tiles/")));
  for (const [path, times] of asked) assert.ok(times >= 2, path);
  // The browser itself tells of each 503.
  assert.ok(opened.errors.every((error) => error.includes("503")), opened.errors.join("\n"));
  opened.errors.length = 0;
});

inPage("narrow screens: nothing beside the screen, the legend unfolds", "#v=AU-SEMI19", async (page) => {
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= 390, `${wide} px`);
  assert.ok(await page.locator(".legend").isHidden());
  await page.click(".fold");
  assert.ok(await page.locator(".legend").isVisible());
}, { viewport: { width: 390, height: 780 } });

inPage("every control has a name, and dark follows the system", "#v=AU-SEMI19", async (page) => {
  assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), "dark");
  const token = (name) => page.evaluate((property) => getComputedStyle(document.documentElement).getPropertyValue(property), name);
  assert.ok(palettes.dark.room.includes(await token("--safe")), "the panel's colours are the map's");
  await page.keyboard.press("d");
  assert.ok(palettes.light.missing.includes(await token("--unsafe")));
  const nameless = await page.evaluate(() => {
    const all = [...document.querySelectorAll("button, input, select, [role=img]")];
    const name = (element) => element.getAttribute("aria-label") || element.textContent.trim() || element.labels?.[0]?.textContent.trim() || element.title;
    return all.filter((element) => !name(element)).map((element) => element.outerHTML.slice(0, 120));
  });
  assert.deepEqual(nameless, []);
}, { colorScheme: "dark" });

test("the page may run nothing but its own scripts", { skip: missing }, async () => {
  const answer = await fetch(`${all.address}/`);
  const policy = answer.headers.get("content-security-policy") ?? "";
  assert.match(policy, /default-src 'none'/);
  assert.match(policy, /script-src 'self'(;|$)/);
  assert.doesNotMatch(policy, /script-src[^;]*unsafe/);
});
