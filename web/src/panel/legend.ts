// Kilometres by verdict beside the lines of the map. The panel is legend, summary and filter in one.

import type { VehicleStats } from "../api/stats.ts";
import type { Policy, VerdictName } from "../api/types.ts";
import { vehicleOf, type Context } from "../context.ts";
import { evidenceColours, missingSteps, palettes, reasonColours, roomSteps, type Palette, type Step } from "../map/palette.ts";
import type { ColourBy } from "../state.ts";
import { h, styled } from "../ui/dom.ts";
import { Segmented } from "../ui/segmented.ts";
import { length, roadLength, spoken } from "../units.ts";
import { EVIDENCE, POLICIES, SHARED_LANE, VERDICTS, evidenceWords, percent, policyWords, reasonWords, routeWords, stripWords, verdictWords } from "../words.ts";

export class Legend {
  readonly element = h("section", { class: "legend", "aria-label": "Roads by verdict" });
  readonly #headline = h("p", { class: "headline", "aria-live": "polite" });
  readonly #bar = h("div", { class: "bar", "aria-hidden": "true" });
  readonly #rows = h("div", { class: "legend-rows" });
  readonly #scale = h("div", { class: "scales" });
  readonly #shared = sharedKey();
  readonly #by: Segmented<ColourBy>;
  #stats: VehicleStats | null = null;

  constructor(private readonly context: Context) {
    this.#by = new Segmented<ColourBy>(
      "colour-by",
      "Colour roads by",
      [
        { value: "margin", name: "Margin", title: "Metres to spare or missing" },
        { value: "reason", name: "Reason", title: "What keeps the vehicle out" },
        { value: "evidence", name: "Evidence", title: "Where the road’s width comes from" },
        { value: "strip", name: "Strip", title: "How much of the road the vehicle has to be given" },
      ],
      (colourBy) => context.store.set({ colourBy }),
    );
    const by = h("div", { class: "labelled" }, h("span", { class: "label", "aria-hidden": "true" }, "Colour by"), this.#by.element);
    this.element.append(this.#headline, this.#bar, this.#rows, by, this.#scale, this.#shared, routeKey());
    this.draw();
  }

  show(stats: VehicleStats | null): void {
    this.#stats = stats;
    this.draw();
  }

  draw(): void {
    const { state } = this.context.store;
    const all = this.#stats ? VERDICTS.reduce((sum, name) => sum + this.#stats!.verdicts[name], 0) : 0;
    this.#by.value = state.colourBy;
    if (this.#stats) {
      const { safe } = this.#stats.verdicts;
      this.#headline.replaceChildren(
        h("strong", {}, roadLength(safe)),
        h("span", {}, ` certified, ${percent(safe, all)} of ${roadLength(all)} (each direction counted)`),
      );
    }
    this.#bar.replaceChildren(
      ...VERDICTS.map((name) => styled(h("i", { class: `fill-${name}` }), { "flex-grow": this.#stats?.verdicts[name] ?? 0 })),
    );
    this.#rows.replaceChildren(...VERDICTS.map((name) => this.#row(name)));
    this.#scale.replaceChildren(...this.#scales());
    this.#shared.hidden = state.policy !== "lane";
  }

  #row(name: VerdictName): HTMLElement {
    const { store } = this.context;
    const shown = !store.state.hidden.has(name);
    const toggle = () => {
      const hidden = new Set(store.state.hidden);
      if (!hidden.delete(name)) hidden.add(name);
      store.set({ hidden });
    };
    const length = this.#stats ? roadLength(this.#stats.verdicts[name]) : "";
    return h(
      "label",
      { class: "legend-row", title: verdictWords[name].meaning },
      h("input", { type: "checkbox", checked: shown, onchange: toggle, "data-verdict": name }),
      h("i", { class: `line line-${name}` }),
      h("span", { class: "legend-name" }, verdictWords[name].name),
      h("span", { class: "legend-km" }, length),
    );
  }

  #scales(): HTMLElement[] {
    const { colourBy } = this.context.store.state;
    const { theme } = this.context.theme;
    const palette = palettes[theme];
    if (colourBy === "evidence") {
      const colours = evidenceColours[theme];
      return [key([...EVIDENCE].map((source) => [evidenceWords[source], colours[source]] as const))];
    }
    if (colourBy === "strip") return this.#strips(palette);
    const room = scale("Room to spare", roomSteps, palette.room);
    if (colourBy === "margin") return [scale("Room missing", missingSteps, palette.missing), room];
    const reasons = Object.entries(reasonColours).filter(([name]) => name.includes("/"));
    return [
      key(reasons.map(([name, colour]) => [reasonWords(...(name.split("/") as [string, string])), colour] as const)),
      room,
    ];
  }

  /** One line for each strip, with its kilometres, and which strips the vehicle is certified for at all. */
  #strips(palette: Palette): HTMLElement[] {
    const certified = vehicleOf(this.context, this.context.store.state.vehicle)?.certified ?? [];
    const row = (strip: Policy | "none", colour: string) =>
      h(
        "p",
        { class: "strip-row", "data-strip": strip },
        styled(h("i", { "aria-hidden": "true" }), { background: colour }),
        h("span", {}, stripWords[strip]),
        h("span", { class: "legend-km" }, this.#stats ? roadLength(this.#stats.strips[strip]) : ""),
      );
    const rows = certified.length === 0 ? [] : POLICIES.filter((policy) => certified.includes(policy)).map((policy) => row(policy, palette.strips[policy]));
    const missing = POLICIES.filter((policy) => !certified.includes(policy)).map((policy) => `“${policyWords[policy].name}”`);
    const note = missing.length === 0 ? [] : [h("p", { class: "strip-note" }, `This database has no certificates for ${missing.join(" and ")}. netcert certify --corridor makes them.`)];
    return [h("div", { class: "strips", role: "group", "aria-label": "Narrowest certified strip" }, h("p", { class: "scale-name", "aria-hidden": "true" }, "Narrowest certified strip"), ...rows, row("none", palette.noStrip), ...note)];
  }
}

/** The lower end of a step. The label of the palette is in metres. */
function stepLabel({ from_m, label }: Step): string {
  return spoken() === "feet" && Number.isFinite(from_m) ? length(Math.abs(from_m)).replace(" ft", "′").replace(" in", "″") : label;
}

function scale(name: string, steps: readonly Step[], colours: readonly string[]): HTMLElement {
  const cells = steps.map((step, index) =>
    h("span", { class: "scale-cell" }, styled(h("i", {}), { background: colours[index] ?? "" }), h("span", {}, stepLabel(step))),
  );
  return h("div", { class: "scale" }, h("span", { class: "scale-name" }, name), h("div", { class: "scale-cells" }, ...cells));
}

/** The lines of verdicts with their names, where the panel with the legend is folded. */
export function verdictKey(): HTMLElement {
  const row = (name: VerdictName) => h("span", { class: "key-item" }, h("i", { class: `line line-${name}`, "aria-hidden": "true" }), verdictWords[name].name);
  return h("div", { class: "compare-key", role: "group", "aria-label": "Lines of both maps" }, ...VERDICTS.map(row));
}

/** The line of certified roads whose lane is the whole road. */
function sharedKey(): HTMLElement {
  return h("p", { class: "key-item shared-key" }, h("i", { class: "line line-shared", "aria-hidden": "true" }), SHARED_LANE);
}

/** The lines of routes, which are seen while there is one. */
function routeKey(): HTMLElement {
  const row = ([kind, text]: readonly [string, string]) => h("span", { class: "key-item" }, h("i", { class: `line line-${kind}`, "aria-hidden": "true" }), text);
  return h("div", { class: "route-key", role: "group", "aria-label": "Lines of a route" }, ...Object.entries(routeWords).map(row));
}

function key(entries: readonly (readonly [string, string])[]): HTMLElement {
  const items = entries.map(([name, colour]) => h("span", { class: "key-item" }, styled(h("i", {}), { background: colour }), name));
  return h("div", { class: "key" }, ...items);
}
