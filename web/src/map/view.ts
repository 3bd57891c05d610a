// One map for a vehicle and a policy. It is restyled when the state changes, and reports what is under the pointer.

import { AttributionControl, Map as Base, ScaleControl, type GeoJSONSource, type MapGeoJSONFeature, type Point, type Source } from "maplibre-gl";
import type { Position, Region } from "../api/types.ts";
import { api, type Question } from "../api/client.ts";
import type { State } from "../state.ts";
import { h } from "../ui/dom.ts";
import { spoken } from "../units.ts";
import { CHANGES, changeLayers } from "./changes.ts";
import { labelImage } from "./labels.ts";
import type { Theme } from "./palette.ts";
import { askEarly, tileAddress } from "./tiles.ts";
import { CLEAR_BASE, OUTLINE, PALE_BASE, edgeLayers, muted, overviewLayers, style, turnLayers } from "./style.ts";

/**
 * The tags of an edge or turn in a tile, or of a change. In an overview, those of all roads that fall on one line, without an id.
 */
export interface Under {
  kind: "edge" | "turn" | "overview" | "change";
  id: string | null;
  properties: Record<string, string | number | boolean | null | undefined>;
}

export interface Events {
  hover(under: Under | null, x: number, y: number): void;
  click(under: Under | null, lon: number, lat: number): void;
  moved(): void;
}

/** The greatest distance at which the pointer counts as on a line, pixels. It is greater for a finger. */
const NEAR_MOUSE = 5;
const NEAR_TOUCH = 14;
/** How long a first view may take, milliseconds. */
const LATEST_MS = 4000;

/** Whether there is no graphics card. Smoothing every pixel then takes longer than all roads, and lines are smooth without it. */
function drawnByProcessor(): boolean {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [1, 1];
  const context = canvas.getContext("webgl2", { antialias: false, depth: false });
  const named = context?.getExtension("WEBGL_debug_renderer_info");
  const renderer: unknown = context?.getParameter(named ? named.UNMASKED_RENDERER_WEBGL : context.RENDERER);
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(String(renderer));
}

export class View {
  readonly map: Base;
  readonly #scale = new ScaleControl({ maxWidth: 90 });
  #key: string;
  #hovered = "";
  #ready: Promise<void>;

  constructor(
    container: HTMLElement,
    readonly region: Region,
    private state: State,
    private question: Question,
    private theme: Theme,
    private readonly events: Events,
  ) {
    this.#key = this.#styleKey();
    const camera = state.camera;
    this.map = new Base({
      container,
      style: style(state, this.#ground()),
      ...(camera ? { center: [camera.lon, camera.lat] as [number, number], zoom: camera.zoom } : { bounds: region.focus ?? region.bbox }),
      fitBoundsOptions: { padding: innerWidth < 760 ? 16 : { left: 380, right: 90, top: 30, bottom: 40 } },
      maxZoom: 22,
      minZoom: 3,
      maxPitch: 70,
      attributionControl: false,
      fadeDuration: 150,
      canvasContextAttributes: { antialias: !drawnByProcessor() },
    });
    this.#askEarly();
    this.map.addControl(new AttributionControl({ compact: false }), "bottom-right");
    this.map.addControl(this.#scale, "bottom-right");
    container.append(h("div", { class: "crosshair", "aria-hidden": "true" }));
    this.#name();
    this.#ready = new Promise((done) => this.map.once("load", () => done()));
    this.#listen();
  }

  /** Resolves when the style is loaded, so that sources and layers can be added. */
  get ready(): Promise<void> {
    return this.#ready;
  }

  /** Resolves when the first view is drawn, or after a while if it is not. What can wait leaves the server to the tiles until then. */
  get drawn(): Promise<void> {
    return Promise.race([this.#ready, new Promise<void>((done) => setTimeout(done, LATEST_MS))]);
  }

  #askEarly(): void {
    const { region, map } = this;
    const [seen, [west, south, east, north]] = [map.getBounds(), region.bbox];
    const within = [Math.max(seen.getWest(), west), Math.max(seen.getSouth(), south), Math.min(seen.getEast(), east), Math.min(seen.getNorth(), north)] as const;
    askEarly(api.tilesPath(region, this.question), Math.min(Math.floor(map.getZoom()), region.max_zoom), within);
  }

  update(state: State, question: Question, theme: Theme): void {
    this.state = state;
    this.question = question;
    this.theme = theme;
    const key = this.#styleKey();
    if (key !== this.#key) {
      this.#key = key;
      const kept = this.#own();
      this.map.setStyle(style(state, this.#ground()), {
        diff: true,
        transformStyle: (_, next) => ({
          ...next,
          sources: { ...next.sources, ...kept.sources },
          layers: [...next.layers, ...kept.layers],
        }),
      });
    }
    this.#name();
    this.#scale.setUnit(spoken() === "feet" ? "imperial" : "metric");
    void this.#ready.then(() => this.#select(state.selected));
  }

  #name(): void {
    this.map.getCanvas().setAttribute("aria-label", `Map of roads for ${this.question.vehicle}. Arrows move it; Enter takes what is under the cross.`);
  }

  /** Sets the line of the selected road. Overview tiles have no single roads with ids, so the line is set separately. */
  outline(coordinates: Position[]): void {
    const line: GeoJSON.Feature = { type: "Feature", properties: {}, geometry: { type: "LineString", coordinates } };
    void this.#ready.then(() => this.overlay(OUTLINE, { type: "FeatureCollection", features: coordinates.length > 1 ? [line] : [] }));
  }

  /** Shows the base map as it is, to trace on it, or pale again beneath the roads. */
  clear(clear: boolean): void {
    if (!this.map.getLayer("base")) return;
    const paint = clear ? CLEAR_BASE : PALE_BASE;
    for (const name of ["raster-opacity", "raster-saturation"] as const) this.map.setPaintProperty("base", name, paint[name]);
  }

  /** Draws GeoJSON under a name, above the roads; empty at first. */
  overlay(name: string, data: GeoJSON.GeoJSON): void {
    const source = this.map.getSource(name) as GeoJSONSource | undefined;
    if (source) source.setData(data);
    else this.map.addSource(name, { type: "geojson", data });
  }

  /** Sources and layers that do not belong to the style and survive a change of it. */
  #own(): { sources: Record<string, never>; layers: never[] } {
    const now = this.map.getStyle();
    const sources = Object.entries(now?.sources ?? {}).filter(([name]) => name.startsWith("own-"));
    const layers = (now?.layers ?? []).filter((layer) => layer.id.startsWith("own-"));
    return { sources: Object.fromEntries(sources) as Record<string, never>, layers: layers as never[] };
  }

  #ground() {
    const [, south, , north] = this.region.bbox;
    return {
      region: this.region,
      tilesUrl: tileAddress(api.tilesPath(this.region, this.question)),
      theme: this.theme,
      shared: this.question.policy === "carriageway",
      latitude: (south + north) / 2,
    };
  }

  #styleKey(): string {
    const { colourBy, hidden, hiddenClasses, evidence, baseMap } = this.state;
    return JSON.stringify([this.question, this.theme, colourBy, [...hidden], [...hiddenClasses], evidence, muted(this.state), baseMap]);
  }

  #select(id: string | null): void {
    this.map.setFilter("glow", ["==", ["get", "edge_id"], id ?? ""]);
    this.map.setFilter("selected-edge", ["==", ["get", "edge_id"], id ?? ""]);
    this.map.setFilter("selected-turn", ["==", ["get", "turn_id"], id ?? ""]);
  }

  #hover(under: Under | null): void {
    const key = under?.id ? under.kind + under.id : "";
    if (key === this.#hovered) return;
    this.#hovered = key;
    this.map.setFilter("hover-edge", ["==", ["get", "edge_id"], under?.kind === "edge" ? under.id : ""]);
    this.map.setFilter("hover-turn", ["==", ["get", "turn_id"], under?.kind === "turn" ? under.id : ""]);
  }

  #at(point: Point, near: number): Under | null {
    const { x, y } = point;
    const layers = [...changeLayers, ...turnLayers, ...edgeLayers, ...overviewLayers].filter((id) => this.map.getLayer(id));
    const box: [[number, number], [number, number]] = [[x - near, y - near], [x + near, y + near]];
    const exact = this.map.queryRenderedFeatures(point, { layers });
    return under(exact[0] ?? this.map.queryRenderedFeatures(box, { layers })[0]);
  }

  #listen(): void {
    const { map, events } = this;
    // Widths in metres are right only in tiles of the map's own zoom. On a tilted map, MapLibre takes finer tiles near the camera.
    map.on("styledata", () => {
      const roads = map.getSource("roads") as Source | undefined;
      if (roads) roads.calculateTileZoom = (zoom) => zoom;
    });
    map.setMissingStyleImageResolver((id) => {
      const image = labelImage(id);
      if (image) map.addImage(id, image.data, image);
    });
    map.on("mousemove", (event) => {
      const found = this.#at(event.point, NEAR_MOUSE);
      this.#hover(found);
      map.getCanvas().style.cursor = found ? "pointer" : "";
      events.hover(found, event.originalEvent.clientX, event.originalEvent.clientY);
    });
    map.on("mouseout", () => {
      this.#hover(null);
      events.hover(null, 0, 0);
    });
    map.on("click", (event) => {
      const touch = matchMedia("(pointer: coarse)").matches;
      events.click(this.#at(event.point, touch ? NEAR_TOUCH : NEAR_MOUSE), event.lngLat.lng, event.lngLat.lat);
    });
    const canvas = map.getCanvas();
    const middle = () => map.project(map.getCenter());
    map.on("moveend", () => {
      events.moved();
      // For the keyboard the cross is the pointer.
      if (!canvas.matches(":focus-visible")) return;
      const { x, y } = middle();
      const { left, top } = canvas.getBoundingClientRect();
      events.hover(this.#at(middle(), NEAR_MOUSE), left + x, top + y);
    });
    canvas.addEventListener("blur", () => events.hover(null, 0, 0));
    canvas.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" || event.altKey || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      const { lng, lat } = map.getCenter();
      events.click(this.#at(middle(), NEAR_TOUCH), lng, lat);
    });
  }
}

function under(feature: MapGeoJSONFeature | undefined): Under | null {
  if (!feature) return null;
  const properties = feature.properties as Under["properties"];
  if (feature.source === CHANGES) return { kind: "change", id: String(properties["id"]), properties };
  const kind = feature.sourceLayer as Under["kind"];
  return { kind, id: kind === "overview" ? null : String(properties[`${kind}_id`]), properties };
}
