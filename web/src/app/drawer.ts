// The panel on the right, or at the bottom of a narrow screen. It shows one thing at a time.

import { byId, h } from "../ui/dom.ts";
import { icon } from "../ui/icons.ts";

export class Drawer {
  readonly #root = byId("drawer");
  readonly #content = h("div", { class: "drawer-content" });

  constructor(close: () => void) {
    const shut = h("button", { class: "plain drawer-close", type: "button", "aria-label": "Close", onclick: close }, icon("close"));
    this.#root.append(shut, this.#content);
  }

  show(content: HTMLElement): void {
    if (content.parentElement !== this.#content) {
      this.#content.replaceChildren(content);
      this.#content.scrollTop = 0;
    }
    this.#root.hidden = false;
    document.body.classList.add("has-drawer");
  }

  hide(): void {
    this.#root.hidden = true;
    document.body.classList.remove("has-drawer");
  }
}
