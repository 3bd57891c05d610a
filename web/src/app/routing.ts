// From two clicks to a route on the map, its panel, and the drive along it. Where no route is certified, the way that is blocked is shown
// at once, and the route under conditions when it is found.

import { SNAP_M, ServerProblem, api, type RouteQuestion } from "../api/client.ts";
import type { AtMost, Policy, Position, RouteAnswer } from "../api/types.ts";
import { question, vehicleOf, type Context } from "../context.ts";
import { Ends } from "../map/ends.ts";
import { palettes } from "../map/palette.ts";
import { Pins, type Pin } from "../map/pins.ts";
import { RouteLine } from "../map/routeline.ts";
import type { View } from "../map/view.ts";
import { stretch } from "../panel/along.ts";
import { obstacleItems } from "../panel/blocked.ts";
import { conditionItems } from "../panel/conditions.ts";
import type { Item } from "../panel/numbered.ts";
import { RoutePanel, type Around, type Search } from "../panel/route.ts";
import type { About } from "../panel/takealong.ts";
import { Trip, letter, roleOf } from "../panel/trip.ts";
import { UNPLACED, complete, type Places } from "../state.ts";
import { byId } from "../ui/dom.ts";
import { distance } from "../units.ts";
import { toast } from "../ui/toast.ts";
import { Driving } from "./driving.ts";
import type { Drawer } from "./drawer.ts";

/** An answer with what the panel shows of it. */
interface Shown {
  answer: RouteAnswer;
  places: readonly Position[];
  search: Search;
  chosen: number;
  others: Around["others"];
}

export class Routing {
  readonly drive: Driving;
  readonly #panel: RoutePanel;
  readonly #trip: Trip;
  readonly #pins: Pins;
  readonly #ends: Ends;
  readonly #line: RouteLine;
  #items: Item[] = [];
  #shown: Shown | null = null;
  #running: AbortController | undefined;

  constructor(private readonly context: Context, private readonly view: View, private readonly drawer: Drawer) {
    const set = (route: Places) => context.store.set({ route, selected: null });
    this.#line = new RouteLine(view);
    this.#pins = new Pins(view, (number) => this.#choose(number));
    this.#ends = new Ends(view, (index, count) => [letter(index), `${letter(index)}: ${roleOf(index, count)}`], (index, place) => set(this.#places.map((one, other) => (other === index ? place : one))));
    this.#trip = new Trip(set, (atMost) => context.store.set({ atMost }));
    this.drive = new Driving(context, view);
    this.#panel = new RoutePanel(
      {
        drive: () => this.drive.start(),
        seek: (s) => this.drive.seek(s),
        go: (place) => this.#go(place, 16),
        fly: (number) => this.#fly(number),
        explain: (item) => void this.#explain(item),
        others: () => void this.#others(),
        choose: (chosen) => this.#redraw({ chosen }),
        clear: () => {
          set(UNPLACED);
          this.focus();
        },
      },
      this.#trip.element,
    );
  }

  /** The strips of the database that are wider than the policy's, the narrowest first. */
  get #wider(): Policy[] {
    const { policy } = question(this.context);
    const all: readonly Policy[] = ["lane", "direction", "carriageway"];
    return all.slice(all.indexOf(policy) + 1).filter((one) => this.context.region.policies.includes(one));
  }

  /** How high routes may climb: wider strips, and for some vehicles places at which they are attested. */
  get #rungs(): AtMost[] {
    const attested = vehicleOf(this.context, question(this.context).vehicle)?.may_be_attested;
    return attested ? [...this.#wider, "attested"] : this.#wider;
  }

  get #question(): RouteQuestion {
    const { atMost } = this.context.store.state;
    return { ...question(this.context), atMost: atMost && this.#rungs.includes(atMost) ? atMost : null };
  }

  get #places(): Position[] {
    return [...(this.context.store.state.route ?? UNPLACED)] as Position[];
  }

  /** Puts the focus into the first field without a place. */
  focus(): void {
    this.#trip.focus();
  }

  /** Takes a place for the first that is not chosen yet. */
  take(place: Position): void {
    const places: (Position | null)[] = this.#places;
    places[places.indexOf(null)] = place;
    this.context.store.set({ route: places });
  }

  /** Lets the route begin or end at a place. Another end that is chosen stays. */
  from(end: "from" | "to", place: Position, name: string): void {
    this.#trip.name(place, name);
    const places: (Position | null)[] = this.#places;
    places[end === "from" ? 0 : places.length - 1] = place;
    this.context.store.set({ route: places, selected: null });
  }

  update(): void {
    const { route } = this.context.store.state;
    const all = complete(route);
    this.#running?.abort();
    this.#shown = null;
    this.drive.offer(null);
    this.#ends.show(route ?? []);
    this.#line.show("certified", [], { others: [], oncoming: [] }, this.context.theme.theme);
    this.#pin("obstacle", []);
    document.body.classList.toggle("is-routing", route !== null && !all);
    document.body.classList.toggle("has-route", route !== null);
    if (route === null) return;
    this.#trip.show(route);
    this.#trip.offer(this.#rungs, this.#question.atMost);
    this.#panel.waiting(route);
    if (all) void this.#ask(all);
  }

  /** Shows the route's panel, if there is a route or one is being chosen. Returns whether there is. */
  present(): boolean {
    if (this.context.store.state.route === null) return false;
    this.drawer.show(this.#panel.element);
    return true;
  }

  /** Draws everything anew, because theme or units are other ones. */
  recolour(): void {
    this.#line.recolour(this.context.theme.theme);
    this.drive.recolour();
    this.#redraw({});
  }

  async #ask(places: readonly Position[]): Promise<void> {
    const running = (this.#running = new AbortController());
    const { signal } = running;
    const own = this.#question;
    let blocked: RouteAnswer | null = null;
    try {
      blocked = await this.#first(places, signal);
      if (blocked?.routes[0]) return this.#show(blocked, places);
      if (blocked) this.#show(blocked, places, "searching");
      else this.#panel.searching();
      const answer = await api.route(places, own, "search", signal);
      this.#show(answer, places, answer.conditional || answer.routes[0] ? undefined : "none");
    } catch (error) {
      if (signal.aborted) return;
      const message = (error as Error).message;
      if (blocked) return this.#show(blocked, places, { failed: message });
      this.#panel.failed(named(message, places), this.#offer(error, places));
      this.#fit(places);
    }
  }

  /** The answer without conditions. Null if a place is near no certified road: it may be near one that a condition opens. */
  async #first(places: readonly Position[], signal: AbortSignal): Promise<RouteAnswer | null> {
    try {
      return await api.route(places, this.#question, "none", signal);
    } catch (error) {
      if (error instanceof ServerProblem && error.problem.status === 422) return null;
      throw error;
    }
  }

  /** The nearest certified road, in place of one of the places that is too far away from all. */
  #offer(error: unknown, places: readonly Position[]): { text: string; take(): void } | null {
    const { nearest, place } = error instanceof ServerProblem ? error.problem : {};
    // The server rounds places to micrometres or less.
    const at = place ? places.findIndex(([lon, lat]) => Math.hypot(lon - place.lon, lat - place.lat) < 1e-5) : -1;
    if (!nearest || at < 0) return null;
    const near: Position = [nearest.lon, nearest.lat];
    const route = places.map((one, other) => (other === at ? near : one));
    const text = `Move ${letter(at)} to the nearest certified road, ${distance(nearest.distance_m)} away`;
    return { text, take: () => this.context.store.set({ route }) };
  }

  /** Asks for other certified ways. The best one stays on the map meanwhile. */
  async #others(): Promise<void> {
    const places = this.#shown?.places;
    const signal = this.#running?.signal;
    if (!places) return;
    this.#redraw({ others: "waiting" });
    try {
      const answer = await api.otherRoutes(places, this.#question, signal);
      this.#redraw({ answer, others: "asked" });
      byId("drawer").querySelector<HTMLElement>(".other-way")?.focus();
    } catch (error) {
      if (!signal?.aborted) this.#redraw({ others: { failed: (error as Error).message } });
    }
  }

  #show(answer: RouteAnswer, places: readonly Position[], search?: Search): void {
    this.#shown = { answer, places, search, chosen: 0, others: "unasked" };
    const line = this.#redraw({});
    // The map stays where the reader has gone meanwhile.
    const gone = this.context.store.state.selected !== null || search === "none" || typeof search === "object";
    if (!gone) this.#fit([...places, ...line]);
  }

  /** Draws panel, line and pins, with what has changed. Returns the line. */
  #redraw(changed: Partial<Shown>): Position[] {
    if (!this.#shown) return [];
    this.#shown = { ...this.#shown, ...changed };
    const { answer, places, search, chosen, others } = this.#shown;
    const { theme } = this.context.theme;
    const own = this.#question;
    const { conditional, routes, blocked_way: way } = answer;
    const best = routes[chosen];
    this.drive.offer(best ?? null);
    this.#items = best ? [] : conditional ? conditionItems(conditional) : obstacleItems(answer.obstacles ?? []);
    const sheet = (form: "html" | "csv" | "geojson") => api.sheetUrl(form, places, own);
    const decision = api.decisionUrl(places, own);
    this.#panel.show(answer, this.#items, { palette: palettes[theme], command: this.#command(places), sheet, decision, search, chosen, others, about: this.#about(answer) });
    const line = (best?.geometry ?? conditional?.geometry ?? way)?.coordinates ?? [];
    const beside = routes.filter((one) => one !== best).map(({ geometry }) => geometry.coordinates);
    const oncoming = (best?.uses ?? []).filter(({ strip }) => strip === "carriageway");
    const dashed = best ? oncoming.map(({ from_m, to_m }) => stretch(best, from_m, to_m)) : [];
    this.#line.show(best ? "certified" : conditional ? "conditional" : "blocked", line, { others: beside, oncoming: dashed }, theme);
    this.#pin(conditional ? "condition" : "obstacle", this.#items);
    return line;
  }

  #command(places: readonly Position[]): string {
    const { vehicle, policy, atMost } = this.#question;
    const at = places.map((place) => place.map((degrees) => degrees.toFixed(6)).join(","));
    const via = at.slice(1, -1).map((one) => ` --via ${one}`).join("");
    return `netcert route --vehicle ${vehicle} --corridor ${policy} --from ${at[0]}${via} --to ${at.at(-1)} --snap ${SNAP_M}${atMost ? ` --at-most ${atMost}` : ""}`;
  }

  #about({ scope }: RouteAnswer): About {
    const { region } = this.context;
    const { vehicle, policy } = question(this.context);
    return { vehicle, vehicleName: vehicleOf(this.context, vehicle)?.name ?? vehicle, policy, database: region.database_hash, timestamp: region.timestamp, scope };
  }

  /** Flies to the pin of a line of the list. */
  #fly(number: number): void {
    const item = this.#items.find((one) => one.number === number);
    this.#panel.mark(number);
    this.#pins.mark(number);
    if (item?.place) this.#go(item.place, 17);
  }

  /** Shows the line of the list that belongs to a pin. */
  #choose(number: number): void {
    this.context.store.set({ selected: null });
    this.#panel.mark(number);
    this.#pins.mark(number);
  }

  #go(center: Position, least: number): void {
    const zoom = Math.max(this.view.map.getZoom(), least);
    const { left, right, top, bottom } = this.#padding();
    this.view.map.flyTo({ center, zoom, offset: [(left - right) / 2, (top - bottom) / 2], duration: 700 });
  }

  /** Opens the explanation of a line's road or turn. The route stays. */
  async #explain({ road, place }: Item): Promise<void> {
    if (!road) return;
    try {
      const id = "edge" in road ? road.edge : await api.turn(road.from, road.to, question(this.context), this.#running?.signal);
      if (place) this.#go(place, 17);
      if (id) this.context.store.set({ selected: id });
      else toast("This movement leads over several nodes and has no explanation of its own. Click on one of its roads.");
    } catch (error) {
      if (!this.#running?.signal.aborted) toast((error as Error).message);
    }
  }

  #padding(): { left: number; right: number; top: number; bottom: number } {
    const wide = innerWidth >= 760;
    return wide ? { left: byId("side").offsetWidth + 60, right: byId("drawer").offsetWidth + 80, top: 60, bottom: 60 } : { left: 30, right: 95, top: 60, bottom: Math.min(byId("drawer").offsetHeight, innerHeight * 0.6) + 40 };
  }

  #fit(line: readonly Position[]): void {
    const [lons, lats] = [line.map(([lon]) => lon), line.map(([, lat]) => lat)];
    const [w, s, e, n] = [Math.min(...lons), Math.min(...lats), Math.max(...lons), Math.max(...lats)];
    this.view.map.fitBounds([w, s, e, n], { padding: this.#padding(), maxZoom: 17, duration: 700 });
  }

  #pin(kind: "condition" | "obstacle", items: Item[]): void {
    this.#pins.show(kind, items.filter((item): item is Item & Pin => item.place !== null));
  }
}

/** Replaces the degrees of a place in a message of the server by the name of its pin. */
function named(message: string, places: readonly Position[]): string {
  const at = places.findIndex((place) => message.startsWith(`${place.map((degrees) => degrees.toFixed(5)).join(",")}: `));
  if (at < 0) return message;
  const rest = message.replace(/^[^:]*: /, "").replace(/, at [-\d.]+,[-\d.]+/, "");
  return `At ${letter(at)} ${rest}. Drag the pin to a road that is drawn as certified.`;
}
