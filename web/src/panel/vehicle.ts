// The chosen vehicle, drawn to scale, and the dialog in which another vehicle can be chosen.

import type { Vehicle } from "../api/types.ts";
import { vehicleOf, type Context } from "../context.ts";
import { sideView } from "../draw/vehicle.ts";
import { Dialog } from "../ui/dialog.ts";
import { h } from "../ui/dom.ts";
import { icon } from "../ui/icons.ts";
import { length } from "../units.ts";

const regions: Record<string, string> = {
  EU: "Europe",
  US: "United States",
  CA: "Canada",
  AU: "Australia",
  indoor: "Indoors",
  airside: "Airside",
};

export function facts(vehicle: Vehicle): string {
  const known = [
    length(vehicle.length_m),
    vehicle.gross_mass_t === null ? null : `${vehicle.gross_mass_t} t`,
    vehicle.height_m === null ? null : `${length(vehicle.height_m)} high`,
    `${vehicle.units.length} ${vehicle.units.length === 1 ? "unit" : "units"}`,
  ];
  return known.filter(Boolean).join(" · ");
}

/** A button that shows the vehicle and opens the dialog. */
export class VehicleCard {
  readonly element = h("button", { class: "vehicle-card", type: "button", "aria-haspopup": "dialog", onclick: () => this.onOpen() });

  constructor(private readonly onOpen: () => void) {}

  /** `certified` is the text about the roads that the vehicle may use, if it is known yet. */
  show(vehicle: Vehicle | undefined, certified: string | null): void {
    if (!vehicle) return;
    const picture = sideView(vehicle);
    // The words beside it say the same.
    picture.setAttribute("aria-hidden", "true");
    this.element.replaceChildren(
      picture,
      h("span", { class: "vehicle-name" }, vehicle.name, icon("chevron")),
      h("span", { class: "vehicle-facts" }, facts(vehicle)),
      certified ? h("span", { class: "vehicle-certified" }, h("i", { class: "line line-safe" }), certified) : "",
      h("span", { class: "sr-only" }, "Choose another vehicle"),
    );
  }
}

/** The dialog with all vehicles at one scale, so that their lengths can be compared. */
export class VehicleDialog {
  readonly #dialog = new Dialog("vehicles", "Choose a vehicle");
  #choose: (id: string) => void = () => {};

  constructor(private readonly context: Context) {}

  open(title: string, current: string, choose: (id: string) => void): void {
    this.#choose = choose;
    this.#dialog.title = title;
    this.#fill(current);
    this.#dialog.open();
    this.#dialog.body.querySelector<HTMLElement>("[aria-pressed=true]")?.focus();
  }

  #fill(current: string): void {
    const { policy } = this.context.store.state;
    const here = this.context.vehicles.filter((vehicle) => vehicle.certified.length > 0);
    const longest = Math.max(...here.map((vehicle) => vehicle.length_m));
    const groups = [...new Set(here.map((vehicle) => vehicle.region))];
    const sections = groups.map((region) => {
      const own = here.filter((vehicle) => vehicle.region === region).sort((a, b) => a.length_m - b.length_m);
      const rows = own.map((vehicle) => this.#row(vehicle, vehicle.id === current, longest, vehicle.certified.includes(policy)));
      return h("section", {}, h("h3", {}, regions[region] ?? region), ...rows);
    });
    const note = h(
      "p",
      { class: "note" },
      "To one scale. Lengths are the vehicle’s; cabs, decks and wheels are a scheme. More vehicles: ",
      h("code", {}, "netcert certify --vehicle ID"),
    );
    this.#dialog.body.replaceChildren(...sections, note);
  }

  #row(vehicle: Vehicle, pressed: boolean, longest: number, certified: boolean): HTMLElement {
    const choose = () => {
      this.#dialog.close();
      this.#choose(vehicle.id);
    };
    const other = certified ? null : h("span", { class: "tag" }, `only: ${vehicle.certified.join(", ")}`);
    return h(
      "button",
      { class: "vehicle-row", type: "button", "aria-pressed": String(pressed), onclick: choose },
      h("span", { class: "vehicle-words" }, h("strong", {}, vehicle.name), h("span", {}, `${vehicle.id} · ${facts(vehicle)}`), other),
      sideView(vehicle, longest),
    );
  }
}

/** The policy for a vehicle: the current one if the vehicle is certified under it, else another one that it is certified under. */
export function fittingPolicy(context: Context, id: string): Context["store"]["state"]["policy"] {
  const { policy } = context.store.state;
  const certified = vehicleOf(context, id)?.certified ?? [];
  return certified.includes(policy) ? policy : (certified[0] ?? policy);
}
