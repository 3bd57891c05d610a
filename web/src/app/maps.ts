// The map, or two maps side by side that move together.

import { Marker } from "maplibre-gl";
import type { VehicleStats } from "../api/stats.ts";
import type { Position, Shapes } from "../api/types.ts";
import { comparable, question, vehicleOf, type Context } from "../context.ts";
import { HoverCard } from "../map/hovercard.ts";
import { MapNote } from "../map/note.ts";
import { palettes } from "../map/palette.ts";
import { ShapesLayer } from "../map/shapes.ts";
import { sync } from "../map/sync.ts";
import { View, type Under } from "../map/view.ts";
import { verdictKey } from "../panel/legend.ts";
import { VehicleCard } from "../panel/vehicle.ts";
import type { Camera, State } from "../state.ts";
import { byId, h } from "../ui/dom.ts";
import { icon } from "../ui/icons.ts";
import type { Tracing } from "../trace/trace.ts";
import { certifiedWords } from "../words.ts";

/** The name of the bundle that traces areas; the build fills it in. */
declare const TRACE_URL: string;

export interface MapActions {
  click(under: Under | null, lon: number, lat: number): void;
  moved(camera: Camera): void;
  chooseOther(): void;
  endComparing(): void;
}

/** The deepest zoom that fitting a road may use. */
const FIT_ZOOM = 18;

/** A zoom at which tiles have each road by itself and lines are apart. */
const SINGLE_ZOOM = 12;

export class Maps {
  readonly first: View;
  readonly #root = byId("maps");
  readonly #hover: HoverCard;
  readonly #card: VehicleCard;
  readonly #shapes: ShapesLayer;
  #limit: Marker | undefined;
  #outline: Position[] = [];
  #tracing = false;
  #second: { view: View; stop: () => void; pane: HTMLElement } | undefined;

  constructor(private readonly context: Context, private readonly actions: MapActions) {
    this.#hover = new HoverCard(document.body);
    this.#card = new VehicleCard(actions.chooseOther);
    const pane = this.#root.appendChild(h("div", { class: "pane" }));
    this.first = this.#view(pane, context.store.state.vehicle);
    this.#shapes = new ShapesLayer(this.first);
    const note = new MapNote(this.first, context.region, () => this.home());
    // Before the maps, because the style sheet asks which map is the last child.
    this.#root.prepend(note.element, verdictKey());
  }

  update(changed: ReadonlySet<keyof State>): void {
    const { store, theme } = this.context;
    const { state } = store;
    this.first.update(this.#muted(), question(this.context), theme.theme);
    this.#shapes.recolour(theme.theme);
    if (changed.has("other")) this.#compare(state.other);
    if (this.#second && state.other) {
      this.#second.view.update(unchanged(state), { ...question(this.context), vehicle: state.other }, theme.theme);
      if (changed.has("other")) this.#card.show(vehicleOf(this.context, state.other), null);
    }
  }

  /** Shows the numbers of the vehicle on the second map. */
  number(stats: VehicleStats | null): void {
    const { other } = this.context.store.state;
    if (other) this.#card.show(vehicleOf(this.context, other), stats ? certifiedWords(stats.verdicts) : null);
  }

  /** Begins to trace an area on the first map. Clicks choose no road until it is closed. */
  async trace(done: (ring: Position[]) => void): Promise<Tracing> {
    const { trace } = (await import(TRACE_URL)) as typeof import("../trace/trace.ts");
    this.#tracing = true;
    this.first.clear(true);
    const tracing = trace(this.first.map, palettes[this.context.theme.theme].ink, (ring) => {
      // The click that closes the area is none on a road.
      setTimeout(() => (this.#tracing = false));
      done(ring);
    });
    const end = (): void => {
      this.#tracing = false;
      this.first.clear(false);
      tracing.end();
    };
    return { end };
  }

  /** Whether clicks on the first map are corners of an area. */
  get tracing(): boolean {
    return this.#tracing;
  }

  home(): void {
    this.first.map.fitBounds(this.context.region.focus ?? this.context.region.bbox, { ...this.#room(), pitch: 0, bearing: 0 });
  }

  zoom(by: number): void {
    this.first.map.easeTo({ zoom: this.first.map.getZoom() + by, duration: 250 });
  }

  /** Zooms in until each road is a line of its own. */
  approach(lon: number, lat: number): void {
    this.first.map.easeTo({ center: [lon, lat], zoom: Math.max(this.first.map.getZoom() + 2, SINGLE_ZOOM), duration: 600 });
  }

  fit([west, south, east, north]: [number, number, number, number], maxZoom = FIT_ZOOM): void {
    this.first.map.fitBounds([west, south, east, north], { ...this.#room(), maxZoom });
  }

  /** Moves the map if the place is under the drawer or close to the edge. */
  reveal(lon: number, lat: number): void {
    const { map } = this.first;
    const drawer = byId("drawer");
    const { x, y } = map.project([lon, lat]);
    const narrow = innerWidth < 760;
    const right = drawer.hidden || narrow ? innerWidth : innerWidth - drawer.offsetWidth - 110;
    const bottom = narrow && !drawer.hidden ? innerHeight - drawer.offsetHeight - 40 : innerHeight;
    if (x > right) map.panBy([x - right + 120, 0]);
    else if (y > bottom) map.panBy([0, y - bottom + 60]);
  }

  /** Draws a ring at the limiting place. */
  mark(place: Position | null): void {
    this.#limit?.remove();
    this.#limit = undefined;
    if (!place) return;
    const element = h("div", { class: "limit", role: "img", "aria-label": "The place that decides" });
    this.#limit = new Marker({ element }).setLngLat(place).addTo(this.first.map);
  }

  /** Draws the shapes of an explanation, and moves the ring to its tightest place. Null removes them. */
  shapes(shapes: Shapes | null): void {
    this.#shapes.show(shapes, this.context.theme.theme);
    const decides = shapes?.features.find(({ properties }) => properties.part === "hinge")
      ?? shapes?.features.find(({ properties }) => properties.part === "tightest");
    if (decides?.geometry.type === "Point") this.mark(decides.geometry.coordinates as Position);
  }

  /** Outlines the selected road, so that it can be seen at low zooms, too. */
  outline(line: Position[]): void {
    this.#outline = line;
    for (const view of [this.first, this.#second?.view]) view?.outline(line);
  }

  jump({ lon, lat, zoom }: Camera): void {
    this.first.map.jumpTo({ center: [lon, lat], zoom });
  }

  /** The padding of the parts of the map that panels cover. */
  #room() {
    const narrow = innerWidth < 760;
    const side = narrow || this.#second ? 40 : byId("side").offsetWidth + 40;
    const drawer = byId("drawer");
    const right = narrow || drawer.hidden ? 60 : drawer.offsetWidth + 60;
    return { padding: { left: side, right, top: narrow ? 140 : 40, bottom: narrow ? 160 : 40 }, duration: 600 };
  }

  #view(pane: HTMLElement, vehicle: string): View {
    const { region, store, theme } = this.context;
    const own = { ...question(this.context), vehicle };
    const state = this.first ? unchanged(store.state) : this.#muted();
    return new View(pane, region, state, own, theme.theme, {
      hover: (under, x, y) => this.#hover.show(under, x, y),
      click: (under, lon, lat) => {
        this.#hover.show(null, 0, 0);
        this.actions.click(under, lon, lat);
      },
      moved: () => this.#moved(),
    });
  }

  /** The state of the first map. Roads are muted only where changes can lie over them. */
  #muted(): State {
    const { state } = this.context.store;
    return comparable(this.context) ? state : unchanged(state);
  }

  #moved(): void {
    const { lng, lat } = this.first.map.getCenter();
    const round = (value: number, digits: number) => Number(value.toFixed(digits));
    this.actions.moved({ lon: round(lng, 5), lat: round(lat, 5), zoom: round(this.first.map.getZoom(), 2) });
  }

  #compare(other: string | null): void {
    document.body.classList.toggle("is-comparing", other !== null);
    if (other === null && this.#second) {
      this.#second.stop();
      this.#second.view.map.remove();
      this.#second.pane.remove();
      this.#second = undefined;
    } else if (other !== null && !this.#second) {
      const close = h("button", { class: "plain", type: "button", "aria-label": "End comparing", onclick: () => this.actions.endComparing() }, icon("close"));
      const place = h("div", { class: "map" });
      const pane = h("div", { class: "pane is-second", role: "group", "aria-label": "Second map" }, place, h("div", { class: "pane-head" }, this.#card.element, close));
      this.#root.append(pane);
      const view = this.#view(place, other);
      this.#second = { view, pane, stop: sync(this.first.map, view.map) };
      view.outline(this.#outline);
    }
    this.first.map.resize();
  }
}

/** Changes are drawn on the first map only, so the second one is not muted. */
function unchanged(state: State): State {
  return { ...state, changes: false };
}
