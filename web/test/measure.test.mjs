// Measurements that are kept on the page, in a real browser, on the drawn region.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { after } from "node:test";
import { program } from "./databases.mjs";
import { orthophoto } from "./orthophoto.mjs";
import { drawnRegion, idle, text } from "./support.mjs";

const photo = await orthophoto();
after(() => photo.close());
const editable = drawnRegion({ more: ["--edit", "--base-map", photo.template] });
const reading = drawnRegion();
const VEHICLE = "AU-SEMI19";

/** The first row of a query that has what is wanted, as JSON. */
function row(db, wanted, ...more) {
  const said = execFileSync(program, ["query", "-q", "--db", db, "--vehicle", VEHICLE, "--format", "json", ...more], { encoding: "utf8", maxBuffer: 1 << 28 });
  // Ids have 63 bits: they are text before they are parsed.
  const rows = JSON.parse(said.replace(/"(edge_id|turn_id)": ?(\d+)/g, '"$1":"$2"'));
  const found = Object.values(rows).find(Array.isArray).find(wanted);
  assert.ok(found, "no such row");
  return found;
}

/** Opens the form with this title and fills it. Returns the form. */
const fill = async (page, title, values) => {
  const form = page.locator(".measure", { hasText: title });
  await form.locator("summary").click();
  for (const [name, value] of Object.entries(values)) await form.locator(`[name=${name}]`).fill(value);
  return form;
};
const MEASURED = "I measured it";
const TRACED = "I traced what is paved";
const explained = (page) => page.waitForSelector(".explain .verdict", { timeout: 120_000 });
/** Waits until the page tells that something of this kind happened. */
const told = (page, pattern) =>
  page.waitForFunction((source) => new RegExp(source).test(document.querySelector(".toast.is-shown")?.textContent ?? ""), pattern.source, { timeout: 120_000 });

editable.inPage("a kerb that is measured makes a turn certified in the same view, and removing it takes that back", "", async (page) => {
  const turn = row(editable.all.db, (one) => one.verdict === "unsafe" && one.need_kerb_radius_m > 0 && one.kerb_source === "assumed", "--turns", "--corridor", "carriageway");
  await page.goto(`${editable.all.address}/#v=${VEHICLE}&policy=carriageway&id=${turn.turn_id}`);
  await page.reload();
  await explained(page);
  assert.match(await text(page, ".explain .verdict"), /Not certified/);
  // The link holds the place once the map has come to rest at the turn.
  await page.waitForFunction(() => /at=17/.test(location.hash));
  await idle(page);
  const url = page.url();
  await fill(page, MEASURED, { value: String(turn.need_kerb_radius_m + 0.5), sigma: "0.1", source: "site plan", date: "2026-11-20" });
  await page.keyboard.press("Enter");
  await told(page, /Kept as measurement 1\..*For AU-SEMI19 .* now certified/);
  await explained(page);
  assert.match(await text(page, ".explain .verdict"), /^Certified/);
  assert.equal(page.url(), url, "the same view");
  assert.match(await text(page, ".measured li"), /Kerb radius .* m, site plan, 2026-11-20/);

  page.on("dialog", (dialog) => dialog.accept());
  await page.locator(".measured li button").click();
  await told(page, /Removed\..*no longer certified/);
  await explained(page);
  assert.match(await text(page, ".explain .verdict"), /Not certified/);
  assert.equal(await page.locator(".measured li").count(), 0);
});

editable.inPage("what is faulty is said beside the form, and what was typed stays", "", async (page, opened) => {
  const edge = row(editable.all.db, (one) => one.verdict === "unsafe" && one.reason === "width" && one.need_width_m > 0);
  await page.goto(`${editable.all.address}/#v=${VEHICLE}&policy=lane&id=${edge.edge_id}`);
  await page.reload();
  await explained(page);
  const form = await fill(page, MEASURED, { value: "900", sigma: "0.05", source: "tape", date: "2026-11-20" });
  await form.locator("button").click();
  await page.waitForFunction(() => /value /.test(document.querySelector(".measure-form .measured-told").textContent));
  assert.equal(await form.locator("[name=source]").inputValue(), "tape");
  assert.ok(await form.locator("button").isEnabled());
  // The browser notes every refusal.
  assert.equal(opened.errors.length, 1);
  assert.match(opened.errors.pop(), /422/);
});

editable.inPage("a junction is traced on an aerial picture, and the surface counts", "", async (page, opened) => {
  const turn = row(editable.all.db, (one) => one.verdict === "unsafe" && one.need_kerb_radius_m > 0 && one.kerb_source === "assumed", "--turns", "--corridor", "carriageway");
  const { at: middle } = await editable.ask(`/api/explain/${turn.turn_id}?vehicle=${VEHICLE}&policy=carriageway`);
  const half_m = 14;
  photo.square = { middle, half_m };
  await page.goto(`${editable.all.address}/#v=${VEHICLE}&policy=carriageway&id=${turn.turn_id}&at=18.5,${middle[1]},${middle[0]}`);
  await page.reload();
  await explained(page);
  await page.evaluate(() => globalThis.netcert.store.set({ baseMap: true }));
  await idle(page);
  const paint = (name) => page.evaluate((one) => globalThis.netcert.map.getPaintProperty("base", one), name);
  assert.equal(await paint("raster-opacity"), 0.45);
  assert.ok(photo.asked.length > 0 && photo.asked.every(({ crs, bbox }) => crs === "EPSG:3857" && bbox.split(",").length === 4));

  const form = await fill(page, TRACED, { sigma: "0.1", source: "orthophoto of 2026", date: "2026-11-20" });
  await form.locator("button.primary").click();
  assert.match(await form.locator(".measured-told").innerText(), /Trace the surface first/);
  await form.getByRole("button", { name: "Trace it on the map" }).click();
  await page.waitForFunction(() => /corner by corner/.test(document.querySelector(".tracer").textContent));
  await page.waitForFunction(() => globalThis.netcert.map.getStyle().layers.some(({ id }) => id.startsWith("own-trace")));
  assert.equal(await paint("raster-opacity"), 1, "one traces on the picture as it is");
  const corners = await page.evaluate(
    ([[lon, lat], reach]) => {
      const { map } = globalThis.netcert;
      const { left, top } = map.getCanvas().getBoundingClientRect();
      const [east, north] = [reach / 111_320 / Math.cos((lat * Math.PI) / 180), reach / 111_320];
      return [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([x, y]) => {
        const at = map.project([lon + x * east, lat + y * north]);
        return [left + at.x, top + at.y];
      });
    },
    [middle, half_m],
  );
  // Two corners that are close to each other, as those of kerbs are, and the last one again.
  const [[x, y]] = corners.splice(2, 1);
  corners.splice(2, 0, [x, y], [x - 18, y]);
  for (const [x, y] of [...corners, corners.at(-1)]) {
    await page.mouse.move(x, y, { steps: 3 });
    await page.mouse.click(x, y);
  }
  await page.waitForFunction(() => /Traced/.test(document.querySelector(".tracer").textContent));
  const [, many, square] = (await text(page, ".tracer")).match(/Traced: (\d+) corners, (\d+) m²/);
  assert.equal(many, "5");
  assert.ok(Math.abs(Number(square) - 4 * half_m ** 2) < 40, square);
  assert.match(page.url(), new RegExp(`id=${turn.turn_id}`), "a corner chooses no road");
  await page.waitForFunction(() => /to spare if all of it were paved.*Supposed, not certified/.test(document.querySelector(".tracer").textContent), null, { timeout: 120_000 });
  assert.equal((await editable.ask("/api/evidence")).measurements.length, 0, "nothing is kept yet");
  await form.locator("button.primary").click();
  await told(page, /Kept as measurement \d+\./);
  await explained(page);
  assert.match(await text(page, ".measured"), /Paved surface, orthophoto of 2026, 2026-11-20/);
  assert.ok(await page.evaluate(() => globalThis.netcert.store.state.baseMap), "the picture is still there");
  const kept = await editable.ask("/api/evidence");
  const surface = kept.measurements.find(({ quantity }) => quantity === "surface");
  assert.equal(surface.used, "counts");
  assert.equal(surface.matched.length, 1);
  // The picture is the only other machine that was asked.
  assert.ok(opened.strangers.every((url) => url.startsWith(photo.at)));
  opened.strangers.length = 0;
});

reading.inPage("a server that only reads has no form", "", async (page) => {
  const edge = row(reading.all.db, (one) => one.verdict === "unsafe" && one.reason === "width");
  await page.goto(`${reading.all.address}/#v=${VEHICLE}&policy=lane&id=${edge.edge_id}`);
  await page.reload();
  await explained(page);
  assert.ok(await page.locator(".suppose").isVisible());
  assert.equal(await page.locator(".measure").count(), 0);
});
