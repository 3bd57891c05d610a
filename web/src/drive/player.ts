// The clock and the camera of a drive: play, pause, seek, and the view from behind or above.

import type { Map as Base } from "maplibre-gl";
import type { Scene } from "./scene.ts";
import type { Samples } from "./samples.ts";

export type Look = "chase" | "above" | "free";

/** The share of the angle between camera and vehicle that is left after a second. */
const TURN_LEFT = 0.12;
/** The longest step of time per frame, seconds. On a slow machine the drive slows down and does not jump. */
const LONGEST_FRAME_S = 0.25;
/** The length from the front of a long vehicle that the chasing camera shows, metres. */
const SHOWN_M = 32;

export class Player {
  #playing = false;
  #s = 0;
  #speed = 4;
  #look: Look = "chase";
  #bearing: number | null = null;
  #last = 0;
  #frame = 0;

  constructor(
    private readonly map: Base,
    private readonly scene: Scene,
    private readonly samples: Samples,
    private readonly vehicleLength: number,
    private readonly changed: (player: Player) => void,
  ) {
    // A reader who drags the map takes over the camera.
    map.on("dragstart", this.#let);
    map.on("rotatestart", this.#let);
  }

  get playing(): boolean {
    return this.#playing;
  }
  get s(): number {
    return this.#s;
  }
  get speed(): number {
    return this.#speed;
  }
  get look(): Look {
    return this.#look;
  }

  set speed(speed: number) {
    this.#speed = speed;
    this.changed(this);
  }

  set look(look: Look) {
    this.#look = look;
    this.#bearing = null;
    this.#show(0, true);
  }

  play(): void {
    if (this.#playing) return;
    if (this.#s >= this.samples.length) this.#s = 0;
    this.#playing = true;
    this.#last = performance.now();
    this.#frame = requestAnimationFrame(this.#tick);
    this.changed(this);
  }

  pause(): void {
    this.#playing = false;
    cancelAnimationFrame(this.#frame);
    this.changed(this);
  }

  toggle(): void {
    if (this.#playing) this.pause();
    else this.play();
  }

  seek(s: number): void {
    this.#s = Math.min(Math.max(s, 0), this.samples.length);
    this.#bearing = null;
    this.#show(0, false);
  }

  remove(): void {
    this.pause();
    this.map.off("dragstart", this.#let);
    this.map.off("rotatestart", this.#let);
  }

  readonly #let = (event: { originalEvent?: unknown }): void => {
    if (!event.originalEvent || this.#look === "free") return;
    this.#look = "free";
    this.changed(this);
  };

  readonly #tick = (now: number): void => {
    if (!this.#playing) return;
    const seconds = Math.min((now - this.#last) / 1000, LONGEST_FRAME_S);
    this.#last = now;
    this.#s = this.samples.stationAt(this.samples.timeAt(this.#s) + seconds * this.#speed);
    this.#show(seconds, false);
    if (this.#s >= this.samples.length) this.pause();
    else this.#frame = requestAnimationFrame(this.#tick);
  };

  #show(seconds: number, moved: boolean): void {
    this.scene.s = this.#s;
    this.#camera(seconds, moved);
    this.map.triggerRepaint();
    this.changed(this);
  }

  #camera(seconds: number, moved: boolean): void {
    if (this.#look === "free") return;
    const poses = this.samples.at(this.#s);
    const [head, tail] = [poses[0], poses.at(-1)];
    if (!head || !tail) return;
    const back = Math.min(0.5, SHOWN_M / 2 / Math.max(this.vehicleLength, 1));
    const middle = this.samples.frame.from(head.x + back * (tail.x - head.x), head.y + back * (tail.y - head.y));
    const along = (Math.atan2(head.x - tail.x || head.dx, -(head.y - tail.y) || -head.dy) * 180) / Math.PI;
    const heading = poses.length > 1 ? along : (Math.atan2(head.dx, -head.dy) * 180) / Math.PI;
    const difference = this.#bearing === null ? 0 : ((heading - this.#bearing + 540) % 360) - 180;
    this.#bearing = this.#bearing === null ? heading : this.#bearing + difference * (1 - TURN_LEFT ** seconds);
    const chase = this.#look === "chase";
    const camera = { center: middle, bearing: chase ? this.#bearing + 24 : 0, pitch: chase ? 62 : 0, zoom: this.#zoom(chase) };
    if (moved) this.map.easeTo({ ...camera, duration: 700, essential: true });
    else this.map.jumpTo(camera);
  }

  /** The zoom at which the vehicle fits on the screen. */
  #zoom(chase: boolean): number {
    const { clientWidth: wide, clientHeight: tall } = this.map.getContainer();
    const pixels = Math.min(wide * 0.5, tall) * (chase ? 0.62 : 0.55);
    const length = chase ? Math.min(this.vehicleLength, SHOWN_M) : this.vehicleLength;
    const metre = (pixels / Math.max(length, 12)) * 78271.517 * Math.cos((this.map.getCenter().lat * Math.PI) / 180);
    return Math.min(Math.log2(metre), 21.5);
  }
}
