// The search for a road by name, number or id, or a place by its name or coordinates. It is a combobox: arrows choose, Enter goes to the road, Escape leaves.

import { api } from "../api/client.ts";
import type { SearchHit } from "../api/types.ts";
import { h } from "../ui/dom.ts";
import { icon } from "../ui/icons.ts";
import { className } from "../words.ts";

const PAUSE_MS = 160;

/** What sets one field apart from another. */
export interface SearchOptions {
  /** The id of the field; those of its list begin with it. */
  id: string;
  label: string;
  placeholder: string;
  /** Whether it is a field of a form, with a label beside it, and keeps what was chosen. */
  field?: boolean;
  /** The field was emptied. */
  emptied?(): void;
}

const main: SearchOptions = { id: "search", label: "Find a road by name, number or id, or a place by name or coordinates", placeholder: "Road, number or place" };

export class Search {
  readonly element: HTMLElement;
  readonly #input: HTMLInputElement;
  readonly #list: HTMLElement;
  /** What a field of a form shows if nothing else is chosen. */
  #kept = "";
  #hits: SearchHit[] = [];
  /** The text that the hits are for. */
  #found = "";
  #active = -1;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #running: AbortController | undefined;

  constructor(private readonly go: (hit: SearchHit) => void, private readonly options: SearchOptions = main) {
    const { id, label, placeholder, field } = options;
    this.#list = h("ul", { class: "hits", id: `${id}-hits`, role: "listbox", "aria-label": `Roads found: ${label}`, hidden: true });
    this.#input = h("input", {
      type: "search",
      id,
      placeholder,
      "aria-label": field ? null : label,
      role: "combobox",
      "aria-expanded": "false",
      "aria-controls": `${id}-hits`,
      "aria-autocomplete": "list",
      autocomplete: "off",
      spellcheck: "false",
      maxlength: 100,
      oninput: () => this.#later(),
      onkeydown: (event: KeyboardEvent) => this.#key(event),
      onfocus: () => this.#draw(),
      onblur: () => this.#left(),
    });
    this.element = field
      ? h("div", { class: "search is-field" }, this.#input, this.#list)
      : h("div", { class: "search", role: "search" }, icon("search"), this.#input, h("kbd", {}, "/"), this.#list);
  }

  focus(): void {
    this.#input.focus();
    this.#input.select();
  }

  /** Puts a text into the field, and keeps it when the reader leaves without a choice. */
  put(text: string): void {
    this.#kept = text;
    this.#input.value = text;
    this.#hits = [];
    this.#found = "";
    this.#close();
  }

  #left(): void {
    setTimeout(() => this.#close(), 150);
    if (!this.options.field) return;
    clearTimeout(this.#timer);
    // Who empties a field takes its place away.
    if (this.#input.value.trim() === "" && this.#kept !== "") this.options.emptied?.();
    else this.#input.value = this.#kept;
  }

  #later(): void {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.#ask(), PAUSE_MS);
  }

  async #ask(): Promise<void> {
    this.#running?.abort();
    const text = this.#input.value.trim();
    if (text === "") {
      this.#hits = [];
      this.#close();
      return;
    }
    const running = (this.#running = new AbortController());
    try {
      this.#hits = await api.search(text, running.signal);
      this.#found = text;
      this.#active = this.#hits.length > 0 ? 0 : -1;
      this.#draw();
    } catch (error) {
      if (!running.signal.aborted) this.#say((error as Error).message);
    }
  }

  #draw(): void {
    if (this.#input.value.trim() === "") return;
    if (this.options.field && this.#input.value === this.#kept) return;
    if (this.#hits.length === 0) return this.#say("Nothing found");
    const rows = this.#hits.map((hit, index) => this.#row(hit, index));
    this.#list.replaceChildren(...rows);
    this.#open();
  }

  #row(hit: SearchHit, index: number): HTMLElement {
    const chosen = index === this.#active;
    const which = { road: `${hit.pieces} pieces`, way: `way ${hit.id}`, edge: `edge ${hit.id}`, place: "place" }[hit.kind];
    const more = hit.settlement ? [hit.settlement] : [hit.highway ? className(hit.highway) : null, which, hit.town];
    return h(
      "li",
      {
        id: `${this.options.id}-hit-${index}`,
        role: "option",
        "aria-selected": String(chosen),
        onmousedown: (event: MouseEvent) => {
          event.preventDefault();
          this.#choose(index);
        },
      },
      h("span", {}, hit.title),
      h("small", {}, more.filter(Boolean).join(" · ")),
    );
  }

  #say(text: string): void {
    this.#list.replaceChildren(h("li", { class: "nothing" }, text));
    this.#open();
  }

  #open(): void {
    this.#list.hidden = false;
    this.#input.setAttribute("aria-expanded", "true");
    this.#input.setAttribute("aria-activedescendant", this.#active >= 0 ? `${this.options.id}-hit-${this.#active}` : "");
  }

  #close(): void {
    this.#list.hidden = true;
    this.#list.replaceChildren();
    this.#input.setAttribute("aria-expanded", "false");
    this.#input.setAttribute("aria-activedescendant", "");
  }

  /** Takes the first hit, or the one that the arrows chose. Who types fast has the hits of an older text, or none yet. */
  async #enter(): Promise<void> {
    const text = this.#input.value.trim();
    if (text === "") return this.options.emptied?.();
    if (text !== this.#found) {
      clearTimeout(this.#timer);
      await this.#ask();
    }
    if (text === this.#found && text === this.#input.value.trim()) this.#choose(Math.max(this.#active, 0));
  }

  #choose(index: number): void {
    const hit = this.#hits[index];
    if (!hit) return;
    this.#close();
    this.#input.blur();
    this.go(hit);
  }

  #key(event: KeyboardEvent): void {
    const step = event.key === "ArrowDown" ? 1 : event.key === "ArrowUp" ? -1 : 0;
    if (step !== 0 && this.#hits.length > 0) {
      event.preventDefault();
      this.#active = (this.#active + step + this.#hits.length) % this.#hits.length;
      this.#draw();
    } else if (event.key === "Enter") {
      void this.#enter();
    } else if (event.key === "Escape") {
      event.stopPropagation();
      this.#close();
      this.#input.blur();
    }
  }
}
