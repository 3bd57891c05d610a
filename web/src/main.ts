// Start: asks what there is, reads the link, and hands over to the page.

import { setWorkerUrl } from "maplibre-gl";
import { api } from "./api/client.ts";
import { Page } from "./app/page.ts";
import type { Context } from "./context.ts";
import { read } from "./link.ts";
import { Store, type State } from "./state.ts";
import { byId, h } from "./ui/dom.ts";
import { ThemeSwitch } from "./ui/theme.ts";
import type { Region, Vehicle } from "./api/types.ts";

/** The name of MapLibre's worker among the assets; the build fills it in. */
declare const WORKER_URL: string;

async function start(): Promise<void> {
  setWorkerUrl(WORKER_URL);
  const theme = new ThemeSwitch();
  const [region, vehicles] = await Promise.all([api.region(), api.vehicles()]);
  const first = beginning(region, vehicles);
  const possible = {
    vehicles: vehicles.filter((vehicle) => vehicle.certified.length > 0).map((vehicle) => vehicle.id),
    policies: region.policies,
  };
  const context: Context = { store: new Store(read(location.hash, first, possible)), region, vehicles, theme };
  // Labels are drawn with the page's own font: it has to be there before the first of them is.
  await Promise.race([document.fonts.load("600 16px 'Inter Variable'"), new Promise((done) => setTimeout(done, 1500))]);
  new Page(context, first, possible);
}

/** What is shown where the link says nothing: the first of the vehicles that most of them are like, its whole region. */
function beginning(region: Region, vehicles: Vehicle[]): State {
  const certified = vehicles.filter((vehicle) => vehicle.certified.length > 0);
  const alike = (vehicle: Vehicle): number => certified.filter((other) => other.region === vehicle.region).length;
  const most = Math.max(...certified.map(alike));
  const own = certified.filter((vehicle) => alike(vehicle) === most);
  const usual = own.find((vehicle) => vehicle.certified.includes(region.default_policy)) ?? own[0];
  if (!usual) throw new Error("The database has no certificates yet: run `netcert certify`, then reload this page.");
  return {
    vehicle: usual.id,
    policy: usual.certified.includes(region.default_policy) ? region.default_policy : usual.certified[0]!,
    other: null,
    colourBy: "margin",
    hidden: new Set(),
    hiddenClasses: new Set(),
    evidence: "assumed",
    camera: null,
    selected: null,
    route: null,
    stats: false,
    baseMap: false,
  };
}

start().catch((error: unknown) => {
  const message = error instanceof Error ? error.message : String(error);
  byId("maps").replaceChildren(h("div", { class: "failure", role: "alert" }, h("h1", {}, "netcert"), h("p", {}, message)));
});
