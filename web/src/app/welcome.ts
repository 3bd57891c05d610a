// The welcome of a first visit: what the map shows, one example trip, and the drive, in three steps.

import { api } from "../api/client.ts";
import type { Policy, Position } from "../api/types.ts";
import { DEGREE_M } from "../coordinate.ts";
import { question, vehicleOf, type Context } from "../context.ts";
import type { View } from "../map/view.ts";
import { h } from "../ui/dom.ts";
import { icon } from "../ui/icons.ts";
import { toast } from "../ui/toast.ts";
import { VERDICTS, policyWords, regionName, verdictWords } from "../words.ts";

const KEY = "netcert.welcomed";
/** An example is about so long, metres, or as long as the region allows. */
const USUAL_M = 5000;
/** Pairs of places that are tried. Each costs a search and a certificate. */
const MOST_TRIES = 9;
/** Shares of that length, because in towns a long way is certified more rarely. */
const SHARES = [1, 0.5, 0.25];
/** A route with so many turns is a good example. */
const ENOUGH_TURNS = 2;

export interface WelcomeActions {
  chooseVehicle(): void;
  help(): void;
}

/** Whether the page has been seen on this machine before. */
export function welcomed(): boolean {
  try {
    return localStorage.getItem(KEY) !== null;
  } catch {
    return false;
  }
}

function setWelcomed(): void {
  try {
    localStorage.setItem(KEY, "1");
  } catch {
    // Private windows may refuse storage. The welcome is then shown again.
  }
}

export class Welcome {
  readonly element = h("div", { class: "welcome" });
  readonly #vehicle = h("strong", {});
  readonly #told = h("p", { class: "note", role: "status" });

  #looking: AbortController | undefined;

  constructor(private readonly context: Context, private readonly view: View, actions: WelcomeActions) {
    const step = (heading: string, words: (Node | string)[], button: HTMLElement | null) => h("li", {}, h("h3", {}, heading), h("p", {}, ...words), button);
    const lines = VERDICTS.map((name) => h("li", {}, h("i", { class: `line line-${name}`, "aria-hidden": "true" }), h("span", {}, h("strong", {}, verdictWords[name].name), `: ${verdictWords[name].meaning}`)));
    this.element.append(
      h("h2", {}, `Which roads fit a long vehicle? ${regionName(context.region.name)}`),
      h("p", {}, "Every line is one direction of a road. Click on one to see why, and what would help."),
      h("ul", { class: "welcome-lines" }, ...lines),
      h(
        "ol",
        { class: "welcome-steps" },
        step("1. The vehicle", ["Now it is the ", this.#vehicle, "."], h("button", { class: "small", type: "button", onclick: actions.chooseVehicle }, "Choose another")),
        step("2. A trip", ["Take an example, or press Route and choose two places of your own."], h("button", { class: "primary", type: "button", onclick: () => void this.#example() }, icon("route"), "An example trip")),
        step("3. The drive", ["Press “Drive it” in the panel of a certified route, and watch where every wheel goes."], null),
      ),
      this.#told,
      h("div", { class: "tools" }, h("button", { class: "small", type: "button", onclick: actions.help }, icon("help"), "How to read this map")),
      h("p", { class: "scope" }, "Certified holds within the stated model, widths and error bounds. It is no permit."),
    );
    this.draw();
  }

  draw(): void {
    const { vehicle } = this.context.store.state;
    this.#vehicle.textContent = vehicleOf(this.context, vehicle)?.name ?? vehicle;
  }

  /** Ends the welcome, because the reader has gone on. */
  end(): void {
    this.#looking?.abort();
    this.#tell("");
    setWelcomed();
  }

  /** Looks for an example trip in sight, and shows it. */
  async #example(): Promise<void> {
    this.#looking?.abort();
    const looking = (this.#looking = new AbortController());
    this.#tell("Looking for a trip, and certifying it …", true);
    try {
      const trip = await exampleTrip(this.context, this.view, looking.signal);
      if (looking.signal.aborted) return;
      const { store } = this.context;
      if (trip && trip.policy !== store.state.policy) toast(`The example: ${policyWords[trip.policy].name.toLowerCase()}. ${policyWords[trip.policy].meaning}`);
      this.#tell(trip ? "" : "No certified trip was found in sight. Move the map, or choose another vehicle or strip.");
      if (trip) store.set({ route: trip.places, policy: trip.policy, selected: null });
    } catch (error) {
      if (!looking.signal.aborted) this.#tell((error as Error).message);
    }
  }

  #tell(text: string, waiting = false): void {
    this.#told.className = waiting ? "waiting" : "note";
    this.#told.textContent = text;
  }
}

const metres = ([a, b]: Position, [c, d]: Position): number => DEGREE_M * Math.hypot((c - a) * Math.cos((b * Math.PI) / 180), d - b);

/** The certified lines in sight. */
function certified(view: View): Position[][] {
  const layers = ["edge-safe", "overview-safe"].filter((id) => view.map.getLayer(id));
  return view.map.queryRenderedFeatures({ layers }).flatMap(({ geometry }) => {
    const lines = geometry.type === "LineString" ? [geometry.coordinates] : geometry.type === "MultiLineString" ? geometry.coordinates : [];
    return lines as Position[][];
  });
}

/** Two places on the longest certified line in sight: a drive straight on, where no other trip is certified. */
function straightOn(view: View): Position[] | null {
  const length = (line: Position[]): number => metres(line[0]!, line.at(-1)!);
  const longest = certified(view).reduce<Position[] | null>((best, one) => (one.length > 1 && (!best || length(one) > length(best)) ? one : best), null);
  const along = (share: number): Position => {
    const at = share * (longest!.length - 1);
    const [a, b] = [longest![Math.floor(at)]!, longest![Math.ceil(at)]!];
    return [a[0] + (at % 1) * (b[0] - a[0]), a[1] + (at % 1) * (b[1] - a[1])];
  };
  return longest && [along(0.2), along(0.8)];
}

interface Trip {
  places: readonly Position[];
  policy: Policy;
}

/**
 * Two places in sight with a certified route between them, if possible one with turns. In their own lane long vehicles turn hardly
 * anywhere, so wider strips are tried, too. The server certifies each route that is tried.
 */
async function exampleTrip(context: Context, view: View, signal: AbortSignal): Promise<Trip | null> {
  const all = certified(view).map((line) => line[Math.floor(line.length / 2)]!);
  if (all.length === 0) return null;
  const { vehicle, policy: own } = question(context);
  const wider = (vehicleOf(context, vehicle)?.certified ?? []).filter((policy) => policy !== own);
  const spread = Math.max(...all.slice(0, 200).map((one) => metres(all[0]!, one)));
  const wanted = Math.min(USUAL_M, 0.6 * spread);
  const pairs = Array.from({ length: MOST_TRIES }, (_, tried): readonly Position[] => {
    const from = all[Math.floor((tried / MOST_TRIES) * all.length)]!;
    const off = (one: Position): number => Math.abs(metres(from, one) - wanted * SHARES[tried % SHARES.length]!);
    return [from, all.reduce((best, one) => (off(one) < off(best) ? one : best))];
  });
  const turnsOf = async ({ places, policy }: Trip): Promise<number> => {
    const answer = await api.route(places, { vehicle, policy, atMost: null }, "none", signal).catch((error: unknown) => {
      if (signal.aborted) throw error;
      return null;
    });
    return answer?.routes[0]?.parts.filter(({ kind }) => kind !== "edge").length ?? -1;
  };
  let found: Trip | null = null;
  for (const policy of [own, ...wider]) {
    for (const places of pairs) {
      const trip = { places, policy };
      const turns = await turnsOf(trip);
      if (turns >= 0) found ??= trip;
      if (turns >= ENOUGH_TURNS) return trip;
    }
  }
  const straight = straightOn(view);
  if (found || !straight) return found;
  const trip = { places: straight, policy: own };
  return (await turnsOf(trip)) >= 0 ? trip : null;
}
