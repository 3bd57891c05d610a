// From two clicks to a route on the map, its panel, and the drive along it.

import { Marker } from "maplibre-gl";
import { SNAP_M, api } from "../api/client.ts";
import type { Position, Route } from "../api/types.ts";
import { question, vehicleOf, type Context } from "../context.ts";
import { Dock } from "../drive/dock.ts";
import { palettes } from "../map/palette.ts";
import type { View } from "../map/view.ts";
import { RoutePanel } from "../panel/route.ts";
import { byId, h } from "../ui/dom.ts";
import type { Drawer } from "./drawer.ts";

const LINE = "own-route";
const BLOCKED = "own-blocked";

export class Routing {
  readonly #panel: RoutePanel;
  readonly #markers: Marker[] = [];
  #route: Route | null = null;
  #dock: Dock | null = null;
  #running: AbortController | undefined;

  constructor(private readonly context: Context, private readonly view: View, private readonly drawer: Drawer) {
    const { store } = context;
    this.#panel = new RoutePanel({
      drive: () => this.drive(),
      seek: (s) => this.#seek(s),
      select: (id, place) => {
        if (place) this.view.map.easeTo({ center: place, zoom: Math.max(this.view.map.getZoom(), 16) });
        if (id) store.set({ selected: id, route: null });
      },
      swap: () => store.set({ route: store.state.route ? [...store.state.route].reverse() : null }),
      clear: () => store.set({ route: [] }),
    });
  }

  get driving(): boolean {
    return this.#dock !== null;
  }

  update(): void {
    const { route, selected } = this.context.store.state;
    this.#running?.abort();
    this.#route = null;
    this.endDrive();
    this.#mark(route ?? []);
    this.#line(null);
    this.#blocked([]);
    document.body.classList.toggle("is-routing", route !== null && route.length < 2);
    if (route === null) {
      if (!selected) this.drawer.hide();
      return;
    }
    this.drawer.show(this.#panel.element);
    this.#panel.waiting(route.length);
    const [from, to] = route;
    if (from && to) void this.#ask(from, to);
  }

  async #ask(from: Position, to: Position): Promise<void> {
    const running = (this.#running = new AbortController());
    try {
      const own = question(this.context);
      const answer = await api.route(from, to, own, running.signal);
      this.#route = answer.routes[0] ?? null;
      const place = (p: Position) => p.map((degrees) => degrees.toFixed(6)).join(",");
      const command = `netcert route --vehicle ${own.vehicle} --corridor ${own.policy} --from ${place(from)} --to ${place(to)} --snap ${SNAP_M}`;
      this.#panel.show(answer, palettes[this.context.theme.theme], command);
      this.#line(this.#route);
      if (this.#route) this.#fit(this.#route.geometry.coordinates);
      else {
        const places = (answer.obstacles ?? []).flatMap(({ place }) => (place ? [place] : []));
        this.#blocked(places);
        this.#fit([from, to, ...places]);
      }
    } catch (error) {
      if (running.signal.aborted) return;
      this.#panel.failed(named((error as Error).message, [from, to]));
      this.#fit([from, to]);
    }
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
    this.#line(this.#route);
    this.#dock?.recolour(palettes[this.context.theme.theme]);
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

  #fit(line: Position[]): void {
    const [lons, lats] = [line.map(([lon]) => lon), line.map(([, lat]) => lat)];
    const [w, s, e, n] = [Math.min(...lons), Math.min(...lats), Math.max(...lons), Math.max(...lats)];
    const wide = innerWidth >= 760;
    const padding = wide ? { left: byId("side").offsetWidth + 60, right: byId("drawer").offsetWidth + 80, top: 60, bottom: 60 } : { left: 30, right: 30, top: 120, bottom: innerHeight * 0.5 };
    this.view.map.fitBounds([w, s, e, n], { padding, maxZoom: 17, duration: 700 });
  }

  #line(route: Route | null): void {
    void this.view.ready.then(() => {
      const { map } = this.view;
      const coordinates = route?.geometry.coordinates ?? [];
      this.view.overlay(LINE, { type: "FeatureCollection", features: coordinates.length > 1 ? [{ type: "Feature", properties: {}, geometry: { type: "LineString", coordinates } }] : [] });
      const palette = palettes[this.context.theme.theme];
      const layers = [
        { id: `${LINE}-casing`, colour: palette.routeCasing, width: 7 },
        { id: `${LINE}-line`, colour: palette.route, width: 3.2 },
      ];
      for (const { id, colour, width } of layers) {
        if (!map.getLayer(id)) {
          const before = map.getLayer("names") ? "names" : undefined;
          map.addLayer(
            {
              id,
              type: "line",
              source: LINE,
              layout: { "line-cap": "round", "line-join": "round" },
              paint: { "line-width": width, "line-opacity": ["interpolate", ["linear"], ["zoom"], 16.5, 0.9, 18, 0] },
            },
            before,
          );
        }
        map.setPaintProperty(id, "line-color", colour);
      }
    });
  }

  /** Marks the obstacles that block the route. */
  #blocked(places: Position[]): void {
    void this.view.ready.then(() => {
      const { map } = this.view;
      const point = (place: Position): GeoJSON.Feature => ({ type: "Feature", properties: {}, geometry: { type: "Point", coordinates: place } });
      this.view.overlay(BLOCKED, { type: "FeatureCollection", features: places.map(point) });
      const palette = palettes[this.context.theme.theme];
      if (!map.getLayer(BLOCKED)) map.addLayer({ id: BLOCKED, type: "circle", source: BLOCKED, paint: { "circle-radius": 5, "circle-stroke-width": 2.5 } });
      map.setPaintProperty(BLOCKED, "circle-color", palette.missing[3]);
      map.setPaintProperty(BLOCKED, "circle-stroke-color", palette.routeCasing);
    });
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
        this.context.store.set({ route });
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
