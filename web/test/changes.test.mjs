// What changed since an older database, on the map and in the panel: as the server says, with the keyboard, and part of the link.

import assert from "node:assert/strict";
import { test } from "node:test";
import { drawnRegion, idle, missing, open, serve, text } from "./support.mjs";

const { all, ask, inPage } = drawnRegion({ compared: true });
const asked = "/api/changes?vehicle=AU-SEMI19&policy=lane";

/** How many changes of each kind are drawn in sight. */
const drawn = (page) =>
  page.evaluate(() => {
    const { map } = globalThis.netcert;
    const layers = map.getStyle().layers.map(({ id }) => id).filter((id) => /^own-changes-(became_[a-z]+|appeared|went)$/.test(id));
    const counts = layers.map((id) => [id.replace("own-changes-", ""), map.queryRenderedFeatures({ layers: [id] }).length]);
    return Object.fromEntries(counts.filter(([, count]) => count > 0));
  });
const opacity = (page) => page.evaluate(() => globalThis.netcert.map.getPaintProperty("edge-safe", "line-opacity"));

inPage("a switch draws the changes over muted roads, with the server's kilometres, and off again", "#v=AU-SEMI19", async (page) => {
  assert.deepEqual(await drawn(page), {});
  assert.equal(await opacity(page), 1);
  assert.match(await text(page, ".changes"), /Changes since old\.gpkg/);
  await page.locator("#changes").check();
  await page.waitForSelector(".change-rows li");
  const { sums, features } = await ask(asked);
  const rows = await page.locator(".change-rows li").evaluateAll((items) => items.map((item) => [item.dataset.change, item.innerText]));
  assert.deepEqual(rows.map(([change]) => change).sort(), sums.map(({ change }) => change).sort());
  for (const { change, km, edges, turns } of sums) {
    const [, said] = rows.find(([name]) => name === change);
    if (edges > 0) assert.ok(Math.abs(Number(said.match(/([\d.]+) km/)[1]) - km) <= 0.5, `${said} for ${km}`);
    if (turns > 0) assert.ok(said.includes(`${turns} turn`), said);
  }
  await page.waitForFunction(() => globalThis.netcert.map.getLayer("own-changes-went"));
  await page.evaluate(() => globalThis.netcert.map.jumpTo({ center: [126, -30.25], zoom: 10.2 }));
  await idle(page);
  const seen = await drawn(page);
  const kinds = new Set(features.filter(({ properties }) => properties.kind === "edge").map(({ properties }) => properties.change));
  assert.deepEqual(Object.keys(seen).sort(), [...kinds].sort());
  assert.ok(kinds.size >= 4, [...kinds].join());
  assert.ok((await opacity(page)) < 0.5);
  assert.match(page.url(), /changes=1/);
  // Another theme keeps them, in other colours.
  const colour = () => page.evaluate(() => globalThis.netcert.map.getPaintProperty("own-changes-went", "line-color"));
  const light = await colour();
  await page.keyboard.press("d");
  await page.waitForFunction((was) => globalThis.netcert.map.getPaintProperty("own-changes-went", "line-color") !== was, light);
  await idle(page);
  assert.deepEqual(await drawn(page), seen);
  await page.keyboard.press("s");
  await page.waitForFunction(() => globalThis.netcert.map.getPaintProperty("edge-safe", "line-opacity") === 1);
  await idle(page);
  assert.deepEqual(await drawn(page), {});
  assert.equal(await page.locator(".change-rows").count(), 0);
  assert.doesNotMatch(page.url(), /changes/);
});

inPage("the list of roads is stepped through with the keyboard, and tells before and after", "#v=AU-SEMI19&changes=1", async (page) => {
  const buttons = page.locator(".change-roads button");
  await buttons.first().waitFor();
  const { roads } = await ask(asked);
  assert.equal(await buttons.count(), roads.length);
  await buttons.first().focus();
  const focused = () => page.evaluate(() => [...document.querySelectorAll(".change-roads button")].indexOf(document.activeElement));
  for (const [key, at] of [["ArrowDown", 1], ["End", roads.length - 1], ["ArrowDown", roads.length - 1], ["ArrowUp", roads.length - 2], ["Home", 0]]) {
    await page.keyboard.press(key);
    assert.equal(await focused(), at, key);
  }
  assert.equal(await page.locator(".change-roads button[tabindex='0']").count(), 1);
  const forbidden = roads.findIndex(({ change }) => change === "became_forbidden");
  await buttons.nth(forbidden).focus();
  await page.keyboard.press("Enter");
  await page.waitForSelector(".explain .verdict");
  assert.equal(await focused(), forbidden, "the reader stays in the list");
  assert.equal(await buttons.nth(forbidden).getAttribute("aria-current"), "true");
  const said = await text(page, ".changed");
  assert.match(said, /Now forbidden[\s\S]*Before\s+Certified: [\d.]+ m to spare[\s\S]*Now\s+Forbidden: weight limit/);
  assert.match(page.url(), new RegExp(`id=${roads[forbidden].edge_id}`));
  // What is gone has no explanation and no request for one.
  const gone = roads.findIndex(({ change }) => change === "went");
  await buttons.nth(gone).click();
  await page.waitForFunction(() => document.querySelector(".changed")?.innerText.includes("Not in the newer database"));
  assert.match(await text(page, ".explain"), /Valley Road[\s\S]*nothing to explain/);
});

inPage("a click on a changed road opens its explanation with what changed, and who is given the link sees the same", "#v=AU-SEMI19&changes=1", async (page) => {
  await page.waitForSelector(".change-rows li");
  const { features } = await ask(asked);
  const { geometry, properties } = features.find(({ properties: one }) => one.change === "became_conditional" && one.length_m > 1000);
  const middle = geometry.coordinates[Math.floor(geometry.coordinates.length / 2)];
  await page.evaluate((center) => globalThis.netcert.map.jumpTo({ center, zoom: 15 }), middle);
  await idle(page);
  const at = await page.evaluate((wanted) => {
    const { map } = globalThis.netcert;
    const canvas = map.getCanvas().getBoundingClientRect();
    for (let y = canvas.height * 0.3; y < canvas.height * 0.7; y += 2) {
      for (let x = canvas.width * 0.4; x < canvas.width * 0.6; x += 2) {
        const [found] = map.queryRenderedFeatures([x, y], { layers: ["own-changes-became_conditional"] });
        if (found?.properties.id === wanted) return { x: canvas.left + x, y: canvas.top + y };
      }
    }
    return null;
  }, properties.id);
  assert.ok(at, "the change is drawn");
  await page.mouse.move(at.x, at.y);
  await page.waitForSelector(".hovercard:not([hidden])");
  assert.match(await text(page, ".hovercard"), /Now only under conditions[\s\S]*Before: certified/);
  await page.mouse.click(at.x, at.y);
  await page.waitForSelector(".explain .verdict");
  const said = await text(page, ".changed");
  assert.match(said, /Before\s+Certified/);
  assert.ok(said.includes(`${properties.after_need_width_m.toFixed(2)} m would do`), said);
  const again = await open(all.browser, all.address, new URL(page.url()).hash);
  await again.page.waitForSelector(".changed");
  await again.page.waitForSelector(".explain .verdict");
  assert.equal(await text(again.page, ".changed"), said);
  assert.deepEqual(again.errors, []);
  await again.close();
});

inPage("what the older database does not have cannot be switched on", "#v=AU-SEMI19&changes=1", async (page, opened) => {
  await page.waitForSelector(".change-rows li");
  const region = await ask("/api/region");
  region.before.sets = region.before.sets.filter(({ vehicle }) => vehicle !== "AU-ATRIPLE53");
  await page.route("**/api/region", (route) => route.fulfill({ json: region }));
  await page.reload();
  await page.waitForSelector(".change-rows li");
  await page.evaluate(() => globalThis.netcert.store.set({ vehicle: "AU-ATRIPLE53" }));
  await page.waitForFunction(() => document.querySelector("#changes").disabled);
  assert.match(await text(page, ".changes"), /no certificates of this vehicle/);
  assert.equal(await page.locator(".change-rows").count(), 0);
  await page.waitForFunction(() => globalThis.netcert.map.getPaintProperty("edge-safe", "line-opacity") === 1);
  assert.deepEqual(opened.errors, []);
});

inPage("what the server refuses is said in its words", "#v=AU-SEMI19", async (page, opened) => {
  const detail = "its file is gone; put it back";
  await page.route("**/api/changes*", (route) => route.fulfill({ status: 503, contentType: "application/problem+json", json: { title: "x", status: 503, detail } }));
  await page.locator("#changes").check();
  await page.waitForSelector(".changes [role=alert]");
  assert.equal(await text(page, ".changes [role=alert]"), detail);
  // The browser itself tells of the refusal.
  assert.ok(opened.errors.every((error) => error.includes("503")), opened.errors.join("\n"));
  opened.errors.length = 0;
});

inPage("where not all changes are drawn, those in view are asked for", "#v=AU-SEMI19&changes=1", async (page) => {
  const boxes = [];
  await page.route("**/api/changes*", async (route) => {
    const url = new URL(route.request().url());
    boxes.push(url.searchParams.get("bbox"));
    url.searchParams.set("limit", "3");
    url.host = new URL(all.address).host;
    await route.fulfill({ response: await route.fetch({ url: url.href }) });
  });
  await page.reload();
  await page.waitForFunction(() => /longest changes in view/.test(document.querySelector(".changes")?.innerText ?? ""));
  await page.waitForFunction(() => globalThis.netcert?.map.loaded());
  await page.evaluate(() => globalThis.netcert.map.jumpTo({ center: [126.0519, -30.2815], zoom: 16 }));
  const begin = Date.now();
  while (!boxes.some((box) => box?.startsWith("126.0")) && Date.now() < begin + 20_000) await page.waitForTimeout(50);
  assert.equal(boxes[0], null, "first everything");
  assert.ok(boxes.some((box) => box?.startsWith("126.0")), boxes.join(" "));
});

test("without an older database there is no switch, no key and no part of the link", { skip: missing }, async () => {
  const server = await serve(all.db);
  const { page, errors, close } = await open(all.browser, server.address, "#changes=1");
  await idle(page);
  assert.equal(await page.locator(".changes").count(), 0);
  await page.keyboard.press("s");
  assert.doesNotMatch(page.url(), /changes/);
  await page.keyboard.press("?");
  assert.doesNotMatch(await text(page, ".help"), /older database/);
  assert.deepEqual(errors, []);
  await close();
  await server.stop();
});

inPage("narrow screens: a chosen change is not covered by the panel, and every control has a name", "#v=AU-SEMI19&changes=1", async (page) => {
  await page.click(".fold");
  await page.locator(".change-roads button").first().click();
  await page.waitForSelector(".explain .verdict");
  assert.ok(await page.locator(".legend").isHidden());
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 390);
  const nameless = await page.evaluate(() => [...document.querySelectorAll(".changes button, .changes input")].filter((one) => !one.textContent.trim() && !one.labels?.[0]?.textContent.trim()).length);
  assert.equal(nameless, 0);
}, { viewport: { width: 390, height: 780 } });
