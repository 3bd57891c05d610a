// What somebody measured here: forms that keep a measurement, and the list of those that count. The server certifies again what sees a
// change. Only a server that was started for it takes changes.

import { api, type Question, type ServerProblem } from "../api/client.ts";
import type { Editing, EvidenceChange, Explanation, Measured, Position, Quantity } from "../api/types.ts";
import { h } from "../ui/dom.ts";
import { kept, put } from "../ui/tab.ts";
import { length, spoken } from "../units.ts";
import { quantityWords } from "../words.ts";
import { verdict } from "./suppose.ts";
import { tracer, type Trace } from "./traced.ts";

/** What the form needs of the page. */
export interface Keeping {
  editing: Editing;
  /** The vehicle and policy whose certificates are told of. */
  question: Question;
  /** Shows the page anew, with these words. */
  renew(words: string): void;
  /** Traces an area on the map. */
  trace: Trace;
  /** Ends what is under way. */
  signal: AbortSignal;
}

/** The usual uncertainty of an outline on an aerial picture. Of a surface it is in metres. */
const SURFACE_SIGMA = { value: "0.2", unit: "m" };

interface TokenField {
  element: HTMLElement | null;
  value(): string | null;
}

/** The token that was typed last. It is forgotten with the tab. */
const TOKEN = "netcert.token";

/** The places of a measurement of a road or turn, as `netcert evidence add` names them. */
function place(own: Explanation, quantity: Quantity): Record<string, string | number> | null {
  if (quantity === "kerb_radius") {
    const { junction, from_edge, to_edge } = own;
    return junction && from_edge && to_edge ? { junction, from_edge, to_edge } : null;
  }
  if (!own.road) return null;
  const { edge_id, way_id, from_node, to_node } = own.road;
  // A road's width is that of both directions.
  return quantity === "carriageway_width" ? { way_id, from_node, to_node } : { edge_id };
}

/** What was measured here. Empty if nothing was and nothing can be. */
export function measurements(own: Explanation, keeping: Keeping): Node[] {
  const { measurements: known } = own;
  const list = known.length > 0 ? [h("ul", {}, ...known.map((one) => line(one, keeping)))] : [];
  const forms = keeping.editing === "off" ? [] : [own.suppose && form(own, own.suppose.quantity, keeping), traced(own, keeping)];
  const shown = [...list, ...forms.filter((one) => one !== null)];
  if (shown.length === 0) return [];
  return [h("section", { class: "measured", "aria-label": "Measured" }, h("h3", {}, "Measured"), ...shown)];
}

/** One measurement, with a button that removes it. */
function line(one: Measured, keeping: Keeping): HTMLElement {
  const value = one.value === null ? "" : one.quantity === "max_weight" ? ` ${one.value} t` : ` ${length(one.value)}`;
  const words = `${quantityWords[one.quantity] ?? one.quantity}${value}, ${[one.source, one.date].filter(Boolean).join(", ")}`;
  if (keeping.editing === "off") return h("li", {}, words);
  const told = h("span", { class: "measured-told", role: "status" });
  const remove = h("button", { class: "small", type: "button", "aria-label": `Remove the measurement: ${words}`, onclick: () => void go() }, "Remove");
  const token = tokenField(keeping);
  const go = async (): Promise<void> => {
    if (!window.confirm(`Remove this measurement?\n\n${words}`)) return;
    await change(remove, told, () => api.forget(one.evidence_no, token.value()), (answer) => keeping.renew(`Removed. ${changes(answer, keeping.question.vehicle)}`));
  };
  return h("li", {}, words, remove, token.element, told);
}

/** The form for a number. Its value begins empty, so that nobody keeps what nobody measured. */
function form(own: Explanation, quantity: Quantity, keeping: Keeping): HTMLElement | null {
  const where = place(own, quantity);
  if (!where) return null;
  const value = number("value", "");
  const words = [h("p", {}, about(quantity)), labelled(`${quantityWords[quantity]}, ${unit()}`, value)];
  const feature = (): Feature => ({ geometry: null, properties: { quantity, value: value.value, unit: unit(), ...where } });
  const usual = unit() === "ft" ? { value: "0.2", unit: "ft" } : { value: "0.05", unit: "m" };
  return keepForm("I measured it", words, usual, { ...keeping, token: tokenField(keeping) }, feature);
}

/** The form for the paved surface of a junction. */
function traced(own: Explanation, keeping: Keeping): HTMLElement | null {
  if (own.kind !== "turn" || (own.verdict !== "safe" && own.verdict !== "unsafe")) return null;
  const token = tokenField(keeping);
  const surface = (coordinates: Position[]): Feature => ({ geometry: { type: "Polygon", coordinates: [coordinates] }, properties: { quantity: "surface" } });
  // What it comes to is said at once, with the usual uncertainty; what counts is what is kept.
  const suppose = async (coordinates: Position[], told: HTMLElement): Promise<void> => {
    const made = surface(coordinates);
    const properties = { ...made.properties, sigma: SURFACE_SIGMA.value, source: "supposed" };
    try {
      const answer = await api.supposeSurface(own.turn_id ?? "", { type: "Feature", geometry: made.geometry, properties }, keeping.question, token.value(), keeping.signal);
      told.replaceChildren(...verdict(answer, "if all of it were paved"));
    } catch (error) {
      if (!keeping.signal.aborted) told.replaceChildren((error as Error).message);
    }
  };
  const { element, ring } = tracer(keeping.trace, (closed, told) => void suppose(closed, told), keeping.signal);
  const words = [
    h("p", {}, "What is paved at this junction, without kerbs and islands, as seen on an aerial picture. It counts beside the roads as they are known, drawn in by 1.64 times its uncertainty."),
    element,
  ];
  const feature = (): Feature | string => {
    const coordinates = ring();
    return coordinates ? surface(coordinates) : "Trace the surface first.";
  };
  return keepForm("I traced what is paved", words, SURFACE_SIGMA, { ...keeping, token }, feature);
}

interface Feature {
  geometry: object | null;
  properties: Record<string, string | number>;
}

/** A form with who and when. `feature` is what is measured, or why it cannot be kept yet. `usual` is the usual uncertainty. */
function keepForm(title: string, words: Node[], usual: { value: string; unit: string }, keeping: Keeping & { token: TokenField }, feature: () => Feature | string): HTMLElement {
  const sigma = number("sigma", usual.value);
  const source = h("input", { type: "text", name: "source", maxlength: 200, required: true, autocomplete: "off" });
  const date = h("input", { type: "date", name: "date", required: true, value: today() });
  const { token } = keeping;
  const told = h("p", { class: "measured-told", role: "status" });
  const save = h("button", { class: "primary", type: "submit" }, "Keep it, and certify again");
  const fields = h(
    "form",
    { class: "measure-form" },
    ...words,
    labelled(`Standard uncertainty, ${usual.unit}`, sigma),
    labelled("Who measured it, with what", source),
    labelled("On", date),
    token.element,
    save,
    told,
  );
  fields.addEventListener("submit", (event) => {
    event.preventDefault();
    const made = feature();
    if (typeof made === "string") return told.replaceChildren(made);
    const properties = { ...made.properties, sigma: sigma.value, source: source.value, date: date.value };
    void change(save, told, () => api.measure({ type: "Feature", geometry: made.geometry, properties }, token.value()), (answer) => tell(answer, told, keeping));
  });
  return h("details", { class: "measure" }, h("summary", {}, title), fields);
}

const unit = (): string => (spoken() === "feet" ? "ft" : "m");
const number = (name: string, value: string) => h("input", { type: "number", name, min: 0, step: "any", inputmode: "decimal", required: true, value });
const labelled = (words: string, input: HTMLElement) => h("label", {}, h("span", {}, words), input);

/** What a measurement of this road or turn is about. */
function about(quantity: Quantity): string {
  const scope = "What counts is the value less 1.64 times its uncertainty.";
  if (quantity === "kerb_radius") return `The radius of the kerb at the inner side of this turn. ${scope}`;
  const of = { lane_width: "of the lane", direction_width: "of all lanes of this direction", carriageway_width: "between the kerbs" }[quantity];
  return `The narrowest width ${of} on this part of the road. ${scope}`;
}

/** Asks for a change with the button locked. A refusal is told beside it. */
async function change(button: HTMLButtonElement, told: HTMLElement, ask: () => Promise<EvidenceChange>, done: (answer: EvidenceChange) => void): Promise<void> {
  button.disabled = true;
  told.replaceChildren("Certifying again what sees it …");
  try {
    done(await ask());
  } catch (error) {
    const { problem } = error as ServerProblem;
    if (problem?.status === 401) put(TOKEN, null);
    const faults = problem?.faults ?? [];
    told.replaceChildren(...(faults.length > 0 ? faults.map(({ column, what }) => h("span", {}, `${column} ${what}. `)) : [(error as Error).message]));
  }
  button.disabled = false;
}

/** What became of a measurement. */
function tell(answer: EvidenceChange, told: HTMLElement, keeping: Keeping): void {
  const [known, left, added] = [answer.known[0], answer.left_out[0], answer.added[0]];
  if (added) {
    const conflict = answer.conflicts.map(({ what }) => ` Conflict: ${what}.`).join("");
    keeping.renew(`Kept as measurement ${added.no}. ${changes(answer, keeping.question.vehicle)}${conflict}`);
  } else if (known) told.replaceChildren(`The register has it already, as measurement ${known.no}.`);
  else told.replaceChildren(`Not kept: ${left?.why ?? "its place was not found"}.`);
}

/** What became of the verdicts of a vehicle. */
function changes(answer: Pick<EvidenceChange, "sets">, vehicle: string): string {
  const own = answer.sets.filter((set) => set.vehicle === vehicle);
  const sum = (of: "became_safe" | "no_longer_safe") => own.reduce((all, { edges, turns }) => all + edges[of] + (turns?.[of] ?? 0), 0);
  const words = (many: number, what: string) => (many === 0 ? [] : [`${many} ${many === 1 ? "road or turn" : "roads and turns"} ${many === 1 ? "is" : "are"} ${what}`]);
  const told = [...words(sum("became_safe"), "now certified"), ...words(sum("no_longer_safe"), "no longer certified")];
  return told.length > 0 ? `For ${vehicle} ${told.join(", ")}.` : `No verdict of ${vehicle} changed.`;
}

/** The field for the token, where the server wants one. */
function tokenField({ editing }: Keeping): TokenField {
  if (editing !== "token") return { element: null, value: () => null };
  const input = h("input", { type: "password", name: "token", required: true, autocomplete: "off", value: kept(TOKEN) ?? "" });
  const value = (): string => {
    put(TOKEN, input.value);
    return input.value;
  };
  return { element: h("label", {}, h("span", {}, "Token of this server"), input), value };
}

/** The day where the reader is. */
function today(): string {
  const now = new Date();
  return [now.getFullYear(), now.getMonth() + 1, now.getDate()].map((part) => String(part).padStart(2, "0")).join("-");
}
