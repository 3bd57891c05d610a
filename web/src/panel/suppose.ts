// A slider for a width or a kerb radius: what the road or turn would be if it were measured so. The server certifies it again; the words
// say that this is a supposition.

import { api, type Question } from "../api/client.ts";
import type { Quantity, Supposable, Supposed } from "../api/types.ts";
import { h } from "../ui/dom.ts";
import { distance, length } from "../units.ts";
import { careful, reasonWords } from "../words.ts";

/** The server is asked when the slider has rested for so long, milliseconds. */
const REST_MS = 250;
/** Roads that would open, and are named. */
const MOST_NAMED = 6;

const things: Record<Quantity, string> = {
  kerb_radius: "the kerb radius",
  lane_width: "the lane",
  direction_width: "the lanes of this direction",
  carriageway_width: "the road",
};

const wide = (quantity: Quantity, m: number): string => `${length(m)}${quantity === "kerb_radius" ? "" : " wide"}`;

/** The section of an explanation. `select` opens another road. `signal` ends what is under way. */
export function suppose(id: string, question: Question, own: Supposable, select: (id: string) => void, signal: AbortSignal): HTMLElement {
  const { quantity, now, low, high, step } = own;
  const told = h("p", { class: "suppose-told", role: "status" });
  const opens = h("div", { class: "suppose-opens" });
  const value = h("output", { class: "suppose-value" });
  const name = `Suppose ${things[quantity]} were …`;
  const input = h("input", { type: "range", min: low, max: high, step, value: Math.max(low, Math.min(now, high)), "aria-label": name, oninput: () => moved() });
  const heading = (text: string) => h("h3", {}, text);
  let timer = 0;
  let running: AbortController | undefined;

  const moved = (): void => {
    const metres = Number(input.value);
    value.textContent = wide(quantity, metres);
    input.setAttribute("aria-valuetext", value.textContent);
    told.replaceChildren("…");
    opens.replaceChildren();
    clearTimeout(timer);
    timer = window.setTimeout(() => void ask(metres), REST_MS);
  };
  const ask = async (metres: number): Promise<void> => {
    running?.abort();
    running = new AbortController();
    const both = AbortSignal.any([running.signal, signal]);
    try {
      const answer = await api.suppose(id, metres, question, both);
      told.replaceChildren(...verdict(answer, `if ${things[quantity]} were ${wide(quantity, metres)}`));
      opens.replaceChildren(...others(answer, select));
    } catch (error) {
      if (!both.aborted) told.replaceChildren((error as Error).message);
    }
  };
  const set = (metres: number): void => {
    input.value = String(metres);
    moved();
  };
  signal.addEventListener("abort", () => clearTimeout(timer), { once: true });

  value.textContent = wide(quantity, now);
  told.append(`Now ${quantity === "kerb_radius" ? "it is" : "the narrowest strip here is"} ${wide(quantity, now)}. Move the slider to suppose another value.`);
  return h(
    "section",
    { class: "suppose", "aria-label": "If it were measured" },
    heading("If it were measured"),
    need(own, set),
    h("label", { class: "suppose-label" }, h("span", {}, name), value),
    input,
    told,
    opens,
    h("p", { class: "suppose-scope" }, "A supposition is no certificate. It counts when somebody has measured it."),
  );
}

/** What is known to be enough, with a button that supposes it. */
function need({ quantity, need, need_flare }: Supposable, set: (metres: number) => void): HTMLElement {
  const what = quantity === "kerb_radius" ? "A kerb radius" : { lane_width: "A lane", direction_width: "Lanes of this direction", carriageway_width: "A road" }[quantity];
  if (need !== null) {
    const along = quantity === "kerb_radius" ? "" : ", nowhere narrower along this road,";
    const more = h("button", { class: "small", type: "button", onclick: () => set(need) }, "Suppose it");
    return h("p", { class: "suppose-need" }, h("span", {}, `${what} of at least ${length(need, "up")}${along} would do.`), more);
  }
  if (need_flare !== null) return h("p", { class: "suppose-need" }, `No kerb radius up to ${length(25)} would do, but roads ${length(need_flare, "up")} wide before and after the corner would.`);
  const unknown = quantity === "kerb_radius" ? "Which kerb radius would do is not in the database (netcert certify --needs all puts it there)." : "The database names no width that would do.";
  return h("p", { class: "suppose-need" }, `${unknown} Look with the slider.`);
}

/** What a supposition comes to. `condition` says what is supposed. */
export function verdict({ enough, reason, rsc_m }: Supposed, condition: string): (Node | string)[] {
  const room = rsc_m === null || rsc_m < -100 ? "far too little room" : `${careful(rsc_m)} ${rsc_m < 0 ? "missing" : "to spare"}`;
  const number = enough || reason === "width" ? room : reasonWords("unsafe", reason);
  return [
    h("strong", {}, number),
    ` ${condition}. `,
    h("span", { class: enough ? "suppose-enough" : "" }, enough ? "That would do. Supposed, not certified." : "That would not do."),
  ];
}

/** The other edges of the road that would do, too. */
function others({ opens = [], opens_m = 0 }: Supposed, select: (id: string) => void): Node[] {
  if (opens.length === 0) return [];
  const count = opens.length === 1 ? "One more part of this road" : `${opens.length} more parts of this road`;
  const links = opens.slice(0, MOST_NAMED).map((edge) =>
    h("li", {}, h("button", { class: "link", type: "button", onclick: () => select(edge.edge_id) }, edge.title), h("span", {}, distance(edge.length_m))),
  );
  const rest = opens.length > MOST_NAMED ? `, among them` : "";
  return [h("p", {}, `${count}, ${distance(opens_m)}, would do, too${rest}:`), h("ul", {}, ...links)];
}
