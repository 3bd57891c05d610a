// The changes since the older database: asked for when they are switched on, drawn over the first map, listed in the panel.

import { api } from "../api/client.ts";
import type { Before, Changed, ChangedRoad, Changes } from "../api/types.ts";
import { comparable, question, type Context } from "../context.ts";
import { ChangesLayer } from "../map/changes.ts";
import type { View } from "../map/view.ts";
import { ChangesPanel, changeNote, since, type Shown } from "../panel/changes.ts";
import type { State } from "../state.ts";

/** How long the map has to rest before the changes in view are asked for. */
const PAUSE_MS = 250;
/** Boxes in view are rounded outwards to this many degrees, so that small moves ask for nothing new. */
const STEP = 0.02;

export interface ChangesActions {
  go(road: ChangedRoad): void;
  /** Other changes are known than before. */
  known(): void;
}

export class ChangesSince {
  readonly panel: ChangesPanel;
  readonly label: string;
  readonly #layer: ChangesLayer;
  #all: Changes | null = null;
  #drawn: Changes | null = null;
  #byId = new Map<string, { changed: Changed; line: [number, number][] }>();
  #asked = "";
  #box = "";
  #running: AbortController | undefined;
  #timer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly context: Context, before: Before, private readonly view: View, private readonly actions: ChangesActions) {
    const { region, store } = context;
    this.label = since(region);
    this.panel = new ChangesPanel(before, this.label, { toggle: (changes) => store.set({ changes }), go: actions.go });
    this.#layer = new ChangesLayer(view, region);
  }

  toggle(): void {
    const { store } = this.context;
    if (comparable(this.context)) store.set({ changes: !store.state.changes });
  }

  /** The change of an edge or turn, if it is drawn. */
  of(id: string | null): Changed | null {
    return (id && this.#byId.get(id)?.changed) || null;
  }

  line(id: string): [number, number][] {
    return this.#byId.get(id)?.line ?? [];
  }

  note(id: string): HTMLElement | null {
    const changed = this.of(id);
    return changed ? changeNote(changed, this.label) : null;
  }

  update(changed: ReadonlySet<keyof State>): void {
    const { state } = this.context.store;
    const on = state.changes && comparable(this.context);
    const asked = on ? JSON.stringify(question(this.context)) : "";
    if (asked !== this.#asked) {
      this.#asked = asked;
      this.#set(null, null, on ? "waiting" : "off");
      this.#running?.abort();
      if (on) void this.#ask();
    } else if (changed.has("camera") && this.#all && !this.#all.complete) {
      clearTimeout(this.#timer);
      this.#timer = setTimeout(() => void this.#askInView(), PAUSE_MS);
    }
    this.#draw();
  }

  #draw(): void {
    const { state } = this.context.store;
    this.panel.draw(state.changes, comparable(this.context), state.selected);
    this.#layer.draw(this.context.theme.theme, state.policy === "carriageway", state.selected);
  }

  async #ask(): Promise<void> {
    const running = (this.#running = new AbortController());
    try {
      const all = await api.changes(question(this.context), null, running.signal);
      if (running.signal.aborted) return;
      this.#box = "";
      this.#set(all, all, { changes: all, drawn: all });
      if (!all.complete) void this.#askInView();
    } catch (error) {
      if (!running.signal.aborted) this.#set(null, null, { failed: (error as Error).message });
    }
  }

  /** Where there are too many changes to draw them all, those in view are asked for. */
  async #askInView(): Promise<void> {
    const all = this.#all;
    const box = this.#inView();
    if (!all || box === this.#box) return;
    this.#running?.abort();
    const running = (this.#running = new AbortController());
    try {
      const drawn = await api.changes(question(this.context), box, running.signal);
      if (running.signal.aborted || this.#all !== all) return;
      this.#box = box;
      this.#set(all, drawn, { changes: all, drawn });
    } catch {
      // The longest changes stay drawn. The next move of the map asks again.
    }
  }

  #inView(): string {
    const bounds = this.view.map.getBounds();
    const out = (degrees: number, round: (steps: number) => number, most: number) => Math.min(Math.max(round(degrees / STEP) * STEP, -most), most).toFixed(2);
    return [
      out(bounds.getWest(), Math.floor, 180),
      out(bounds.getSouth(), Math.floor, 90),
      out(bounds.getEast(), Math.ceil, 180),
      out(bounds.getNorth(), Math.ceil, 90),
    ].join(",");
  }

  #set(all: Changes | null, drawn: Changes | null, shown: Shown): void {
    this.#all = all;
    if (drawn !== this.#drawn) {
      this.#drawn = drawn;
      this.#byId = new Map((drawn?.features ?? []).map(({ geometry, properties }) => [properties.id, { changed: properties, line: geometry.coordinates }]));
      this.#layer.show(drawn);
      this.actions.known();
    }
    this.panel.show(shown);
    this.#draw();
  }
}
