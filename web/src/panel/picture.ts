// The picture of an explanation. The panel shows only its scene, the swept path at the limiting place; the enlarged view shows all.

import { patient } from "../api/patient.ts";
import { Dialog } from "../ui/dialog.ts";
import { h, styled } from "../ui/dom.ts";

interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}

export class Picture {
  readonly #zoom = new Dialog("picture", "Swept path at the place that decides");

  /** A button with the scene. It is filled when the picture is loaded, and removed if there is no picture. */
  show(url: string, alt: string, signal: AbortSignal): HTMLElement {
    const frame = h("span", { class: "scene" });
    const open = () => {
      this.#zoom.body.replaceChildren(h("img", { src: url, alt }));
      this.#zoom.open();
    };
    const button = h("button", { class: "picture-button", type: "button", title: "Enlarge", onclick: open }, frame);
    patient(url, { signal })
      .then((answer) => (answer.ok ? answer.text() : Promise.reject(new Error(String(answer.status)))))
      .then((text) => fill(frame, text, url, alt))
      .catch(() => button.remove());
    return button;
  }
}

/** Shows the scene of the picture, which is its first clipped part, in the frame. */
function fill(frame: HTMLElement, text: string, url: string, alt: string): void {
  const picture = new DOMParser().parseFromString(text, "image/svg+xml").documentElement;
  const [, , wide = 0, tall = 0] = (picture.getAttribute("viewBox") ?? "").split(/\s+/).map(Number);
  const whole: Box = { x: 0, y: 0, width: wide, height: tall };
  const scene = box(picture.querySelector("clipPath rect")) ?? whole;
  const image = h("img", { src: url, alt });
  frame.replaceChildren(image);
  if (wide <= 0 || tall <= 0) return;
  styled(frame, { "aspect-ratio": `${scene.width} / ${scene.height}` });
  styled(image, {
    width: `${(100 * wide) / scene.width}%`,
    left: `${(-100 * scene.x) / scene.width}%`,
    top: `${(-100 * scene.y) / scene.height}%`,
  });
}

function box(element: Element | null): Box | null {
  if (!element) return null;
  const [x = 0, y = 0, width = 0, height = 0] = ["x", "y", "width", "height"].map((name) => Number(element.getAttribute(name)));
  return width > 0 && height > 0 ? { x, y, width, height } : null;
}
