// A region in numbers: tables whose cells are bars, so that what is seen can also be read out.

import { api } from "../api/client.ts";
import { none, type Lengths, type Stats, type VehicleStats } from "../api/stats.ts";
import { vehicleOf, type Context } from "../context.ts";
import { sideView } from "../draw/vehicle.ts";
import { marginColour, palettes } from "../map/palette.ts";
import { Dialog } from "../ui/dialog.ts";
import { h, prose, styled } from "../ui/dom.ts";
import { length, roadLength } from "../units.ts";
import { CLASSES, VERDICTS, className, mainClass, percent, policyWords, reasonWords, regionName, signed, verdictWords } from "../words.ts";

export class StatsDialog {
  readonly #dialog: Dialog;

  constructor(private readonly context: Context) {
    this.#dialog = new Dialog("stats", `${regionName(context.region.name)} in numbers`, () => context.store.set({ stats: false }));
  }

  async open(): Promise<void> {
    this.#dialog.open();
    const { policy, vehicle } = this.context.store.state;
    try {
      const stats = await api.stats(policy);
      const own = stats.vehicles.find(({ id }) => id === vehicle) ?? stats.vehicles[0];
      this.#dialog.body.replaceChildren(...this.#content(stats, own));
    } catch (error) {
      this.#dialog.body.replaceChildren(h("p", { class: "problem", role: "alert" }, (error as Error).message));
    }
  }

  close(): void {
    this.#dialog.close();
  }

  #content(stats: Stats, own: VehicleStats | undefined): Node[] {
    const { region } = this.context;
    const intro = `${roadLength(stats.total_m)} of road, each direction counted; ${policyWords[stats.policy].name.toLowerCase()}.${region.timestamp ? ` Data of ${region.timestamp.slice(0, 10)}.` : ""}`;
    const nodes: Node[] = [h("p", { class: "sub" }, intro), legend(), this.#vehicles(stats)];
    if (own) {
      nodes.push(
        h("h3", { class: "stats-own" }, vehicleOf(this.context, own.id)?.name ?? own.id),
        h("div", { class: "stats-columns" }, classes(own), h("div", {}, limits(own), this.#histogram(own))),
      );
    }
    nodes.push(h("p", { class: "scope" }, prose(stats.scope)));
    return nodes;
  }

  #vehicles(stats: Stats): HTMLElement {
    const sorted = [...stats.vehicles].sort((a, b) => b.verdicts.safe - a.verdicts.safe);
    const longest = Math.max(...this.context.vehicles.map((vehicle) => vehicle.length_m));
    const rows = sorted.map((row) => {
      const vehicle = vehicleOf(this.context, row.id);
      const choose = () => {
        this.context.store.set({ vehicle: row.id });
        void this.open();
      };
      const current = row.id === this.context.store.state.vehicle;
      return h(
        "tr",
        { class: current ? "is-current" : null },
        h("th", { scope: "row" }, h("button", { type: "button", onclick: choose }, vehicle ? sideView(vehicle, longest) : null, h("span", {}, vehicle?.name ?? row.id))),
        h("td", { class: "amount" }, roadLength(row.verdicts.safe)),
        h("td", { class: "amount" }, percent(row.verdicts.safe, total(row.verdicts))),
        h("td", { class: "wide" }, bar(row.verdicts, total(row.verdicts))),
      );
    });
    return table("Every vehicle", ["Vehicle", "Certified", "Share", "Roads by verdict"], rows);
  }

  #histogram(own: VehicleStats): HTMLElement {
    const { from_m, step_m, below_m, above_m, lengths_m } = own.histogram;
    const palette = palettes[this.context.theme.theme];
    const most = Math.max(...lengths_m, 1);
    const columns = lengths_m.map((length, index) => {
      const low = from_m + index * step_m;
      const words = `${signed(low)} to ${signed(low + step_m)}: ${roadLength(length)}`;
      const column = styled(h("i", { title: words }), { height: length > 0 ? `max(1px, ${(100 * length) / most}%)` : "0", background: marginColour(palette, low) });
      return h("span", { class: Math.abs(low) < step_m / 2 ? "is-zero" : null }, column);
    });
    const to = from_m + lengths_m.length * step_m;
    const label = `Road by margin: ${roadLength(below_m)} lack more than ${length(-from_m)}, ${roadLength(above_m)} have more than ${length(to)} to spare.`;
    return h(
      "figure",
      { class: "histogram" },
      h("figcaption", {}, "Roads by margin"),
      h("div", { class: "columns-chart", role: "img", "aria-label": label }, ...columns),
      h("div", { class: "axis", "aria-hidden": "true" }, h("span", {}, signed(from_m)), h("span", {}, "just fits"), h("span", {}, signed(to))),
      h("p", { class: "sub" }, label),
    );
  }
}

function total(lengths: Lengths): number {
  return VERDICTS.reduce((sum, name) => sum + lengths[name], 0);
}

/** A stacked bar; `most` is the length that fills the cell. */
function bar(lengths: Lengths, most: number): HTMLElement {
  const words = VERDICTS.map((name) => `${verdictWords[name].name} ${roadLength(lengths[name])}`).join(", ");
  const parts = VERDICTS.filter((name) => lengths[name] > 0).map((name) => styled(h("i", { class: `fill-${name}` }), { "flex-grow": lengths[name] }));
  const shown = h("div", { class: "bar", role: "img", "aria-label": words, title: words }, ...parts);
  return styled(shown, { width: `${Math.max((100 * total(lengths)) / Math.max(most, 1), 0.5)}%` });
}

function legend(): HTMLElement {
  const items = VERDICTS.map((name) => h("span", { class: "key-item" }, h("i", { class: `fill-${name}` }), verdictWords[name].name));
  return h("div", { class: "key" }, ...items);
}

function classes(own: VehicleStats): HTMLElement {
  const sums = new Map<string, Lengths>();
  for (const row of own.classes) {
    const main = mainClass(row.highway);
    const sum = sums.get(main) ?? none();
    for (const name of VERDICTS) sum[name] += row[name];
    sums.set(main, sum);
  }
  const known = [...sums].sort(([a], [b]) => CLASSES.indexOf(a) - CLASSES.indexOf(b));
  const most = Math.max(...known.map(([, lengths]) => total(lengths)));
  const rows = known.map(([name, lengths]) =>
    h(
      "tr",
      {},
      h("th", { scope: "row" }, className(name)),
      h("td", { class: "amount" }, roadLength(lengths.safe)),
      h("td", { class: "amount" }, percent(lengths.safe, total(lengths))),
      h("td", { class: "wide" }, bar(lengths, most)),
    ),
  );
  return table("By class of road", ["Class", "Certified", "Share", "Length"], rows);
}

function limits(own: VehicleStats): HTMLElement {
  const sorted = [...own.reasons].filter((row) => row.length_m > 0).sort((a, b) => b.length_m - a.length_m).slice(0, 8);
  const most = Math.max(...sorted.map((row) => row.length_m), 1);
  const rows = sorted.map((row) => {
    const shown = styled(h("div", { class: "bar" }, h("i", { class: `fill-${row.verdict} fills` })), { width: `${(100 * row.length_m) / most}%` });
    return h(
      "tr",
      {},
      h("th", { scope: "row" }, reasonWords(row.verdict, row.reason)),
      h("td", { class: "amount" }, roadLength(row.length_m)),
      h("td", { class: "wide" }, shown),
    );
  });
  return table("What limits most", ["Reason", "Road", "Length"], rows);
}

function table(caption: string, columns: string[], rows: HTMLElement[]): HTMLElement {
  const heads = columns.map((column) => h("th", { scope: "col" }, column));
  return h("table", { class: "numbers" }, h("caption", {}, caption), h("thead", {}, h("tr", {}, ...heads)), h("tbody", {}, ...rows));
}
