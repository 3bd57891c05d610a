// From two clicks to a route on the map, its panel, and the drive along it. Where no route is certified, the way that is blocked is shown
// at once, and the route under conditions when it is found.

import { Marker } from "maplibre-gl";
import { SNAP_M, ServerProblem, api } from "../api/client.ts";
import type { Position, Route, RouteAnswer } from "../api/types.ts";
import { question, vehicleOf, type Context } from "../context.ts";
import { Dock } from "../drive/dock.ts";
import { palettes } from "../map/palette.ts";
import { Pins, type Pin } from "../map/pins.ts";
import { RouteLine } from "../map/routeline.ts";
import type { View } from "../map/view.ts";
import { obstacleItems } from "../panel/blocked.ts";
import { conditionItems } from "../panel/conditions.ts";
import type { Item } from "../panel/numbered.ts";
import { RoutePanel, type Search } from "../panel/route.ts";
import { byId, h } from "../ui/dom.ts";
import { toast } from "../ui/toast.ts";
import type { Drawer } from "./drawer.ts";

export class Routing {
  readonly #panel: RoutePanel;
  readonly #pins: Pins;
  readonly #line: RouteLine;
  readonly #markers: Marker[] = [];
  #items: Item[] = [];
  #route: Route | null = null;
  #dock: Dock | null = null;
  #running: AbortController | undefined;

  constructor(private readonly context: Context, private readonly view: View, private readonly drawer: Drawer) {
    const { store } = context;
    this.#line = new RouteLine(view);
    this.#pins = new Pins(view, (number) => this.#choose(number));
    this.#panel = new RoutePanel({
      drive: () => this.drive(),
      seek: (s) => this.#seek(s),
      go: (place) => this.#go(place, 16),
      fly: (number) => this.#fly(number),
      explain: (item) => void this.#explain(item),
      swap: () => store.set({ route: store.state.route ? [...store.state.route].reverse() : null, selected: null }),
      clear: () => store.set({ route: [], selected: null }),
    });
  }

  get driving(): boolean {
    return this.#dock !== null;
  }

  update(): void {
    const { route } = this.context.store.state;
    this.#running?.abort();
    this.#route = null;
    this.endDrive();
    this.#mark(route ?? []);
    this.#line.show("certified", [], this.context.theme.theme);
    this.#pin("obstacle", []);
    document.body.classList.toggle("is-routing", route !== null && route.length < 2);
    document.body.classList.toggle("has-route", route !== null);
    if (route === null) return;
    this.#panel.waiting(route.length);
    const [from, to] = route;
    if (from && to) void this.#ask(from, to);
  }

  /** Shows the route's panel, if there is a route or one is being chosen. Returns whether there is. */
  present(): boolean {
    if (this.context.store.state.route === null) return false;
    this.drawer.show(this.#panel.element);
    return true;
  }

  async #ask(from: Position, to: Position): Promise<void> {
    const running = (this.#running = new AbortController());
    const { signal } = running;
    const own = question(this.context);
    let blocked: RouteAnswer | null = null;
    try {
      blocked = await this.#first(from, to, signal);
      if (blocked?.routes[0]) return this.#show(blocked, from, to);
      if (blocked) this.#show(blocked, from, to, "searching");
      else this.#panel.searching();
      const answer = await api.route(from, to, own, "search", signal);
      this.#show(answer, from, to, answer.conditional || answer.routes[0] ? undefined : "none");
    } catch (error) {
      if (signal.aborted) return;
      const message = (error as Error).message;
      if (blocked) return this.#show(blocked, from, to, { failed: message });
      this.#panel.failed(named(message, [from, to]));
      this.#fit([from, to]);
    }
  }

  /** The answer without conditions. Null if a place is near no certified road: it may be near one that a condition opens. */
  async #first(from: Position, to: Position, signal: AbortSignal): Promise<RouteAnswer | null> {
    try {
      return await api.route(from, to, question(this.context), "none", signal);
    } catch (error) {
      if (error instanceof ServerProblem && error.problem.status === 422) return null;
      throw error;
    }
  }

  #show(answer: RouteAnswer, from: Position, to: Position, search?: Search): void {
    const { theme } = this.context.theme;
    const own = question(this.context);
    const [best] = answer.routes;
    const { conditional } = answer;
    this.#route = best ?? null;
    this.#items = best ? [] : conditional ? conditionItems(conditional) : obstacleItems(answer.obstacles ?? []);
    const place = (p: Position) => p.map((degrees) => degrees.toFixed(6)).join(",");
    const command = `netcert route --vehicle ${own.vehicle} --corridor ${own.policy} --from ${place(from)} --to ${place(to)} --snap ${SNAP_M}`;
    const sheet = (form: "html" | "csv" | "geojson") => api.sheetUrl(form, from, to, own);
    this.#panel.show(answer, this.#items, { palette: palettes[theme], command, sheet, search });
    const line = best?.geometry ?? conditional?.geometry ?? answer.blocked_way;
    this.#line.show(best ? "certified" : conditional ? "conditional" : "blocked", line?.coordinates ?? [], theme);
    this.#pin(conditional ? "condition" : "obstacle", this.#items);
    // The map stays where the reader has gone meanwhile.
    const gone = this.context.store.state.selected !== null || search === "none" || typeof search === "object";
    if (!gone) this.#fit([from, to, ...(line?.coordinates ?? [])]);
  }

  drive(): void {
    const vehicle = vehicleOf(this.context, this.context.store.state.vehicle);
    if (!this.#route || !vehicle) return;
    this.#dock ??= this.#open(this.#route, vehicle);
    this.#dock.start();
  }

  endDrive(): void {
    this.#dock?.remove();
    this.#dock = null;
    document.body.classList.remove("is-driving");
  }

  /** Returns whether there was a drive. */
  toggleDrive(): boolean {
    if (this.#dock) this.#dock.toggle();
    else if (this.#route) this.drive();
    return this.#route !== null;
  }

  recolour(): void {
    const { theme } = this.context.theme;
    this.#line.recolour(theme);
    this.#dock?.recolour(palettes[theme]);
  }

  #open(route: Route, vehicle: NonNullable<ReturnType<typeof vehicleOf>>): Dock {
    const dock = new Dock(this.view, route, vehicle, palettes[this.context.theme.theme], () => this.endDrive());
    byId("bottom").append(dock.element);
    document.body.classList.add("is-driving");
    return dock;
  }

  #seek(s: number): void {
    if (!this.#dock) {
      const vehicle = vehicleOf(this.context, this.context.store.state.vehicle);
      if (!this.#route || !vehicle) return;
      this.#dock = this.#open(this.#route, vehicle);
    }
    this.#dock.seek(s);
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

  #fit(line: Position[]): void {
    const [lons, lats] = [line.map(([lon]) => lon), line.map(([, lat]) => lat)];
    const [w, s, e, n] = [Math.min(...lons), Math.min(...lats), Math.max(...lons), Math.max(...lats)];
    this.view.map.fitBounds([w, s, e, n], { padding: this.#padding(), maxZoom: 17, duration: 700 });
  }

  #pin(kind: "condition" | "obstacle", items: Item[]): void {
    this.#pins.show(kind, items.filter((item): item is Item & Pin => item.place !== null));
  }

  /** Draws pins that can be dragged to another place. */
  #mark(places: Position[]): void {
    while (this.#markers.length > 0) this.#markers.pop()?.remove();
    places.forEach((place, index) => {
      const name = index === 0 ? "A" : "B";
      const element = h("div", { class: "pin", role: "img", "aria-label": index === 0 ? "Where it begins" : "Where it goes" }, name);
      const marker = new Marker({ element, draggable: true }).setLngLat(place).addTo(this.view.map);
      marker.on("dragend", () => {
        const { lng, lat } = marker.getLngLat();
        const route = [...(this.context.store.state.route ?? [])];
        route[index] = [lng, lat];
        this.context.store.set({ route, selected: null });
      });
      this.#markers.push(marker);
    });
  }
}

/** Replaces the degrees of a place in a message of the server by the name of its pin. */
function named(message: string, places: Position[]): string {
  const at = places.findIndex((place) => message.startsWith(`${place.map((degrees) => degrees.toFixed(5)).join(",")}: `));
  if (at < 0) return message;
  const rest = message.replace(/^[^:]*: /, "").replace(/, at [-\d.]+,[-\d.]+/, "");
  return `At ${"AB"[at]} ${rest}. Drag the pin to a road that is drawn as certified.`;
}
