// Colours of the map, for light and dark.
//
// Room to spare is blue, and more room differs more in lightness from the paper. Missing room is orange, and the more is missing, the
// more it differs from the paper: what is most impossible must not look harmless. Blue and orange stay apart under deuteranopia and protanopia
// (`test/palette.test.mjs` simulates both). Verdicts also differ in line width and dashes, so that nothing depends on colour alone.
// Categories have the colours of Okabe and Ito (Color Universal Design, 2008).

import type { Evidence, Policy } from "../api/types.ts";

export type Theme = "light" | "dark";

/** One class of the scale: margins from `from_m` up. */
export interface Step {
  from_m: number;
  label: string;
}

export const roomSteps: readonly Step[] = [
  { from_m: 0, label: "0" },
  { from_m: 0.25, label: "0.25" },
  { from_m: 0.5, label: "0.5" },
  { from_m: 1, label: "1 m" },
];

/** The steps of missing room, from the most to the least. */
export const missingSteps: readonly Step[] = [
  { from_m: -Infinity, label: "" },
  { from_m: -1, label: "1 m" },
  { from_m: -0.5, label: "0.5" },
  { from_m: -0.25, label: "0.25" },
];

export interface Palette {
  outside: string;
  paper: string;
  /** What lies behind the roads: greyer and paler than any verdict. */
  wood: string;
  water: string;
  casing: string;
  ink: string;
  halo: string;
  soft: string;
  room: readonly [string, string, string, string];
  missing: readonly [string, string, string, string];
  /** The narrowest strip that is certified, and roads where none is. Blue stays on its own side; what meets oncoming traffic is gold. */
  strips: Readonly<Record<Policy, string>>;
  noStrip: string;
  /** What stands in the way, what is tightest, what has become worse. */
  alarm: string;
  forbidden: string;
  unknown: string;
  selected: string;
  /** The glow under the selected road. It has no verdict's hue and is lighter than all of them. */
  glow: string;
  route: string;
  routeCasing: string;
  /** The stripes of a route under conditions. No verdict has their hue, nor has any line of roads two colours. */
  conditional: string;
  conditionalGap: string;
  /** Roads that only the newer database has, and roads that only the older one has. No verdict has their hues. */
  appeared: string;
  went: string;
  units: readonly string[];
  /** The surface of roads in their real width. */
  surface: string;
  corridor: string;
  swept: string;
}

export const palettes: Record<Theme, Palette> = {
  light: {
    outside: "#e9e7e1",
    paper: "#f7f5f0",
    wood: "#eaede0",
    water: "#d3dee4",
    casing: "#f7f5f0",
    ink: "#1b1f24",
    halo: "#fbfaf7",
    soft: "#6a717a",
    room: ["#2f93d8", "#1a6fb8", "#0d4c90", "#07285a"],
    missing: ["#7d2600", "#ad4300", "#dd6a10", "#eb9d58"],
    strips: { lane: "#0d4c90", direction: "#2f9fd8", carriageway: "#a97f00" },
    noStrip: "#7d2600",
    alarm: "#d95f0e",
    forbidden: "#3b4048",
    unknown: "#8d949c",
    selected: "#111417",
    glow: "#ffd60a",
    route: "#111417",
    routeCasing: "#ffffff",
    conditional: "#ffdd00",
    conditionalGap: "#111417",
    appeared: "#00805f",
    went: "#a0208f",
    units: ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#c9bb1c"],
    surface: "#e6e3dc",
    corridor: "#d6d3cb",
    swept: "#b9d3e8",
  },
  dark: {
    outside: "#0e1013",
    paper: "#15181c",
    wood: "#1a231d",
    water: "#20313c",
    casing: "#15181c",
    ink: "#e8eaed",
    halo: "#15181c",
    soft: "#949ba5",
    room: ["#2b78b8", "#4ba0e2", "#8bc6f6", "#dcefff"],
    missing: ["#ffb27d", "#f08434", "#b9601f", "#84481c"],
    strips: { lane: "#dcefff", direction: "#4ba0e2", carriageway: "#d8b13c" },
    noStrip: "#b9501f",
    alarm: "#f58a32",
    forbidden: "#8f96a0",
    unknown: "#69717b",
    selected: "#ffffff",
    glow: "#ffe033",
    route: "#ffffff",
    routeCasing: "#15181c",
    conditional: "#ffee11",
    conditionalGap: "#000000",
    appeared: "#35d0a0",
    went: "#ff7ac1",
    units: ["#3d9bd8", "#e69f00", "#1fb489", "#d48fb6", "#7cc6f0", "#e0702a", "#f0e442"],
    surface: "#22262b",
    corridor: "#2c3138",
    swept: "#28445c",
  },
};

/** The colours that the style sheet uses, as custom properties. */
export function properties({ room, missing, alarm, forbidden, unknown, units, corridor, ink, route, routeCasing, conditional, conditionalGap, appeared, went }: Palette): Record<string, string> {
  const numbered = units.map((colour, index) => [`--unit-${index}`, colour]);
  const verdicts = { "--safe": room[2], "--unsafe": missing[1], "--forbidden": forbidden, "--unknown": unknown };
  const shapes = { "--ground": corridor, "--edge": ink, "--path": route, "--path-casing": routeCasing };
  const routes = { "--conditional": conditional, "--conditional-gap": conditionalGap, "--obstacle": alarm };
  const changes = { "--worse": alarm, "--appeared": appeared, "--went": went };
  return { ...verdicts, ...shapes, ...routes, ...changes, ...Object.fromEntries(numbered) };
}

/** The colour of each reason, by `verdict/reason`. */
export const reasonColours: Record<string, string> = {
  "unsafe/width": "#e69f00",
  "unsafe/articulation": "#d55e00",
  "unsafe/steering_lock": "#cc79a7",
  forbidden: "#56626f",
  unknown: "#98a0a8",
};

/** The colour of each source of width. A better source differs more from the paper. */
export const evidenceColours: Record<Theme, Record<Evidence | "none", string>> = {
  light: {
    none: "#a5abb2",
    assumed: "#d8b365",
    from_lanes: "#7fbfb0",
    estimated: "#3f9d94",
    tagged: "#01665e",
    surveyed: "#003c30",
  },
  dark: {
    none: "#6f7781",
    assumed: "#9a7433",
    from_lanes: "#3d8f80",
    estimated: "#5dbfae",
    tagged: "#a6e3d6",
    surveyed: "#e4fbf5",
  },
};

export function marginColour(palette: Palette, rsc_m: number): string {
  const steps = rsc_m < 0 ? missingSteps : roomSteps;
  const colours = rsc_m < 0 ? palette.missing : palette.room;
  let at = 0;
  steps.forEach((step, index) => {
    if (rsc_m >= step.from_m) at = index;
  });
  return colours[at] ?? colours[0];
}
