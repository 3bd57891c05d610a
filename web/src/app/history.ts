// The address bar and the browser's history: the link holds the state of the page.

import { read, write, type Possible } from "../link.ts";
import type { Camera, State, Store } from "../state.ts";

export class History {
  #written = "";

  constructor(private readonly store: Store, private readonly first: State, private readonly possible: Possible, jump: (camera: Camera) => void) {
    addEventListener("hashchange", () => this.#follow(jump));
  }

  /** Writes the state into the link. Moving the map replaces the link; other changes add a step to the history. */
  write(changed: ReadonlySet<keyof State>): void {
    const link = write(this.store.state, this.first);
    if (link === this.#written) return;
    const step = [...changed].some((key) => key !== "camera") && this.#written !== "";
    this.#written = link;
    if (step) history.pushState(null, "", link);
    else history.replaceState(null, "", link);
  }

  #follow(jump: (camera: Camera) => void): void {
    if (location.hash === this.#written) return;
    const next = read(location.hash, this.first, this.possible);
    this.#written = location.hash;
    this.store.set(next);
    if (next.camera) jump(next.camera);
  }
}
