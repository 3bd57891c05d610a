// A combination from the side, to scale, front to the left.

import type { Vehicle } from "../api/types.ts";
import { styled, svg } from "../ui/dom.ts";
import { length as inWords } from "../units.ts";
import { heightOf, shapes, straight, type Block } from "./shape.ts";

/** Room above and at the ends, metres. */
const ROOM = 0.3;

/**
 * The picture, `metres` wide. Pictures of the same width have the same scale. Colours are the custom properties `--unit-0`,
 * `--unit-1` and so on of the style sheet.
 */
export function sideView(vehicle: Vehicle, metres = vehicle.length_m): SVGSVGElement {
  const height = Math.max(heightOf(vehicle), 1.5);
  const axles = straight(vehicle);
  const wide = Math.max(metres, vehicle.length_m) + 2 * ROOM;
  const tall = height + 2 * ROOM;
  const units = shapes(vehicle).map((shape, index) => {
    const at = axles[index] ?? 0;
    const group = styled(svg("g", { class: "unit" }), { "--unit": `var(--unit-${index % 7})` });
    for (const block of shape.blocks) group.append(rectangle(block, at, height));
    for (const wheel of shape.wheels) {
      const centre = { cx: at - wheel, cy: height - shape.wheelRadius };
      group.append(
        svg("circle", { class: "tyre", ...centre, r: shape.wheelRadius }),
        svg("circle", { class: "hub", ...centre, r: 0.42 * shape.wheelRadius }),
      );
    }
    return group;
  });
  const ground = svg("line", { class: "ground", x1: -ROOM, x2: wide - ROOM, y1: height, y2: height });
  return svg(
    "svg",
    {
      class: "vehicle",
      viewBox: `${-ROOM} ${-ROOM} ${wide} ${tall}`,
      role: "img",
      "aria-label": `${vehicle.name}, ${inWords(vehicle.length_m)} long, from the side`,
      preserveAspectRatio: "xMinYMax meet",
    },
    ground,
    ...units,
  );
}

function rectangle(block: Block, axle: number, height: number): SVGElement {
  const shape = {
    x: axle - block.front,
    y: height - block.high,
    width: Math.max(block.front - block.rear, 0.02),
    height: block.high - block.low,
    rx: block.kind === "cab" ? 0.28 : block.kind === "saloon" ? 0.25 : 0.08,
  };
  const group = svg("g", {}, svg("rect", { class: block.kind, ...shape }));
  if (block.kind === "cab" && block.high - block.low > 0.5 * height && shape.width > 0.9) {
    // A window.
    group.append(
      svg("rect", { class: "glass", x: shape.x + 0.12, y: shape.y + 0.25, width: Math.min(0.9, 0.45 * shape.width), height: 0.3 * shape.height, rx: 0.12 }),
    );
  }
  if (block.kind === "saloon") {
    const band = { y: shape.y + 0.5, height: 0.32 * shape.height, rx: 0.12 };
    group.append(svg("rect", { class: "glass", x: shape.x + 0.2, width: Math.max(shape.width - 0.4, 0.1), ...band }));
  }
  return group;
}
