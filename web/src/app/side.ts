// The panel on the left: the vehicle, the policy, and the meaning of the colours.

import type { Policy, SearchHit } from "../api/types.ts";
import type { VehicleStats } from "../api/stats.ts";
import { unitsOf, vehicleOf, type Context } from "../context.ts";
import { Filters } from "../panel/filters.ts";
import { Legend } from "../panel/legend.ts";
import { Search } from "../panel/search.ts";
import { VehicleCard } from "../panel/vehicle.ts";
import { byId, h, prose } from "../ui/dom.ts";
import { icon } from "../ui/icons.ts";
import { Segmented } from "../ui/segmented.ts";
import { storeUnits, type Units } from "../units.ts";
import { certifiedWords, mainClass, policyWords, regionName } from "../words.ts";

export interface SideActions {
  chooseVehicle(): void;
  go(hit: SearchHit): void;
  help(): void;
}

export class Side {
  readonly search: Search;
  readonly #card: VehicleCard;
  readonly #legend: Legend;
  readonly #policyNote = h("p", { class: "note" });
  readonly #theme: HTMLButtonElement;
  readonly #filterPlace = h("div");
  readonly #foldButton: HTMLButtonElement;
  #policies: Segmented<Policy>;
  readonly #units: Segmented<Units>;
  #policyPlace = h("div");
  #stats: VehicleStats | null = null;
  #filters: Filters | undefined;

  /** `changes` is the panel of the changes since an older database, if there is one. */
  constructor(private readonly context: Context, actions: SideActions, changes: HTMLElement | null) {
    this.search = new Search(actions.go);
    this.#card = new VehicleCard(actions.chooseVehicle);
    this.#legend = new Legend(context);
    this.#theme = h("button", { class: "plain", type: "button", onclick: () => context.theme.toggle() });
    this.#policies = this.#makePolicies();
    this.#units = new Segmented<Units>(
      "units",
      "Lengths in",
      [{ value: "metres", name: "Metres" }, { value: "feet", name: "Feet, inches", title: "The server’s own sentences, under Details, stay in metres" }],
      (units) => {
        storeUnits(units);
        context.store.set({ units });
      },
    );
    const { region } = context;
    const help = h("button", { class: "plain", type: "button", "aria-label": "Help and keys", title: "Help and keys (?)", onclick: actions.help }, icon("help"));
    const fold = (this.#foldButton = h(
      "button",
      { class: "plain fold", type: "button", "aria-expanded": "false", "aria-label": "Legend and filters", onclick: () => this.#fold(!byId("side").classList.contains("is-open")) },
      icon("chevron"),
    ));
    const brand = h("header", { class: "brand" }, h("h1", {}, "netcert", h("span", {}, regionName(region.name))), this.#theme, help, fold);
    const more = h(
      "div",
      { class: "side-more" },
      h("div", { class: "policy" }, this.#policyPlace, this.#policyNote),
      this.#legend.element,
      changes,
      this.#filterPlace,
      this.#base(),
      h("div", { class: "labelled" }, h("span", { class: "label", "aria-hidden": "true" }, "Lengths in"), this.#units.element),
      h("footer", {}, h("p", { class: "scope" }, prose(region.scope)), h("p", { class: "scope" }, attribution(region.attribution, region.timestamp))),
    );
    byId("side").append(brand, this.search.element, this.#card.element, more);
  }

  number(stats: VehicleStats | null): void {
    this.#stats = stats;
    this.#legend.show(stats);
    const vehicle = vehicleOf(this.context, this.context.store.state.vehicle);
    this.#card.show(vehicle, stats ? certifiedWords(stats.verdicts) : null);
    if (!this.#filters && stats) {
      this.#filters = new Filters(this.context, new Set(stats.classes.map(({ highway }) => mainClass(highway))));
      this.#filterPlace.append(this.#filters.element);
    }
  }

  /** Puts the words anew, because units are other ones. */
  respell(): void {
    this.number(this.#stats);
  }

  draw(certificates: boolean): void {
    const { store, theme } = this.context;
    const dark = theme.theme === "dark";
    this.#theme.replaceChildren(icon(dark ? "sun" : "moon"));
    this.#theme.setAttribute("aria-label", dark ? "Light colours" : "Dark colours");
    if (certificates) {
      this.#card.show(vehicleOf(this.context, store.state.vehicle), null);
      this.#policies = this.#makePolicies();
    }
    this.#policies.value = store.state.policy;
    this.#units.value = unitsOf(this.context);
    const { name, meaning } = policyWords[store.state.policy];
    const one = this.context.region.policies.length < 2;
    this.#policyPlace.hidden = one;
    this.#policyNote.replaceChildren(one ? h("strong", {}, `${name}. `) : "", meaning);
    this.#legend.draw();
    this.#filters?.draw();
  }

  #makePolicies(): Segmented<Policy> {
    const { store, region } = this.context;
    const certified = vehicleOf(this.context, store.state.vehicle)?.certified ?? [];
    const choices = region.policies.map((value) => ({
      value,
      name: policyWords[value].name,
      title: certified.includes(value) ? policyWords[value].meaning : `Not certified: netcert certify --corridor ${value}`,
      disabled: !certified.includes(value),
    }));
    const made = new Segmented<Policy>("policy", "Which strip of the road it may use", choices, (policy) => {
      const { other } = store.state;
      const kept = other && vehicleOf(this.context, other)?.certified.includes(policy) ? other : null;
      store.set({ policy, other: kept });
    });
    this.#policyPlace.replaceChildren(made.element);
    return made;
  }

  #base(): HTMLElement | null {
    const { store, region } = this.context;
    if (!region.base_map) return null;
    const host = new URL(region.base_map.url.replaceAll(/[{}]/g, "")).host;
    const input = h("input", { type: "checkbox", checked: store.state.baseMap, onchange: () => store.set({ baseMap: input.checked }) });
    return h("label", { class: "legend-row", title: `Asks ${host} for pictures of what you look at` }, input, h("span", { class: "legend-name" }, `Base map from ${host}`));
  }

  /** Folds the panel where it would cover the map. */
  close(): void {
    this.#fold(false);
  }

  #fold(open: boolean): void {
    byId("side").classList.toggle("is-open", open);
    this.#foldButton.setAttribute("aria-expanded", String(open));
  }
}

function attribution(text: string, timestamp: string | null): string {
  return timestamp ? `${text}, data of ${timestamp.slice(0, 10)}` : text;
}
