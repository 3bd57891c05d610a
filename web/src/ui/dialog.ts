// A modal dialog with a title and a button to close it. Escape and a click beside the dialog close it, too.

import { h } from "./dom.ts";
import { icon } from "./icons.ts";

export class Dialog {
  readonly element: HTMLDialogElement;
  /** It scrolls, so the keyboard must reach it. */
  readonly body = h("div", { class: "dialog-body", tabindex: 0 });
  readonly #heading: HTMLElement;

  constructor(kind: string, title: string, onClose: () => void = () => {}) {
    this.#heading = h("h2", { id: `${kind}-title` }, title);
    const close = h("button", { class: "plain", type: "button", "aria-label": "Close", onclick: () => this.close() }, icon("close"));
    this.element = h(
      "dialog",
      { class: `dialog ${kind}`, "aria-labelledby": `${kind}-title`, onclose: onClose, onclick: (event: MouseEvent) => this.#beside(event) },
      h("header", {}, this.#heading, close),
      this.body,
    );
    document.body.append(this.element);
  }

  set title(text: string) {
    this.#heading.textContent = text;
  }

  open(): void {
    if (!this.element.open) this.element.showModal();
  }

  close(): void {
    if (this.element.open) this.element.close();
  }

  #beside(event: MouseEvent): void {
    if (event.target === this.element) this.close();
  }
}
