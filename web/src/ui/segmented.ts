// A choice of a few values side by side. They are styled radio buttons, so that arrow keys and screen readers work.

import { h } from "./dom.ts";

export interface Choice<T extends string> {
  value: T;
  name: string;
  title?: string;
  disabled?: boolean;
}

export class Segmented<T extends string> {
  readonly element: HTMLFieldSetElement;
  readonly #inputs: HTMLInputElement[] = [];

  constructor(name: string, legend: string, choices: readonly Choice<T>[], onChange: (value: T) => void) {
    this.element = h("fieldset", { class: "segmented" }, h("legend", { class: "sr-only" }, legend));
    for (const choice of choices) {
      const change = () => onChange(choice.value);
      const input = h("input", { type: "radio", name, value: choice.value, disabled: choice.disabled, onchange: change });
      this.#inputs.push(input);
      this.element.append(h("label", { title: choice.title }, input, h("span", {}, choice.name)));
    }
  }

  set value(value: T) {
    for (const input of this.#inputs) input.checked = input.value === value;
  }
}
