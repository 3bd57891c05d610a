// The explanation of a road or turn: the server's sentences and scope, and the picture of the swept path.

import { api, type Question } from "../api/client.ts";
import type { Changed, Editing, Explanation, Policy, Position, Shapes, VerdictName } from "../api/types.ts";
import { h, prose, shielded } from "../ui/dom.ts";
import { icon } from "../ui/icons.ts";
import { distance, length } from "../units.ts";
import { className, evidenceWords, margin, policyWords, reasonWords, refs, title, verdictWords } from "../words.ts";
import { labelled, mapKey } from "./mapkey.ts";
import { measurements } from "./measure.ts";
import { Picture } from "./picture.ts";
import { headline, help, sentence } from "./plain.ts";
import { suppose } from "./suppose.ts";
import type { Trace } from "./traced.ts";

/** The functions of the page that the panel uses. */
export interface Around {
  /** Marks the limiting place, and moves the map there if `goTo` is true. */
  place(explanation: Explanation | null, goTo: boolean): void;
  /** Draws the shapes of an explanation on the map; null removes them. */
  shapes(shapes: Shapes | null): void;
  /** The vehicle and policy of the other map, if there is one. */
  other(): Question | null;
  /** Opens another road. */
  select(id: string): void;
  /** Lets a route begin or end here. */
  route(end: "from" | "to", place: Position, name: string): void;
  /** What a printed sheet says of the database. */
  source(): Node;
  /** Who may change the register of measurements. */
  editing: Editing;
  /** Shows the page anew after a change of the database, with words about the change. */
  renew(words: string): void;
  /** Traces an area on the map. */
  trace: Trace;
  /** The change of a road or turn since the older database while changes are shown, and the words for it. */
  changed(id: string): { changed: Changed; note: HTMLElement } | null;
}

export class ExplainPanel {
  readonly element = h("div", { class: "explain" });
  readonly #picture = new Picture();
  /** The place of the key to the shapes on the map. */
  readonly #key = h("div", { class: "map-key" });
  /** The place of what changed since the older database. */
  readonly #changed = h("div", { class: "changed-place" });
  #running: AbortController | undefined;

  constructor(private readonly around: Around) {}

  /** Loads and shows an explanation. `goTo` moves the map there. Returns whether there is such a road. */
  async show(id: string, question: Question, goTo: boolean): Promise<void> {
    this.#running?.abort();
    const running = (this.#running = new AbortController());
    this.around.place(null, false);
    this.around.shapes(null);
    this.#key.replaceChildren();
    this.#tell(id);
    const { changed } = this.around.changed(id) ?? {};
    if (changed?.change === "went") {
      const name = changed.kind === "turn" ? `Turn ${changed.name ?? ""}` : title(changed);
      const why = "This database does not have it, so there is nothing to explain.";
      this.element.replaceChildren(h("h2", {}, name), this.#changed, h("p", { class: "note" }, why));
      return;
    }
    this.element.replaceChildren(this.#changed, h("p", { class: "waiting" }, "Certifying again, to explain why …"));
    try {
      const other = this.around.other();
      const [own, beside] = await Promise.all([
        // Two policies do not compare.
        api.explain(id, question, running.signal, other?.policy === question.policy ? other.vehicle : undefined).catch((error: unknown) => {
          // Vehicles that were certified with other settings do not compare either; each has its own explanation still.
          if (!other || running.signal.aborted) throw error;
          return api.explain(id, question, running.signal);
        }),
        other ? api.explain(id, other, running.signal).catch(() => null) : null,
      ]);
      this.element.replaceChildren(...this.#content(id, question, own, other && beside ? { other, beside } : null));
      this.around.place(own, goTo);
      void this.#draw(id, question, running.signal);
    } catch (error) {
      if (running.signal.aborted) return;
      this.element.replaceChildren(h("h2", {}, "Nothing to explain"), h("p", { class: "problem", role: "alert" }, (error as Error).message));
    }
  }

  /** Tells of the change of what is shown. What is gone has no explanation. */
  async changesKnown(id: string, question: Question): Promise<void> {
    if (this.around.changed(id)?.changed.change === "went") await this.show(id, question, false);
    else this.#tell(id);
  }

  #tell(id: string): void {
    const known = this.around.changed(id);
    this.#changed.replaceChildren(...(known ? [known.note] : []));
  }

  /** Ends what is under way, because nothing is chosen any more. */
  end(): void {
    this.#running?.abort();
    this.around.place(null, false);
    this.around.shapes(null);
  }

  /** Draws the shapes on the map, and tells in the panel what they mean. */
  async #draw(id: string, question: Question, signal: AbortSignal): Promise<void> {
    try {
      const shapes = await api.shapes(id, question, signal);
      if (signal.aborted) return;
      this.around.shapes(labelled(shapes));
      this.#key.replaceChildren(...mapKey(shapes));
    } catch {
      // The explanation itself is there; the map stays as it is.
    }
  }

  #content(id: string, question: Question, own: Explanation, compared: { other: Question; beside: Explanation } | null): Node[] {
    const { road } = own;
    const more = road
      ? [className(road.highway), `way ${road.way_id}`, road.direction === "backward" ? "against the way’s direction" : "along the way’s direction"]
      : [];
    const nodes: Node[] = [
      h("p", { class: "print-only sheet-head" }, `Evidence sheet: ${question.vehicle}, ${policyWords[question.policy].name.toLowerCase()}`),
      h("h2", {}, ...(own.turn || !road ? [own.turn ?? "Turn at a junction"] : roadTitle(road))),
      h("p", { class: "sub" }, more.join(" · ")),
      this.#changed,
      ...verdict(own, question.policy),
    ];
    if (compared) nodes.push(h("h3", {}, compared.other.vehicle), ...verdict(compared.beside, compared.other.policy), ...relative(question.vehicle, own));
    if (own.picture) {
      const alt = `The swept path where it is tightest: ${own.headline}`;
      nodes.push(this.#picture.show(api.pictureUrl(id, question), alt, this.#running!.signal));
    }
    nodes.push(list("What else would do", help(own, question.policy)), this.#actions(own));
    if (own.suppose && own.verdict === "unsafe") nodes.push(suppose(id, question, own.suppose, (other) => this.around.select(other), this.#running!.signal));
    nodes.push(...measurements(own, { ...this.around, question, signal: this.#running!.signal }));
    nodes.push(this.#key);
    nodes.push(details(own, id));
    nodes.push(h("p", { class: "scope" }, prose([own.note, own.scope].filter(Boolean).join(" "))), h("div", { class: "print-only" }, this.around.source()));
    return nodes;
  }

  /** A route from here or to here, and the sheet to print. */
  #actions(own: Explanation): HTMLElement {
    const line = own.geometry?.coordinates ?? [];
    const place = line[Math.floor(line.length / 2)] ?? own.at;
    const name = own.turn ?? (own.road ? title(own.road) : "Turn at a junction");
    const route = (end: "from" | "to", text: string) =>
      place ? h("button", { class: "small", type: "button", onclick: () => this.around.route(end, place, name) }, icon("route"), text) : null;
    const print = () => {
      for (const more of this.element.querySelectorAll("details")) more.open = true;
      window.print();
    };
    return h(
      "div",
      { class: "tools" },
      route("from", "Route from here"),
      route("to", "Route to here"),
      h("button", { class: "small", type: "button", onclick: print }, icon("sheet"), "Print the evidence"),
    );
  }
}

function roadTitle(road: NonNullable<Explanation["road"]>): (Node | string)[] {
  const numbers = refs(road.ref);
  return numbers.length > 0 ? shielded(numbers, road.name ?? "") : [title(road)];
}

/** The server's own sentences, which name every bound, and the numbers behind them. */
function details(own: Explanation, id: string): HTMLElement {
  return h(
    "details",
    { class: "explain-details" },
    h("summary", {}, "Details"),
    h("p", {}, headline(own)),
    list("What decides", own.reasons),
    list("What would do", own.hints_in_words),
    width(own),
    h("p", { class: "ids" }, own.road ? "Edge " : "Turn ", h("code", {}, own.road?.edge_id ?? id)),
  );
}

/** One vehicle beside the other, in words that cannot be taken for a verdict. */
function relative(vehicle: string, { relative: found }: Explanation): Node[] {
  if (!found) return [];
  const { relative_to: reference, relative_m: metres, as_reference: alike } = found;
  if (metres === null) return [h("p", { class: "sub relative" }, `${vehicle} and ${reference} do not compare here: one of them has no number.`)];
  const apart = length(Math.abs(metres));
  const less = metres < 0 ? `${vehicle} has ${apart} less room here than ${reference}.` : `${vehicle} has ${apart} more room here than ${reference}.`;
  const words = alike
    ? `${vehicle} needs no more room here than ${reference}: it has ${apart} more.`
    : metres < 0
      ? less
      : `${less} A hinge, the steering or the law decides all the same.`;
  return [h("p", { class: "sub relative" }, `${words} That makes nothing certified.`)];
}

/** The verdict as a label, the number, and the server's sentence. */
function verdict(e: Explanation, policy: Policy): Node[] {
  const decided = (e.verdict === "safe" || e.verdict === "unsafe") && e.limiting !== null && e.reason !== "articulation" && e.reason !== "steering_lock";
  const unbounded = e.verdict === "unsafe" && e.limiting !== null && e.limiting.rsc_m === null;
  const number = unbounded ? "Too sharp a bend" : decided && e.limiting ? margin(e.limiting.rsc_m ?? -Infinity) : reasonWords(e.verdict, e.reason);
  return [
    h(
      "div",
      { class: `verdict is-${e.verdict}` },
      h("span", { class: "badge" }, h("i", { class: `line line-${e.verdict}` }), verdictWords[e.verdict as VerdictName].name),
      h("strong", {}, number),
    ),
    h("p", { class: "headline-words" }, sentence(e, policy)),
  ];
}

function list(heading: string, items: string[]): Node {
  if (items.length === 0) return document.createTextNode("");
  return h("section", {}, h("h3", {}, heading), h("ul", {}, ...items.map((item) => h("li", {}, item))));
}

function width(e: Explanation): Node {
  if (!e.road) return document.createTextNode("");
  const source = evidenceWords[e.road.width_source ?? "none"].toLowerCase();
  const width_m = e.limiting?.place.width_m;
  const metres = typeof width_m === "number" ? `${length(width_m)} where it is tightest, ` : "";
  const row = (name: string, value: string) => h("div", {}, h("dt", {}, name), h("dd", {}, value));
  return h(
    "dl",
    { class: "facts" },
    row("May use", policyWords[e.road.corridor].meaning),
    row("Width", `${metres}${source}`),
    e.limiting ? row("Length", distance(e.limiting.length_m)) : null,
  );
}
