// A short message that disappears by itself. Screen readers announce it.

import { h } from "./dom.ts";

const SHOWN_MS = 5000;
let timer: ReturnType<typeof setTimeout> | undefined;
let shown: HTMLElement | undefined;

export function toast(text: string): void {
  shown ??= document.body.appendChild(h("div", { class: "toast", role: "status" }));
  shown.textContent = text;
  shown.classList.add("is-shown");
  clearTimeout(timer);
  timer = setTimeout(() => shown?.classList.remove("is-shown"), SHOWN_MS);
}
