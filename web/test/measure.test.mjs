// Measurements that are kept on the page, in a real browser, on the drawn region.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { program } from "./databases.mjs";
import { drawnRegion, text } from "./support.mjs";

const editable = drawnRegion({ more: ["--edit"] });
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

const fill = async (page, values) => {
  await page.locator(".measure summary").click();
  for (const [name, value] of Object.entries(values)) await page.locator(`.measure-form [name=${name}]`).fill(value);
};
const explained = (page) => page.waitForSelector(".explain .verdict", { timeout: 120_000 });
const told = (page) => page.waitForFunction(() => document.querySelector(".toast.is-shown")?.textContent, null, { timeout: 120_000 }).then((found) => found.jsonValue());

editable.inPage("a kerb that is measured makes a turn certified in the same view, and removing it takes that back", "", async (page) => {
  const turn = row(editable.all.db, (one) => one.verdict === "unsafe" && one.need_kerb_radius_m > 0 && one.kerb_source === "assumed", "--turns", "--corridor", "carriageway");
  await page.goto(`${editable.all.address}/#v=${VEHICLE}&policy=carriageway&id=${turn.turn_id}`);
  await page.reload();
  await explained(page);
  assert.match(await text(page, ".explain .verdict"), /Not certified/);
  const url = page.url();
  await fill(page, { value: String(turn.need_kerb_radius_m + 0.5), sigma: "0.1", source: "site plan", date: "2026-11-20" });
  await page.keyboard.press("Enter");
  assert.match(await told(page), /Kept as measurement 1\..*For AU-SEMI19 .* now certified/);
  await explained(page);
  assert.match(await text(page, ".explain .verdict"), /^Certified/);
  assert.equal(page.url(), url, "the same view");
  assert.match(await text(page, ".measured li"), /Kerb radius .* m, site plan, 2026-11-20/);

  page.on("dialog", (dialog) => dialog.accept());
  await page.locator(".measured li button").click();
  assert.match(await told(page), /Removed\..*no longer certified/);
  await explained(page);
  assert.match(await text(page, ".explain .verdict"), /Not certified/);
  assert.equal(await page.locator(".measured li").count(), 0);
});

editable.inPage("what is faulty is said beside the form, and what was typed stays", "", async (page) => {
  const edge = row(editable.all.db, (one) => one.verdict === "unsafe" && one.reason === "width" && one.need_width_m > 0);
  await page.goto(`${editable.all.address}/#v=${VEHICLE}&policy=lane&id=${edge.edge_id}`);
  await page.reload();
  await explained(page);
  await fill(page, { value: "900", sigma: "0.05", source: "tape", date: "2026-11-20" });
  await page.locator(".measure-form button").click();
  await page.waitForFunction(() => /value /.test(document.querySelector(".measure-form .measured-told").textContent));
  assert.equal(await page.locator(".measure-form [name=source]").inputValue(), "tape");
  assert.ok(await page.locator(".measure-form button").isEnabled());
});

reading.inPage("a server that only reads has no form", "", async (page) => {
  const edge = row(reading.all.db, (one) => one.verdict === "unsafe" && one.reason === "width");
  await page.goto(`${reading.all.address}/#v=${VEHICLE}&policy=lane&id=${edge.edge_id}`);
  await page.reload();
  await explained(page);
  assert.ok(await page.locator(".suppose").isVisible());
  assert.equal(await page.locator(".measure").count(), 0);
});
