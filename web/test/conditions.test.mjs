// Routes under conditions, blocked routes and suppositions in a real browser, on the drawn region.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { program } from "./databases.mjs";
import { drawnRegion, idle, text } from "./support.mjs";

const { all, ask, inPage } = drawnRegion();

const FROM = "126.026942,-30.203315";
const TO = "126.046615,-30.205563";
const SET = "vehicle=AU-ATRIPLE53&policy=carriageway";
/** Round a corner whose assumed kerb is too sharp. */
const CORNER = `#v=AU-ATRIPLE53&policy=carriageway&route=${FROM};${TO}`;

const routed = () => ask(`/api/route?${SET}&from=${FROM}&to=${TO}&snap=500`);

/** How many pieces of each line of a route are seen. */
const lines = (page) =>
  page.evaluate(() => {
    const { map } = globalThis.netcert;
    const seen = (id) => (map.getLayer(id) ? map.queryRenderedFeatures({ layers: [id] }).length : 0);
    return { certified: seen("own-route-line"), conditional: seen("own-route-conditional"), blocked: seen("own-route-blocked") };
  });

inPage("a route under conditions has a line of its own, pins and a list that stays", CORNER, async (page) => {
  await page.waitForSelector(".route .verdict.is-conditional", { timeout: 120_000 });
  await idle(page);
  const { conditions, conditional } = await routed();
  assert.ok(conditions.length > 0);
  assert.equal(await page.locator(".numbered.is-condition").count(), conditions.length);
  assert.equal(await page.locator(".numbered-list li").count(), conditions.length);
  assert.equal(await page.locator(".numbered.is-obstacle").count(), 0);
  const drawn = await lines(page);
  assert.ok(drawn.conditional > 0 && drawn.certified === 0 && drawn.blocked === 0, JSON.stringify(drawn));
  const shown = await text(page, ".route");
  assert.match(shown, /Only if (one condition holds|\d+ conditions hold)/);
  assert.match(shown, /Nothing here says that it is/);
  assert.doesNotMatch(shown, /Certified as a whole|Drive it/);
  assert.equal(conditional.safe, false);
  // The decision sheet of this answer is one click away.
  const sheet = await page.locator('.route a[href^="/api/decision.html"]').getAttribute("href");
  const decision = await (await fetch(new URL(sheet, page.url()))).text();
  assert.match(decision, /<h2>Only under conditions: not certified<\/h2>/);
  assert.ok(await page.locator(".route-key .line-conditional").isVisible(), "the legend names the line");

  // The keyboard: a line flies to its pin.
  const { place, title } = conditions[0];
  await page.locator(".numbered-go").first().focus();
  await page.keyboard.press("Enter");
  await page.waitForSelector(".numbered.is-condition.is-chosen .pin-card");
  await idle(page);
  const seen = await page.evaluate((at) => {
    const { x, y } = globalThis.netcert.map.project(at);
    const [side, drawer] = ["side", "drawer"].map((id) => document.getElementById(id).getBoundingClientRect());
    return { x, y, left: side.right, right: drawer.left, zoom: globalThis.netcert.map.getZoom() };
  }, place);
  assert.ok(seen.x > seen.left && seen.x < seen.right && seen.y > 0 && seen.y < 800 && seen.zoom >= 16.9, JSON.stringify(seen));
  assert.ok((await text(page, ".numbered-list li.is-chosen")).includes(title));

  // "Why" opens the road or turn; the route stays, and the way back is there and has the focus.
  await page.locator(".why").first().focus();
  await page.keyboard.press("Enter");
  await page.waitForSelector(".explain .verdict", { timeout: 120_000 });
  assert.match(page.url(), /id=\d+/);
  assert.match(page.url(), /route=/);
  assert.equal(await page.locator(".numbered.is-condition").count(), conditions.length);
  await page.evaluate(() => document.querySelector(".drawer-back").focus());
  await page.keyboard.press("Enter");
  await page.waitForSelector(".route .verdict.is-conditional");
  assert.ok(await page.locator(".drawer-back").isHidden());
  assert.equal(await page.evaluate(() => document.activeElement.textContent), "Why");

  // A road of the map, too.
  await page.evaluate((selected) => globalThis.netcert.store.set({ selected }), conditional.parts.find((part) => part.edge_id).edge_id);
  await page.waitForSelector(".explain .verdict", { timeout: 120_000 });
  assert.ok(await page.locator(".drawer-back").isVisible());
  // A pin leads back to its line.
  await page.locator(".numbered.is-condition").last().evaluate((pin) => pin.click());
  await page.waitForSelector(".numbered-list li:last-child.is-chosen");
  await page.keyboard.press("Escape");
  await page.waitForSelector("#drawer", { state: "hidden" });
  assert.equal(await page.locator(".numbered").count(), 0);
  await page.waitForFunction(() => globalThis.netcert.map.queryRenderedFeatures({ layers: ["own-route-conditional"] }).length === 0);
});

inPage("the sheet opens as a page of its own and can be taken along", CORNER, async (page, opened) => {
  await page.waitForSelector(".sheets", { timeout: 120_000 });
  const { conditions } = await routed();
  const [sheet] = await Promise.all([page.context().waitForEvent("page"), page.click("text=Print the sheet")]);
  const errors = [];
  sheet.on("console", (message) => errors.push(message.text()));
  await sheet.waitForSelector("tbody tr");
  await sheet.reload();
  await sheet.waitForSelector("tbody tr");
  assert.equal(await sheet.locator("tbody tr").count(), conditions.length);
  assert.match(await sheet.locator(".scope").innerText(), /certified only if every line below is so on site/);
  assert.equal(await sheet.locator("table").evaluate((table) => getComputedStyle(table).borderCollapse), "collapse", "the policy lets its style in");
  assert.deepEqual(errors, []);
  await sheet.close();
  await page.locator("[name=units][value=feet]").check({ force: true });
  await page.waitForFunction(() => document.querySelector(".sheets a")?.getAttribute("href").includes("units=feet"));
  const inFeet = await fetch(all.address + (await page.locator(".sheets a").first().getAttribute("href")));
  assert.ok(/ \d+ ft( \d+ in)? \(\d+\.\d\d m\)/.test(await inFeet.text()));
  for (const [name, begins] of [["CSV", "id,quantity,value"], ["GeoJSON", "{\"type\":\"FeatureCollection\""]]) {
    const href = await page.locator(".sheets a", { hasText: new RegExp(`^${name}$`) }).getAttribute("href");
    const answer = await fetch(all.address + href);
    assert.equal(answer.status, 200);
    assert.ok((await answer.text()).startsWith(begins), name);
  }
  assert.deepEqual(opened.errors, []);
});

inPage("a blocked route is drawn with what blocks it, also if the search for conditions fails", "", async (page, opened) => {
  const body = JSON.stringify({ title: "Too slow", status: 504, detail: "it took more than 60 s" });
  await page.route(/conditions=search/, (route) => route.fulfill({ status: 504, contentType: "application/problem+json", body }));
  await page.evaluate((route) => {
    const places = route.map((place) => place.split(",").map(Number));
    globalThis.netcert.store.set({ vehicle: "AU-ATRIPLE53", policy: "carriageway", route: places });
  }, [FROM, TO]);
  await page.waitForSelector(".route .verdict.is-blocked");
  await page.waitForSelector(".route .note[role=alert]");
  await idle(page);
  const drawn = await lines(page);
  assert.ok(drawn.blocked > 0 && drawn.certified === 0 && drawn.conditional === 0, JSON.stringify(drawn));
  const { obstacles } = await ask(`/api/route?${SET}&from=${FROM}&to=${TO}&snap=500&conditions=none`);
  const pins = page.locator(".numbered.is-obstacle");
  assert.ok((await pins.count()) > 0 && (await pins.count()) <= obstacles.length);
  const label = await pins.first().getAttribute("aria-label");
  assert.match(label, /^Obstacle 1: .+(Too narrow|Hinge|Steering|Fails|No )/);
  assert.match(await text(page, ".route .note[role=alert]"), /60 s/);
  assert.ok(opened.errors.every((error) => error.includes("504")), opened.errors.join("\n"));
  opened.errors.length = 0;
});

/** The id and the need of the first row that has one. Ids have more digits than numbers here, so the rows are read as text. */
function firstNeed(...more) {
  const table = execFileSync(program, ["--quiet", "query", "--db", all.db, "--vehicle", "AU-ATRIPLE53", "--corridor", "carriageway", "--format", "csv", ...more]);
  const [head, ...rows] = table.toString().trim().split("\n").map((line) => line.split(","));
  const [id, need] = [head.findIndex((name) => /^(edge|turn)_id$/.test(name)), head.findIndex((name) => /^need_(width|kerb_radius)_m$/.test(name))];
  const row = rows.find((cells) => Number(cells[need]) > 0);
  assert.ok(row, `a need: ${more}`);
  return { id: row[id], need: Number(row[need]) };
}

inPage("a supposed value is certified again and never taken for a certificate", CORNER, async (page) => {
  const ids = { edge: firstNeed(), turn: firstNeed("--turns") };
  await page.waitForSelector(".route .verdict.is-conditional", { timeout: 120_000 });
  for (const found of Object.values(ids)) {
    await page.evaluate((selected) => globalThis.netcert.store.set({ selected }), found.id);
    await page.waitForSelector(".suppose input", { timeout: 120_000 });
    assert.match(await text(page, ".suppose-need"), new RegExp(`at least ${found.need.toFixed(2)} m`));
    await page.click(".suppose-need button");
    await page.waitForSelector(".suppose-enough:not(:empty)", { timeout: 120_000 });
    const told = await text(page, ".suppose");
    assert.match(told, /Supposed, not certified/);
    assert.match(told, /A supposition is no certificate/);
    assert.doesNotMatch(told, /\bsafe\b/i);
    const supposed = await ask(`/api/suppose/${found.id}?${SET}&metres=${found.need}`);
    assert.ok(supposed.enough && supposed.safe === false);
    // The keyboard moves the slider, and the answer follows. The verdict above stays that of the map.
    await page.focus(".suppose input");
    await page.keyboard.press("Home");
    await page.waitForFunction(() => /would not do/.test(document.querySelector(".suppose-told").textContent), null, { timeout: 120_000 });
    assert.equal(await page.locator(".explain > .verdict.is-unsafe").count(), 1);
    assert.ok(await page.locator(".drawer-back").isVisible());
  }
});
