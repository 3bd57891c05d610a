// A route by text, by keyboard and from a road; stops, other ways, and files to take along.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { drawnRegion, edgePixel, idle, text } from "./support.mjs";

const { all, inPage } = drawnRegion();

const route = (page) => page.evaluate(() => globalThis.netcert.store.state.route);
const certified = (page) => page.waitForSelector(".route .verdict.is-safe", { timeout: 120_000 });
const fields = (page) => page.locator(".trip input").evaluateAll((inputs) => inputs.map(({ value }) => value));
/** Two places on the highway of the drawn region, and one between. */
const [A, STOP, B] = [[126.0515, -30.215], [126.0513, -30.22], [126.05195, -30.235]];
const SET = "v=AU-SEMI19&policy=carriageway";
const typed = ([lon, lat]) => `${lat}, ${lon}`;
const link = (...places) => `#${SET}&route=${places.map((place) => place?.join(",") ?? "").join(";")}`;

/** Presses the Tab key until the map has the focus. */
async function toMap(page) {
  for (let presses = 0; presses < 80; presses += 1) {
    await page.keyboard.press("Tab");
    if (await page.evaluate(() => document.activeElement.matches(".maplibregl-canvas"))) return;
  }
  assert.fail("the Tab key reaches the map");
}

inPage("a coordinate and a road are typed, the ends are swapped, and a stop is part of the certificate", `#${SET}`, async (page) => {
  await page.keyboard.press("r");
  assert.equal(await page.evaluate(() => document.activeElement.id), "place-0", "the first field has the focus");
  await page.keyboard.type(typed(A));
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => globalThis.netcert.store.state.route?.[0]);
  assert.deepEqual(await route(page), [A, null]);
  assert.equal(await page.evaluate(() => document.activeElement.id), "place-1", "and then the next");
  await page.keyboard.type("highway");
  await page.waitForSelector(".trip .hits [role=option]");
  const asked = page.waitForRequest(/\/api\/route\?/);
  await page.keyboard.press("Enter");
  await asked;
  const [from, to] = await route(page);
  assert.deepEqual(from, A);
  const [hit] = await (await fetch(`${all.address}/api/search?q=highway`)).json();
  assert.deepEqual(to, [hit.lon, hit.lat]);
  assert.match((await fields(page))[1], /Highway/, "the field shows the road's name");
  await page.click("text=Swap");
  assert.deepEqual(await route(page), [to, from]);
  await page.click("text=Add a stop");
  assert.deepEqual(await route(page), [to, null, from]);
  assert.equal(await page.evaluate(() => document.activeElement.id), "place-1");
  const withStop = page.waitForRequest(/\/api\/route\?.*via=/);
  await page.keyboard.type(typed(STOP));
  await page.keyboard.press("Enter");
  assert.equal(new URL((await withStop).url()).searchParams.get("via"), STOP.map((degrees) => degrees.toFixed(6)).join(","));
  await page.waitForSelector(".route .verdict", { timeout: 120_000 });
  assert.equal(await page.locator(".pin").count(), 3);
  await page.click("[aria-label='Remove Via 1']");
  assert.deepEqual(await route(page), [to, from]);
});

inPage("a route over a stop is one certificate, and who is given the link sees it", link(A, STOP, B), async (page) => {
  await certified(page);
  assert.equal((await fields(page)).length, 3);
  assert.match(await text(page, ".command"), /./);
  await page.click(".command summary");
  assert.match(await text(page, ".command code"), /--from \S+ --via \S+ --to/);
  const answer = await (await fetch(`${all.address}/api/route?vehicle=AU-SEMI19&policy=carriageway&from=${A}&via=${STOP}&to=${B}&snap=500`)).json();
  assert.equal(answer.routes.length, 1);
  assert.equal(answer.places.length, 3);
  assert.equal(answer.routes[0].safe, true);
});

inPage("a field that is emptied takes its place away; a text that is no road leaves it", link(A, B), async (page) => {
  await certified(page);
  await page.fill("#place-1", "no such road anywhere");
  await page.keyboard.press("Escape");
  await page.locator("#place-1").blur();
  assert.deepEqual(await route(page), [A, B]);
  assert.notEqual((await fields(page))[1], "no such road anywhere");
  await page.fill("#place-1", "");
  await page.keyboard.press("Enter");
  assert.deepEqual(await route(page), [A, null]);
  await page.waitForSelector(".route .prompt");
});

inPage("with the keyboard alone: Enter on the map takes the place under the cross, and opens a road", link(null, null), async (page) => {
  await toMap(page);
  assert.ok(await page.locator(".crosshair").isVisible());
  await page.evaluate((center) => globalThis.netcert.map.jumpTo({ center, zoom: 14 }), A);
  await idle(page);
  await page.keyboard.press("Enter");
  const near = (place, wanted) => assert.ok(Math.hypot(place[0] - wanted[0], place[1] - wanted[1]) < 1e-4, `${place} for ${wanted}`);
  near((await route(page))[0], A);
  await page.evaluate((center) => globalThis.netcert.map.jumpTo({ center, zoom: 14 }), B);
  await idle(page);
  await page.keyboard.press("Enter");
  near((await route(page))[1], B);
  await certified(page);
  await idle(page);
  // A complete route: Enter opens the road under the cross, and the route stays behind it.
  const edge = await page.evaluate(() => {
    const { map } = globalThis.netcert;
    const found = map.queryRenderedFeatures({ layers: ["edge-safe"] }).find(({ properties }) => properties.highway === "trunk");
    const line = found.geometry.type === "LineString" ? found.geometry.coordinates : found.geometry.coordinates[0];
    map.jumpTo({ center: line[Math.floor(line.length / 2)], zoom: 16 });
    return line.length;
  });
  assert.ok(edge > 1);
  await idle(page);
  await page.evaluate(() => globalThis.netcert.map.getCanvas().focus());
  await page.keyboard.press("Enter");
  await page.waitForSelector(".explain .verdict");
  assert.ok(await page.locator(".drawer-back").isVisible());
});

inPage("a route begins at an explained road and goes to another one", "#v=AU-SEMI19", async (page) => {
  const at = await edgePixel(page, "safe");
  await page.mouse.click(at.x, at.y);
  await page.waitForSelector(".explain .verdict");
  const name = await text(page, ".explain h2");
  await page.click("text=Route from here");
  const [from, to] = await route(page);
  assert.ok(from && !to);
  assert.ok((await fields(page))[0].length > 3);
  assert.ok(name.length > 3);
  // The search keeps what is chosen of a route, and the panel of its hit leads back.
  await page.keyboard.press("Escape");
  await page.evaluate((places) => globalThis.netcert.store.set({ route: places }), [from, null]);
  await page.focus("#search");
  await page.keyboard.type("highway");
  await page.waitForSelector("#search-hits [role=option]");
  await page.keyboard.press("Enter");
  await page.waitForSelector(".explain .verdict");
  assert.ok(await page.locator(".drawer-back").isVisible());
  await page.click("text=Route to here");
  const [kept, goal] = await route(page);
  assert.deepEqual(kept, from);
  assert.ok(goal);
  await page.waitForSelector(".route .verdict", { timeout: 120_000 });
});

inPage("other certified ways are asked for, and GPX and GeoJSON say what they hold for", link(A, B), async (page) => {
  await certified(page);
  const line = () => page.evaluate(() => globalThis.netcert.map.queryRenderedFeatures({ layers: ["own-route-line"] }).length);
  await idle(page);
  assert.ok((await line()) > 0);
  const others = page.waitForResponse(/alternatives=2/, { timeout: 120_000 });
  await page.click(".others");
  const answer = await (await others).json();
  await page.waitForSelector(answer.routes.length > 1 ? ".other-way" : ".route-content .note", { timeout: 120_000 });
  if (answer.routes.length > 1) {
    assert.equal(await page.locator(".other-way").count(), answer.routes.length);
    await page.locator(".other-way").nth(1).click();
    assert.equal(await page.locator(".other-way[aria-pressed=true]").count(), 1);
  }
  const saved = async (name) => {
    const [file] = await Promise.all([page.waitForEvent("download"), page.locator("[aria-label='Take the route along'] button", { hasText: new RegExp(`^${name}$`) }).click()]);
    assert.equal(file.suggestedFilename(), `netcert-AU-SEMI19.${name.toLowerCase()}`);
    return readFileSync(await file.path(), "utf8");
  };
  const gpx = await saved("GPX");
  const parsed = await page.evaluate((xml) => {
    const read = new DOMParser().parseFromString(xml, "application/xml");
    return { broken: read.querySelectorAll("parsererror").length, points: read.querySelectorAll("trkpt").length, told: read.querySelector("metadata > desc").textContent };
  }, gpx);
  assert.equal(parsed.broken, 0);
  assert.match(parsed.told, /AU-SEMI19.*no permit/);
  const { features } = JSON.parse(await saved("GeoJSON"));
  assert.equal(features[0].geometry.coordinates.length, parsed.points);
  assert.match(features[0].properties.scope, /no permit/);
  assert.equal(features[0].properties.safe, true);
});

inPage("after a drive the map is where it was", link(A, B), async (page) => {
  await certified(page);
  await idle(page);
  const camera = () => page.evaluate(() => {
    const { map } = globalThis.netcert;
    return { ...map.getCenter(), zoom: map.getZoom(), pitch: map.getPitch(), bearing: map.getBearing() };
  });
  const before = await camera();
  await page.click("text=Drive it");
  await page.waitForFunction(() => globalThis.netcert.map.getPitch() > 30, null, { timeout: 60_000 });
  await page.keyboard.press("Escape");
  await page.waitForFunction(() => !globalThis.netcert.map.isMoving() && globalThis.netcert.map.getPitch() < 0.01);
  const after_ = await camera();
  for (const [name, value] of Object.entries(before)) assert.ok(Math.abs(after_[name] - value) < 1e-3, `${name}: ${after_[name]} for ${value}`);
});

inPage("a place that is too far from a certified road is moved to the nearest one with one click", "", async (page, opened) => {
  const far = [126.2, -30.3];
  const body = { title: "No road", status: 422, detail: "too far", place: { lon: far[0], lat: far[1] }, nearest: { lon: B[0], lat: B[1], distance_m: 538.2 } };
  const refused = `to=${far.map((degrees) => degrees.toFixed(6)).join("%2C")}`;
  await page.route((url) => url.href.includes("/api/route?") && url.href.includes(refused), (asked) => asked.fulfill({ status: 422, contentType: "application/problem+json", body: JSON.stringify(body) }));
  await page.evaluate((places) => globalThis.netcert.store.set({ vehicle: "AU-SEMI19", policy: "carriageway", route: places }), [A, far]);
  await page.waitForSelector(".offer");
  assert.match(await text(page, ".offer"), /Move B to the nearest certified road, 538 m away/);
  await page.click(".offer");
  assert.deepEqual(await route(page), [A, B]);
  await certified(page);
  assert.ok(opened.errors.every((error) => error.includes("422")), opened.errors.join("\n"));
  opened.errors.length = 0;
});

inPage("what blocks a route is numbered, with its kind, its reason and what that rests on; a road of the list leads back", "#v=AU-ATRIPLE53&policy=carriageway&route=126.026942,-30.203315;126.046615,-30.205563", async (page) => {
  const answer = await (await fetch(`${all.address}/api/route?vehicle=AU-ATRIPLE53&policy=carriageway&from=126.026942,-30.203315&to=126.046615,-30.205563&snap=500&conditions=none`)).json();
  const obstacles = answer.obstacles.map((one) => ({ ...one, kerb_assumed: one.kind === "turn" ? true : null, width_source: one.kind === "edge" ? "assumed" : null }));
  await page.route(/conditions=none/, (asked) => asked.fulfill({ json: { ...answer, obstacles } }));
  const nothing_helps = [{ kind: "turn", title: "Mill Lane into High Street", place: null }];
  await page.route(/conditions=search/, (asked) => asked.fulfill({ json: { ...answer, obstacles, nothing_helps } }));
  await page.reload();
  await page.waitForSelector(".route .verdict.is-blocked");
  await page.getByText(/no kerb radius, width or paving that was tried opens Mill Lane into High Street\./).waitFor();
  const row = await text(page, ".numbered-list li");
  assert.match(row, /1[\s\S]*(Too narrow|Hinge|Fails)[\s\S]*(turn|road)[\s\S]*(kerb radius: assumed|width: assumed from class)/i);
  await idle(page);
  assert.ok((await page.evaluate(() => globalThis.netcert.map.queryRenderedFeatures({ layers: ["own-route-blocked"] }).length)) > 0);
  await page.locator(".why").first().click();
  await page.waitForSelector(".explain .verdict", { timeout: 120_000 });
  assert.ok(await page.locator(".numbered.is-obstacle").first().isVisible());
  await page.click(".drawer-back");
  await page.waitForSelector(".route .verdict.is-blocked");
});

inPage("a vehicle that the law names may rest on attested places, and its way says so", "#v=AU-SEMI19", async (page) => {
  await page.route(/\/api\/vehicles$/, async (asked) => {
    const vehicles = await (await fetch(`${all.address}/api/vehicles`)).json();
    await asked.fulfill({ json: vehicles.map((one) => ({ ...one, may_be_attested: one.id === "AU-SEMI19" })) });
  });
  const answer = await (await fetch(`${all.address}/api/route?vehicle=AU-SEMI19&policy=lane&from=126.026942,-30.203315&to=126.046615,-30.205563&snap=500`)).json();
  assert.equal(answer.conditional.conditions_attested, false);
  const by = { by: "register", name: null, tags: null, law: null };
  const conditional = { ...answer.conditional, conditions_attested: true, conditions: answer.conditional.conditions.map((one) => ({ ...one, attested: by })) };
  await page.route(/at_most=attested/, (asked) => asked.fulfill({ json: { ...answer, conditional, at_most: "attested" } }));
  await page.goto(`${all.address}/#v=AU-SEMI19&route=126.026942,-30.203315;126.046615,-30.205563`);
  await page.reload();
  await page.waitForSelector(".route .verdict:not(.is-safe)", { timeout: 120_000 });
  assert.deepEqual(await page.locator("#trip-room option").allTextContents(), ["nothing more", "the oncoming lane, too", "places where it is attested"]);
  await page.selectOption("#trip-room", "attested");
  await page.getByText("Each place is attested: the law or the register says that such a vehicle goes there. That is no proof.").waitFor();
  assert.match(await page.locator(".command code").textContent(), /--at-most attested$/);
  assert.match(await page.evaluate(() => location.hash), /most=attested/);
});

inPage("a route may use the oncoming lane where its own is not enough, and says where", "#v=AU-SEMI19&route=126.026942,-30.203315;126.046615,-30.205563", async (page) => {
  await page.waitForSelector(".route .verdict:not(.is-safe)", { timeout: 120_000 });
  assert.deepEqual(await page.locator("#trip-room option").allTextContents(), ["nothing more", "the oncoming lane, too"]);
  const asked = page.waitForRequest(/\/api\/route\?.*at_most=carriageway/);
  await page.selectOption("#trip-room", "carriageway");
  await asked;
  await certified(page);
  const uses = page.locator(".uses li");
  const told = await uses.allTextContents();
  for (const text of told) assert.match(text, /Stock Route Road into .*the oncoming lane, \d+ m, at most \d\.\d\d m over the line, at the turn/);
  const stated = told.map((text) => Number(text.match(/lane, (\d+) m/)[1]));
  assert.ok(stated.length > 0 && stated.reduce((sum, metres) => sum + metres) < 150, told.join("\n"));
  assert.match(await page.locator(".route-content").textContent(), /Oncoming traffic must be held back .* Nothing here says that it is\./);
  assert.match(await page.locator(".command code").textContent(), /--corridor lane .*--at-most carriageway$/);
  assert.match(await page.evaluate(() => location.hash), /most=carriageway/);
  // Each stretch is dashed on the map and has its length.
  await idle(page);
  const dashed = await page.evaluate(() => globalThis.netcert.map.getStyle().sources["own-route"].data.features);
  const oncoming = dashed.filter(({ properties }) => properties.kind === "oncoming");
  assert.equal(oncoming.length, stated.length);
  for (const [i, { geometry }] of oncoming.entries()) {
    const line = geometry.coordinates;
    const metres = line.slice(1).reduce((sum, [lon, lat], k) => sum + Math.hypot((lon - line[k][0]) * 111_320 * Math.cos((30.2 * Math.PI) / 180), (lat - line[k][1]) * 110_800), 0);
    assert.ok(Math.abs(metres - stated[i]) < 3, `${metres} m, ${told[i]}`);
  }
  // Who drives there reads it beside the leeway, too.
  await uses.first().locator("button").click();
  const slider = page.getByRole("slider", { name: "Place along the route, metres" });
  await slider.waitFor();
  const beyond = new RegExp(`the oncoming lane, \\w+ side, at most ${told[0].match(/at most (\d\.\d\d) m/)[1]} m over the line`);
  await page.waitForFunction((text) => new RegExp(text).test(document.querySelector(".strip-beyond")?.textContent ?? ""), beyond.source);
  assert.match(await slider.getAttribute("aria-valuetext"), beyond);
});
