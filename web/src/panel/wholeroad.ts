// The card of a whole road that was searched for: how much of it is certified, and the way to its worst piece.

import { Marker } from "maplibre-gl";
import { api } from "../api/client.ts";
import type { RoadSummary, SearchHit, WholeRoad } from "../api/types.ts";
import { question, type Context } from "../context.ts";
import { drawRoad } from "../map/wholeroad.ts";
import type { View } from "../map/view.ts";
import { h } from "../ui/dom.ts";
import { icon } from "../ui/icons.ts";
import { roadLength } from "../units.ts";
import { percent, reasonWords, verdictWords } from "../words.ts";

export class WholeRoadCard {
  readonly element = h("section", { class: "whole-road", "aria-label": "The road that was found", "aria-live": "polite", hidden: true });
  #hit: SearchHit | null = null;
  #road: WholeRoad | null = null;
  #running: AbortController | undefined;
  #marker: Marker | undefined;

  /** `worst` shows the worst piece. */
  constructor(private readonly context: Context, private readonly view: View, private readonly worst: (edge: string, lon: number, lat: number) => void) {
    context.store.listen((_, changed) => {
      if (this.#hit && (changed.has("vehicle") || changed.has("policy"))) void this.show(this.#hit);
    });
    context.theme.listen(() => this.#draw());
  }

  /** Shows what was found: a road as a whole, or a place. */
  async show(hit: SearchHit): Promise<void> {
    this.close();
    this.#hit = hit;
    if (hit.kind === "place") return this.#place(hit);
    const running = (this.#running = new AbortController());
    try {
      this.#road = await api.wholeRoad(hit, question(this.context), running.signal);
      this.#draw();
      const { title, pieces, summary, scope } = this.#road;
      this.#say(title, ...(summary ? this.#words(summary) : [h("p", {}, `${pieces} pieces`)]), h("p", { class: "note" }, scope.replaceAll("`", "")));
    } catch (error) {
      if (!running.signal.aborted) this.#say(hit.title, h("p", {}, (error as Error).message));
    }
  }

  close(): void {
    this.#running?.abort();
    this.#marker?.remove();
    this.element.hidden = true;
    this.#hit = this.#road = null;
    this.#draw();
  }

  #draw(): void {
    drawRoad(this.view, this.#road, this.context.theme.theme);
  }

  #place(hit: SearchHit): void {
    const element = h("div", { class: "limit", role: "img", "aria-label": "The place that was searched for" });
    this.#marker = new Marker({ element }).setLngLat([hit.lon, hit.lat]).addTo(this.view.map);
    this.#say(hit.title);
  }

  #words({ pieces, length_m, verdicts, worst }: RoadSummary): HTMLElement[] {
    const certified = `${pieces} pieces, ${roadLength(length_m)} in both directions together: ${percent(verdicts.safe.length_m, length_m)} certified`;
    if (!worst) return [h("p", {}, certified)];
    const { verdict, reason, edge_id, lon, lat } = worst;
    const why = reason ? `${verdictWords[verdict].name.toLowerCase()}: ${reasonWords(verdict, reason).toLowerCase()}` : "the least room";
    return [
      h("p", {}, certified),
      h("button", { class: "link", type: "button", onclick: () => this.worst(edge_id, lon, lat) }, verdict === "safe" ? "Where there is the least room" : `The worst piece (${why})`),
    ];
  }

  #say(title: string, ...content: HTMLElement[]): void {
    const shut = h("button", { class: "plain", type: "button", "aria-label": "Close the road that was found", onclick: () => this.close() }, icon("close"));
    this.element.replaceChildren(h("header", {}, h("strong", {}, title), shut), ...content);
    this.element.hidden = false;
  }
}
