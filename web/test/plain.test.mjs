// Plain words first, units by choice, notes on the map, the welcome, and the printed sheet.

import assert from "node:assert/strict";
import { test } from "node:test";
import { createExpression } from "@maplibre/maplibre-gl-style-spec";
import { drawnRegion, edgePixel, idle, load, open, text } from "./support.mjs";

const { all, ask, inPage } = drawnRegion();

const { length, distance, roadLength, speakIn } = await load("units.ts");
const { coordinateText } = await load("coordinate.ts");
const { percent, refs, title } = await load("words.ts");
const { labels } = await load("map/labels.ts");

test("what is not whole does not read as whole", () => {
  const shares = [[0, 10], [0.001, 10], [0.5, 10], [7, 10], [9.94, 10], [9.99, 10], [10, 10], [0.1 + 0.2, 0.3]];
  assert.deepEqual(shares.map(([part, all]) => percent(part, all)), ["0 %", "< 0.1 %", "5.0 %", "70 %", "99 %", "> 99 %", "100 %", "100 %"]);
});

test("a shield has the first two numbers of a road", () => {
  const shields = labels({}, "light").find(({ id }) => id === "shields");
  const { result, value } = createExpression(shields.layout["text-field"], "layers[0].layout.text-field");
  assert.equal(result, "success", JSON.stringify(value));
  const shown = (ref) => value.evaluate({ zoom: 12 }, { type: "LineString", properties: { ref } }).toString();
  assert.deepEqual(["A 5", "I 405;US 30", "US 40;US 62;SR 16"].map(shown), ["A 5", "I 405 / US 30", "US 40 / US 62"]);
});

test("lengths are rounded to the cautious side, in metres and in feet", () => {
  speakIn("metres");
  assert.deepEqual([length(2.231, "up"), length(2.239, "down"), length(0.3, "down"), length(0.3, "up")], ["2.24 m", "2.23 m", "0.30 m", "0.30 m"]);
  assert.deepEqual([distance(999), distance(3414), roadLength(547_000)], ["999 m", "3.41 km", "547 km"]);
  speakIn("feet");
  // 2.231 m are 87.83 inches; 0.3048 m are a foot.
  assert.deepEqual([length(2.231, "up"), length(2.231, "down"), length(0.3048, "down"), length(0.3048, "up"), length(0, "down")], ["7 ft 4 in", "7 ft 3 in", "1 ft", "1 ft", "0 in"]);
  assert.deepEqual([distance(100), distance(3218.688), roadLength(160_934.4)], ["328 ft", "2.00 mi", "100 mi"]);
});

test("a place is written latitude first", () => {
  assert.equal(coordinateText([151.2152, -33.8571]), "−33.85710, 151.21520");
});

test("every number of a road is one of its own", () => {
  assert.deepEqual(refs("I 405;US 30"), ["I 405", "US 30"]);
  assert.deepEqual([refs(null), refs("")], [[], []]);
  assert.equal(title({ ref: "I 405;US 30", name: "Stadium Freeway" }), "I 405 / US 30 · Stadium Freeway");
});

/** An edge that is not certified for want of width, with a bound, and a width that would do. */
async function narrow(page, vehicle) {
  const ids = await page.evaluate(() => [...new Set(globalThis.netcert.map.queryRenderedFeatures({ layers: ["edge-unsafe"] }).map(({ properties }) => String(properties.edge_id)))]);
  for (const id of ids) {
    const said = await ask(`/api/explain/${id}?vehicle=${vehicle}&policy=lane`);
    if (said.reason === "width" && said.limiting?.rsc_m > -100 && said.hints.width_m) return said;
  }
  return assert.fail("the drawn region has a road that is too narrow");
}

inPage("an explanation begins with one plain sentence; γ and tolerances wait under Details", "#v=AU-ATRIPLE53", async (page) => {
  const said = await narrow(page, "AU-ATRIPLE53");
  await page.evaluate((selected) => globalThis.netcert.store.set({ selected }), said.road.edge_id);
  await page.waitForSelector(".explain .verdict");
  const { rsc_m, place } = said.limiting;
  const wide = Math.max(said.hints.width_m, said.suppose?.need ?? 0);
  const metres = (value) => `${(Math.ceil(value * 100 - 1e-6) / 100).toFixed(2)} m`;
  const sentence = await text(page, ".explain .headline-words");
  assert.ok(sentence.toLowerCase().startsWith(`the ${place.unit_name}’s`.toLowerCase()), sentence);
  assert.ok(sentence.includes(`would cross the edge of the lane by up to ${metres(-rsc_m)}; a lane nowhere narrower than ${metres(wide)} would do.`), sentence);
  const shown = await text(page, ".explain");
  assert.doesNotMatch(shown, /γ|tracking tolerance of ±/);
  assert.ok(shown.includes(said.scope.replaceAll("`", "")), "the scope is said all the same");
  await page.click(".explain-details summary");
  const more = await text(page, ".explain");
  for (const reason of [...said.reasons, ...said.hints_in_words]) assert.ok(more.includes(reason.replaceAll("`", "")), reason);
  // Feet, by choice: the same sentence, rounded up to inches; the choice is in the link and stays on this machine.
  await page.locator("[name=units][value=feet]").check({ force: true });
  await page.waitForFunction(() => / ft /.test(document.querySelector(".explain .headline-words")?.innerText ?? ""));
  const inches = Math.ceil(-rsc_m / 0.0254 - 1e-6);
  assert.match(await text(page, ".explain .headline-words"), new RegExp(`by up to ${inches >= 12 ? `${Math.floor(inches / 12)} ft` : `${inches} in`}`));
  assert.match(page.url(), /units=feet/);
  assert.match(await text(page, ".headline"), /mi\s+certified/);
  assert.match(await text(page, ".vehicle-facts"), /174 ft/);
  await page.evaluate(() => (location.hash = "#v=AU-ATRIPLE53&units=metres"));
  await page.waitForFunction(() => / m /.test(document.querySelector(".vehicle-facts").innerText));
});

inPage("feet are usual for vehicles of the United States, until the reader chooses", "#v=AU-SEMI19", async (page) => {
  const vehicles = await ask("/api/vehicles");
  const body = vehicles.map((one) => (one.id === "AU-SEMI19" ? { ...one, region: "US" } : one));
  await page.route("**/api/vehicles", (route) => route.fulfill({ json: body }));
  await page.reload();
  await page.waitForSelector(".headline strong");
  assert.match(await text(page, ".vehicle-facts"), /62 ft 4 in/);
  assert.ok(await page.locator("[name=units][value=feet]").isChecked());
  await page.locator("[name=units][value=metres]").check({ force: true });
  await page.reload();
  await page.waitForSelector(".headline strong");
  assert.match(await text(page, ".vehicle-facts"), /19\.00 m/);
});

inPage("a road's numbers are shields", "#v=AU-SEMI19", async (page) => {
  const [hit] = await ask("/api/search?q=highway");
  const said = await ask(`/api/explain/${hit.edge_id}?vehicle=AU-SEMI19&policy=lane`);
  said.road.ref = "I 405;US 30";
  await page.route(/\/api\/explain\/\d+\?/, (route) => route.fulfill({ json: said }));
  await page.evaluate((selected) => globalThis.netcert.store.set({ selected }), hit.edge_id);
  await page.waitForSelector(".explain .verdict");
  assert.deepEqual(await page.locator(".explain h2 .shield").allInnerTexts(), ["I 405", "US 30"]);
});

inPage("the evidence of a road is printed as a sheet: verdict, reasons, picture, where it comes from, and nothing else", "#v=AU-ATRIPLE53", async (page) => {
  const at = await edgePixel(page, "unsafe");
  await page.mouse.click(at.x, at.y);
  await page.waitForSelector(".explain .scene img");
  await page.evaluate(() => (window.print = () => (document.title = "printed")));
  await page.click("text=Print the evidence");
  assert.equal(await page.title(), "printed");
  await page.emulateMedia({ media: "print" });
  for (const shown of [".sheet-head", ".explain h2", ".explain .verdict", ".explain-details .ids", ".explain .scope", ".print-only"]) assert.ok(await page.locator(shown).first().isVisible(), shown);
  for (const hidden of ["#side", "#tools", "#maps", ".explain .tools", ".map-note", ".drawer-close"]) assert.ok(await page.locator(hidden).first().isHidden(), hidden);
  const region = await ask("/api/region");
  const sheet = await text(page, "#drawer");
  assert.match(sheet, /Evidence sheet: AU-ATRIPLE53, own lane/);
  assert.ok(sheet.includes(region.database_hash.slice(0, 16)) && sheet.includes(at.id), sheet);
  assert.match(sheet, /What decides/);
});

inPage("the map says what its scale leaves out, and where a region is that cannot be seen", "#v=AU-SEMI19&at=10.50,-30.23,126.05", async (page) => {
  assert.match(await text(page, ".map-note"), /Minor roads are not drawn/);
  await page.click(".map-note button");
  await page.waitForFunction(() => globalThis.netcert.map.getZoom() >= 12.99);
  await page.waitForSelector(".map-note", { state: "hidden" });
  await page.evaluate(() => globalThis.netcert.map.jumpTo({ center: [126.05, -30.23], zoom: 5 }));
  await page.waitForFunction(() => /small box/.test(document.querySelector(".map-note").innerText));
  await page.evaluate(() => globalThis.netcert.map.jumpTo({ center: [100, 10], zoom: 8 }));
  await page.waitForFunction(() => /out of sight/.test(document.querySelector(".map-note").innerText));
  await page.click(".map-note button");
  await page.waitForFunction(() => globalThis.netcert.map.getZoom() > 9 && globalThis.netcert.map.getBounds().contains([126.05, -30.23]));
});

inPage("a first visit is welcomed, takes an example trip in one click, and is not welcomed again", "", async (page) => {
  assert.ok(await page.locator(".welcome").isVisible());
  assert.match(await text(page, ".welcome"), /no permit/);
  const region = await page.evaluate(() => globalThis.netcert.map.getBounds().toArray());
  assert.ok(region[0][0] < 126.05 && region[1][0] > 126.05);
  await page.click(".welcome .primary");
  await page.waitForSelector(".route .verdict.is-safe", { timeout: 120_000 });
  assert.ok(await page.locator("text=Drive it").isVisible());
  await page.evaluate(() => (location.href = "/"));
  await page.waitForFunction(() => globalThis.netcert?.map.loaded());
  await idle(page);
  assert.equal(await page.locator(".welcome").count(), 0);
});

inPage("the welcome goes when it is closed, and a link has none", "", async (page) => {
  await page.keyboard.press("Escape");
  await page.waitForSelector("#drawer", { state: "hidden" });
  const linked = await open(all.browser, all.address, "#v=AU-SEMI19");
  assert.equal(await linked.page.locator(".welcome").count(), 0);
  await linked.close();
});

inPage("two maps have one legend, and a route stands out of muted roads", "#v=AU-SEMI19&with=AU-ATRIPLE53", async (page) => {
  assert.match(await text(page, ".compare-key"), /Certified\s+Not certified\s+Forbidden\s+Unknown/);
  const opacity = () => page.evaluate(() => globalThis.netcert.map.getPaintProperty("edge-safe", "line-opacity"));
  assert.equal(await opacity(), 1);
  await page.evaluate(() => globalThis.netcert.store.set({ other: null, route: [[126.0515, -30.215], [126.05195, -30.235]] }));
  await page.waitForFunction(() => globalThis.netcert.map.getPaintProperty("edge-safe", "line-opacity") < 0.6);
  assert.ok(await page.locator(".compare-key").isHidden());
});
