// The drive along the certified route that is shown.

import type { Route } from "../api/types.ts";
import { vehicleOf, type Context } from "../context.ts";
import { Dock } from "../drive/dock.ts";
import { palettes } from "../map/palette.ts";
import type { View } from "../map/view.ts";
import { byId } from "../ui/dom.ts";

export class Driving {
  #dock: Dock | null = null;
  #route: Route | null = null;

  constructor(private readonly context: Context, private readonly view: View) {}

  get under(): boolean {
    return this.#dock !== null;
  }

  /** Sets the route that can be driven, and ends the drive along an earlier one. */
  offer(route: Route | null): void {
    if (route === this.#route) return;
    this.end();
    this.#route = route;
  }

  start(): void {
    this.#open()?.start();
  }

  seek(s: number): void {
    this.#open()?.seek(s);
  }

  end(): void {
    this.#dock?.remove();
    this.#dock = null;
    document.body.classList.remove("is-driving");
  }

  /** Starts or stops. Returns whether there is something to drive. */
  toggle(): boolean {
    if (this.#dock) this.#dock.toggle();
    else if (this.#route) this.start();
    return this.#route !== null;
  }

  recolour(): void {
    this.#dock?.recolour(palettes[this.context.theme.theme]);
  }

  #open(): Dock | null {
    const vehicle = vehicleOf(this.context, this.context.store.state.vehicle);
    if (this.#dock || !this.#route || !vehicle) return this.#dock;
    this.#dock = new Dock(this.view, this.#route, vehicle, palettes[this.context.theme.theme], () => this.end());
    byId("bottom").append(this.#dock.element);
    document.body.classList.add("is-driving");
    return this.#dock;
  }
}
