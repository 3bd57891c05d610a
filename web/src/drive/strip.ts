// The leeway on either side along the route: the whole route in a narrow band, and the part around the vehicle in a wide band that
// moves with the vehicle. Up is left of travel, down is right. A stroke across marks the tightest place. A bar at the edge of a band marks where the
// vehicle stands beyond its own lane, on that side.

import type { Route, StripUse } from "../api/types.ts";
import { marginColour, type Palette } from "../map/palette.ts";
import { h } from "../ui/dom.ts";
import { distance, length } from "../units.ts";
import { careful } from "../words.ts";
import { OPEN_M, leewayAt } from "./samples.ts";

/** The limits of the leeway that fills half of the band, metres. More leeway is cut off. */
const LEAST_FULL_M = 0.3;
const MOST_FULL_M = 1.5;
/** Metres of road behind and ahead of the vehicle. */
const WINDOW_M = 160;
/** Height of a bar where the vehicle stands beyond its own lane, and its least width, pixels. */
const BAR_PX = 4;
const LEAST_BAR_PX = 3;

function beyondWords(used: StripUse): string {
  return `${used.what}, ${used.side} side, at most ${length(Math.ceil(used.beyond_m * 100) / 100)} over the line`;
}

export class Strip {
  readonly element: HTMLElement;
  readonly #near = h("canvas", { class: "strip-near", "aria-hidden": "true" });
  readonly #whole = h("canvas", { class: "strip-whole", "aria-hidden": "true" });
  readonly #slider: HTMLInputElement;
  readonly #numbers = h("div", { class: "strip-numbers", "aria-hidden": "true" });
  /** The leeway that fills half of the band, metres. Nine tenths of the route have less. */
  readonly #full: number;
  #s = 0;

  constructor(
    private readonly route: Route,
    private readonly vehicleLength: number,
    private palette: Palette,
    seek: (s: number) => void,
  ) {
    this.#slider = h("input", {
      type: "range",
      min: 0,
      max: Math.round(route.length_m),
      step: 1,
      value: 0,
      "aria-label": "Place along the route, metres",
      oninput: () => seek(Number(this.#slider.value)),
    });
    const all = [...route.leeway.left_m, ...route.leeway.right_m].map((leeway) => leeway ?? OPEN_M).sort((a, b) => a - b);
    this.#full = Math.min(Math.max(all[Math.floor(0.9 * all.length)] ?? 0, LEAST_FULL_M), MOST_FULL_M);
    const whole = h("div", { class: "strip-track" }, this.#whole, this.#slider);
    const scale = h("span", { class: "strip-scale", "aria-hidden": "true" }, `full height ${length(this.#full)}`);
    const near = h("div", { class: "strip-window" }, this.#near, this.#numbers, scale);
    this.element = h("div", { class: "strip" }, near, whole);
    new ResizeObserver(() => this.#redraw()).observe(this.element);
  }

  recolour(palette: Palette): void {
    this.palette = palette;
    this.#redraw();
  }

  move(s: number): void {
    this.#s = s;
    this.#slider.value = String(Math.round(s));
    const { left, right } = leewayAt(this.route.leeway, s);
    const words = (leeway: number) => (leeway >= OPEN_M ? "open" : careful(leeway));
    const beyond = this.route.uses.filter((used) => used.from_m <= s && s <= used.to_m).map(beyondWords);
    this.#slider.setAttribute("aria-valuetext", [`${distance(s)}: ${words(left)} to spare left, ${words(right)} right`, ...beyond].join("; "));
    this.#numbers.replaceChildren(h("span", {}, `left ${words(left)}`), ...beyond.map((one) => h("span", { class: "strip-beyond" }, one)), h("span", {}, `right ${words(right)}`));
    this.#redraw();
  }

  #redraw(): void {
    this.#draw(this.#near, this.#s - WINDOW_M, this.#s + WINDOW_M, true);
    this.#draw(this.#whole, 0, this.route.length_m, false);
  }

  #draw(canvas: HTMLCanvasElement, from: number, to: number, near: boolean): void {
    const { clientWidth: wide, clientHeight: tall } = canvas;
    const context = canvas.getContext("2d");
    if (!context || wide === 0 || tall === 0) return;
    const ratio = devicePixelRatio || 1;
    if (canvas.width !== Math.round(wide * ratio) || canvas.height !== Math.round(tall * ratio)) {
      canvas.width = Math.round(wide * ratio);
      canvas.height = Math.round(tall * ratio);
    }
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, wide, tall);
    const x = (s: number): number => (wide * (s - from)) / (to - from);
    this.#columns(context, x, wide, tall);
    this.#beyond(context, x, tall);
    this.#marks(context, x, tall, near);
  }

  #columns(context: CanvasRenderingContext2D, x: (s: number) => number, wide: number, tall: number): void {
    const middle = tall / 2;
    const { leeway, length_m } = this.route;
    const ratio = devicePixelRatio || 1;
    const size = (value: number): number => Math.min(Math.max(value, 0.02) / this.#full, 1) * (middle - 1);
    leeway.s_m.forEach((s, index) => {
      // Rounded to whole pixels, because seams would show between neighbours.
      const a = Math.floor(x(s) * ratio) / ratio;
      const b = Math.ceil(x(leeway.s_m[index + 1] ?? length_m) * ratio) / ratio;
      if (b < 0 || a > wide) return;
      const breadth = b - a;
      const [left, right] = [leeway.left_m[index] ?? OPEN_M, leeway.right_m[index] ?? OPEN_M];
      context.fillStyle = marginColour(this.palette, left);
      context.fillRect(a, middle - size(left), breadth, size(left));
      context.fillStyle = marginColour(this.palette, right);
      context.fillRect(a, middle, breadth, size(right));
    });
    context.fillStyle = this.palette.paper;
    context.fillRect(0, middle - 0.5, wide, 1);
  }

  /** The bars where the vehicle stands beyond its own lane. */
  #beyond(context: CanvasRenderingContext2D, x: (s: number) => number, tall: number): void {
    for (const used of this.route.uses) {
      context.fillStyle = this.palette.strips[used.strip];
      context.fillRect(x(used.from_m), used.side === "left" ? 0 : tall - BAR_PX, Math.max(x(used.to_m) - x(used.from_m), LEAST_BAR_PX), BAR_PX);
    }
  }

  #marks(context: CanvasRenderingContext2D, x: (s: number) => number, tall: number, near: boolean): void {
    const tightest = x(this.route.limiting_s_m);
    context.strokeStyle = this.palette.alarm;
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(tightest, 0);
    context.lineTo(tightest, tall);
    context.stroke();
    const head = x(this.#s);
    if (near) {
      // The vehicle's length in the scale of the strip.
      const rear = x(this.#s - this.vehicleLength);
      context.fillStyle = this.palette.ink;
      context.beginPath();
      context.roundRect(rear, tall / 2 - 4, head - rear, 8, 3);
      context.fill();
      context.strokeStyle = this.palette.paper;
      context.stroke();
    } else {
      context.fillStyle = this.palette.ink;
      context.fillRect(head - 1, 0, 2, tall);
    }
  }
}
