// The theme: as in the system until the reader chooses light or dark. The choice is stored on this machine.

import { palettes, properties, type Theme } from "../map/palette.ts";
import { styled } from "./dom.ts";

const KEY = "netcert.theme";

export class ThemeSwitch {
  readonly #system = matchMedia("(prefers-color-scheme: dark)");
  readonly #listeners: ((theme: Theme) => void)[] = [];
  #chosen: Theme | null = stored();

  constructor() {
    this.#system.addEventListener("change", () => this.#apply());
    this.#apply();
  }

  get theme(): Theme {
    return this.#chosen ?? (this.#system.matches ? "dark" : "light");
  }

  toggle(): void {
    this.#chosen = this.theme === "dark" ? "light" : "dark";
    try {
      localStorage.setItem(KEY, this.#chosen);
    } catch {
      // Private windows may refuse storage. The choice then lasts until the page is closed.
    }
    this.#apply();
  }

  listen(listener: (theme: Theme) => void): void {
    this.#listeners.push(listener);
  }

  #apply(): void {
    document.documentElement.dataset["theme"] = this.theme;
    styled(document.documentElement, properties(palettes[this.theme]));
    for (const listener of this.#listeners) listener(this.theme);
  }
}

function stored(): Theme | null {
  try {
    const value = localStorage.getItem(KEY);
    return value === "light" || value === "dark" ? value : null;
  } catch {
    return null;
  }
}
