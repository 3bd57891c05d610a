// Line icons on a grid of 24, drawn for this page.

import { svg } from "./dom.ts";

const paths = {
  search: "M10.5 4a6.5 6.5 0 1 1 0 13a6.5 6.5 0 0 1 0-13M15.5 15.5L20 20",
  route: "M6 19a2 2 0 1 0 0-4a2 2 0 0 0 0 4M18 9a2 2 0 1 0 0-4a2 2 0 0 0 0 4M8 17h6a3.5 3.5 0 0 0 0-7h-4a2.5 2.5 0 0 1 0-5h6",
  compare: "M12 4v16M4 7h5v10H4zM15 7h5v10h-5z",
  stats: "M4 20h16M7 20v-6M12 20V5M17 20v-9",
  link: "M10 14a4 4 0 0 0 5.7 0l3-3a4 4 0 0 0-5.7-5.7l-1 1M14 10a4 4 0 0 0-5.7 0l-3 3a4 4 0 0 0 5.7 5.7l1-1",
  close: "M6 6l12 12M18 6L6 18",
  moon: "M19.5 14.5A8 8 0 0 1 9.5 4.5a8 8 0 1 0 10 10",
  sun: "M12 8a4 4 0 1 1 0 8a4 4 0 0 1 0-8M12 2.5v2M12 19.5v2M2.5 12h2M19.5 12h2M5.3 5.3l1.4 1.4M17.3 17.3l1.4 1.4M5.3 18.7l1.4-1.4M17.3 6.7l1.4-1.4",
  help: "M9.2 9a2.9 2.9 0 1 1 4.3 2.5c-1 .6-1.5 1.1-1.5 2.3M12 17.2v.1M12 3a9 9 0 1 1 0 18a9 9 0 0 1 0-18",
  chevron: "M7 10l5 5l5-5",
  play: "M8 5.5v13l11-6.5z",
  pause: "M8.5 5.5v13M15.5 5.5v13",
  restart: "M5 12a7 7 0 1 0 2.2-5.1M5 4.5v4h4",
  eye: "M2.5 12S6 5.5 12 5.5S21.5 12 21.5 12S18 18.5 12 18.5S2.5 12 2.5 12M12 9.5a2.5 2.5 0 1 1 0 5a2.5 2.5 0 0 1 0-5",
  plus: "M12 5v14M5 12h14",
  minus: "M5 12h14",
  home: "M4 4h5M4 4v5M20 4h-5M20 4v5M4 20h5M4 20v-5M20 20h-5M20 20v-5",
  chase: "M12 3l8 4.5v9L12 21l-8-4.5v-9zM12 12l8-4.5M12 12v9M12 12L4 7.5",
  above: "M5 5h14v14H5zM12 8v8M8 12h8",
  swap: "M4 9h14M14 5l4 4l-4 4M20 15H6M10 11l-4 4l4 4",
  back: "M19 12H5M11 6l-6 6l6 6",
  sheet: "M7 8V4h10v4M7 17H4v-7a2 2 0 0 1 2-2h12a2 2 0 0 1 2 2v7h-3M7 14h10v6H7z",
  layers: "M12 4l9 5l-9 5l-9-5zM3.5 13.5L12 18.3l8.5-4.8",
} as const;

export type IconName = keyof typeof paths;

export function icon(name: IconName): SVGSVGElement {
  const path = svg("path", { d: paths[name] });
  return svg("svg", { class: "icon", viewBox: "0 0 24 24", "aria-hidden": "true", focusable: "false" }, path);
}
