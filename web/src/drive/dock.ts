// The bar under a drive: play, speed, look, and the leeway strip.

import type { Route, Vehicle } from "../api/types.ts";
import type { View } from "../map/view.ts";
import type { Palette } from "../map/palette.ts";
import { h } from "../ui/dom.ts";
import { icon } from "../ui/icons.ts";
import { Segmented } from "../ui/segmented.ts";
import { distance } from "../units.ts";
import { duration } from "../words.ts";
import { Player, type Look } from "./player.ts";
import { Samples } from "./samples.ts";
import { Scene } from "./scene.ts";
import { Strip } from "./strip.ts";

/** The distance before the tightest place at which a look at it begins, metres. */
const RUN_UP_M = 60;

export class Dock {
  readonly element: HTMLElement;
  readonly #scene: Scene;
  readonly #strip: Strip;
  readonly #player: Player;
  readonly #samples: Samples;
  readonly #play = h("button", { class: "round", type: "button", onclick: () => this.#player.toggle() });
  readonly #road = h("strong", { class: "dock-road" });
  readonly #time = h("span", { class: "dock-time" });
  readonly #look: Segmented<Look>;
  readonly #speed: Segmented<string>;
  #begin: ReturnType<typeof setTimeout> | undefined;
  /** Where the map was before the drive. */
  readonly #before: { center: [number, number]; zoom: number; bearing: number; pitch: number };

  constructor(
    private readonly view: View,
    private readonly route: Route,
    private readonly vehicle: Vehicle,
    palette: Palette,
    close: () => void,
  ) {
    const { map } = view;
    this.#before = { center: map.getCenter().toArray() as [number, number], zoom: map.getZoom(), bearing: map.getBearing(), pitch: map.getPitch() };
    this.#samples = new Samples(route.drive);
    this.#scene = new Scene(route, this.#samples, vehicle, palette);
    this.#strip = new Strip(route, vehicle.length_m, palette, (s) => this.#player.seek(s));
    this.#look = new Segmented<Look>(
      "look",
      "Camera",
      [
        { value: "chase", name: "Chase", title: "Behind the vehicle" },
        { value: "above", name: "Above", title: "From above, north up" },
        { value: "free", name: "Free", title: "The camera stays where you put it" },
      ],
      (look) => (this.#player.look = look),
    );
    const speeds = ["1", "4", "15"].map((value) => ({ value, name: `${value}×`, title: `${value} times as fast as driven` }));
    this.#speed = new Segmented<string>("speed", "Speed", speeds, (value) => (this.#player.speed = Number(value)));
    const tightest = h("button", { class: "small", type: "button", onclick: () => this.tightest() }, "Tightest place");
    const shut = h("button", { class: "plain", type: "button", "aria-label": "End the drive", onclick: close }, icon("close"));
    const words = h("div", { class: "dock-words" }, this.#road, this.#time);
    const controls = h("div", { class: "dock-controls" }, this.#play, words, this.#speed.element, this.#look.element, tightest, shut);
    this.element = h("section", { class: "dock", "aria-label": "Drive along the route" }, controls, this.#strip.element);
    // Added on top, so that names do not cover the bodies.
    this.view.map.addLayer(this.#scene);
    this.#player = new Player(view.map, this.#scene, this.#samples, vehicle.length_m, () => this.#draw());
    this.#draw();
  }

  /** Starts at the beginning. If the reader prefers reduced motion, the drive waits to be started. */
  start(): void {
    this.#player.seek(Math.min(this.vehicle.length_m, this.#samples.length));
    this.#player.look = "chase";
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) this.#begin = setTimeout(() => this.#player.play(), 750);
  }

  tightest(): void {
    this.#player.speed = 1;
    this.#player.seek(Math.max(this.route.limiting_s_m - RUN_UP_M, 0));
    if (this.#player.look === "free") this.#player.look = "chase";
    this.#player.play();
  }

  seek(s: number): void {
    this.#player.pause();
    this.#player.seek(s);
  }

  toggle(): void {
    this.#player.toggle();
  }

  recolour(palette: Palette): void {
    this.#scene.recolour(palette);
    this.#strip.recolour(palette);
  }

  remove(): void {
    clearTimeout(this.#begin);
    this.#player.remove();
    if (this.view.map.getLayer(this.#scene.id)) this.view.map.removeLayer(this.#scene.id);
    this.view.map.easeTo({ ...this.#before, duration: 700 });
    this.element.remove();
  }

  #draw(): void {
    const { playing, s, look, speed } = this.#player ?? { playing: false, s: 0, look: "chase", speed: 4 };
    this.#play.replaceChildren(icon(playing ? "pause" : "play"));
    this.#play.setAttribute("aria-label", playing ? "Pause" : "Play");
    this.#time.textContent = `${distance(s)} of ${distance(this.#samples.length)} · ${duration(this.#samples.timeAt(s))}`;
    this.#road.textContent = this.route.parts.find((part) => s <= part.to_m)?.title ?? "";
    this.#look.value = look;
    this.#speed.value = String(speed);
    this.#strip.move(s);
  }
}
