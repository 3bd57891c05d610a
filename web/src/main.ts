// The start: loads the region, reads the link, and creates the page.

import { setWorkerUrl } from "maplibre-gl";
import { api } from "./api/client.ts";
import { Page } from "./app/page.ts";
import { baseMapBefore } from "./app/renew.ts";
import type { Context } from "./context.ts";
import { read } from "./link.ts";
import { storedUnits } from "./units.ts";
import { Store, beginning, type State } from "./state.ts";
import { byId, h } from "./ui/dom.ts";
import { ThemeSwitch } from "./ui/theme.ts";
import type { Region, Vehicle } from "./api/types.ts";

/** The name of MapLibre's worker among the assets; the build fills it in. */
declare const WORKER_URL: string;

async function start(): Promise<void> {
  setWorkerUrl(WORKER_URL);
  const theme = new ThemeSwitch();
  const [region, vehicles] = await Promise.all([api.region(), api.vehicles()]);
  const first = usual(region, vehicles);
  const possible = {
    vehicles: vehicles.filter((vehicle) => vehicle.certified.length > 0).map((vehicle) => vehicle.id),
    policies: region.policies,
    changes: region.before !== null,
  };
  const context: Context = { store: new Store({ ...read(location.hash, first, possible), baseMap: baseMapBefore() && region.base_map !== null }), region, vehicles, theme };
  // Labels are drawn with the page's own font, so the font must be loaded before the first label.
  await Promise.race([document.fonts.load("600 16px 'Inter Variable'"), new Promise((done) => setTimeout(done, 1500))]);
  new Page(context, first, possible);
}

/** Vehicles that people know from the road. */
const FAMILIAR: readonly string[] = ["EU-SEMI16.5", "US-WB67", "US-WB62", "AU-SEMI19", "CA-SEMI23"];

/**
 * The state without a link: the whole region, and a vehicle that people know, of the vehicle region with most certified ones. If it has
 * none of them, its shortest.
 */
function usual(region: Region, vehicles: Vehicle[]): State {
  const certified = vehicles.filter((vehicle) => vehicle.certified.length > 0);
  const alike = (vehicle: Vehicle): number => certified.filter((other) => other.region === vehicle.region).length;
  const most = Math.max(...certified.map(alike));
  const among = certified.filter((vehicle) => alike(vehicle) === most).sort((a, b) => a.length_m - b.length_m);
  const ready = among.filter((vehicle) => vehicle.certified.includes(region.default_policy));
  const one = ready.find((vehicle) => FAMILIAR.includes(vehicle.id)) ?? among.find((vehicle) => vehicle.certified.includes(region.default_policy)) ?? among[0];
  if (!one) throw new Error("The database has no certificates yet: run `netcert certify`, then reload this page.");
  const { id, certified: own } = one;
  return { ...beginning(id, own.includes(region.default_policy) ? region.default_policy : own[0]!), units: storedUnits() };
}

start().catch((error: unknown) => {
  const message = error instanceof Error ? error.message : String(error);
  byId("maps").replaceChildren(h("div", { class: "failure", role: "alert" }, h("h1", {}, "netcert"), h("p", {}, message)));
});
