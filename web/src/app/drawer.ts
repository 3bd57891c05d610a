// The panel on the right, or at the bottom of a narrow screen. It shows one thing at a time, and remembers where the reader was in each.

import { byId, h } from "../ui/dom.ts";
import { icon } from "../ui/icons.ts";

/** Where the reader was in a content. */
interface Left {
  top: number;
  focused: Element | null;
}

export class Drawer {
  readonly #root = byId("drawer");
  readonly #content = h("div", { class: "drawer-content" });
  readonly #back: HTMLButtonElement;
  readonly #left = new WeakMap<Element, Left>();

  constructor(close: () => void, back: () => void) {
    const shut = h("button", { class: "plain drawer-close", type: "button", "aria-label": "Close", onclick: close }, icon("close"));
    this.#back = h("button", { class: "drawer-back", type: "button", hidden: true, onclick: back }, icon("back"), "Back to the route");
    this.#root.append(shut, this.#back, this.#content);
  }

  /** Shows a content. `back` says whether there is a route behind it. */
  show(content: HTMLElement, back = false): void {
    const before = this.#content.firstElementChild;
    // Read first: what is hidden loses the focus.
    const focused = this.#root.contains(document.activeElement) ? document.activeElement : null;
    this.#back.hidden = !back;
    if (content !== before) {
      if (before) this.#left.set(before, { top: this.#root.scrollTop, focused });
      this.#content.replaceChildren(content);
      const left = this.#left.get(content);
      this.#root.scrollTop = left?.top ?? 0;
      // Who came with the keyboard goes on from here.
      if (focused && back) this.#back.focus();
      else if (focused && left?.focused instanceof HTMLElement) left.focused.focus();
    }
    this.#root.hidden = false;
    document.body.classList.add("has-drawer");
  }

  hide(): void {
    this.#root.hidden = true;
    this.#back.hidden = true;
    document.body.classList.remove("has-drawer");
  }
}
