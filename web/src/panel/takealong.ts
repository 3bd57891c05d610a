// A certified route as a file to take along: GPX for navigation devices, GeoJSON for map programs. Each says what it holds for.

import type { Position, Route } from "../api/types.ts";
import { h } from "../ui/dom.ts";

/** What a file says beside the line. */
export interface About {
  vehicle: string;
  vehicleName: string;
  policy: string;
  /** The state of the database, and the day of its map data. */
  database: string;
  timestamp: string | null;
  scope: string;
}

function escaped(text: string): string {
  const names: Record<string, string> = { "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "'": "&apos;" };
  // XML has no other control characters than tabs and ends of lines.
  return text.replace(/[&<>"']/g, (one) => names[one] ?? "").replace(/[\u0000-\u0008\u000b\u000c\u000e-\u001f]/g, "");
}

function scoped(route: Route, { vehicle, policy, scope }: About): string {
  return `For ${vehicle}, strip: ${policy}. ${beyond(route)}${scope}`;
}

/** Where the route uses more than its own lane, in one sentence. */
function beyond({ uses }: Route): string {
  const stretches = uses.map((used) => `${used.what} from ${used.from_m.toFixed(0)} m to ${used.to_m.toFixed(0)} m, at most ${used.beyond_m.toFixed(2)} m over the line`);
  return uses.length === 0 ? "" : `Beyond its own lane: ${stretches.join("; ")}. `;
}

export function gpx(route: Route, about: About): string {
  const points = route.geometry.coordinates.map(([lon, lat]) => `<trkpt lat="${lat}" lon="${lon}"/>`).join("\n");
  const time = about.timestamp ? `<time>${escaped(about.timestamp)}</time>` : "";
  return `<?xml version="1.0" encoding="UTF-8"?>
<gpx version="1.1" creator="netcert" xmlns="http://www.topografix.com/GPX/1/1">
<metadata><name>${escaped(`Certified route for ${about.vehicleName}`)}</name><desc>${escaped(scoped(route, about))}</desc>${time}</metadata>
<trk><name>${escaped(`netcert ${about.vehicle}`)}</name><trkseg>
${points}
</trkseg></trk>
</gpx>
`;
}

export function geojson(route: Route, about: About): string {
  const { length_m, time_s, rsc_m, hinge_margin_deg, shrink, safe, limiting_s_m, limiting_at, rung, uses } = route;
  const properties = { ...about, length_m, time_s, rsc_m, hinge_margin_deg, shrink, safe, limiting_s_m, limiting_at, rung, uses };
  const feature = (geometry: { type: string; coordinates: Position[] }) => ({ type: "Feature", geometry, properties });
  return `${JSON.stringify({ type: "FeatureCollection", features: [feature(route.geometry)] })}\n`;
}

/** Buttons that save the files. */
export function takeAlong(route: Route, about: About): HTMLElement {
  const button = (name: string, kind: string, make: typeof gpx) =>
    h("button", { class: "small", type: "button", onclick: () => save(`netcert-${about.vehicle}.${name.toLowerCase()}`, kind, make(route, about)) }, name);
  return h(
    "div",
    { class: "tools", role: "group", "aria-label": "Take the route along" },
    h("span", { class: "label" }, "Take it along"),
    button("GPX", "application/gpx+xml", gpx),
    button("GeoJSON", "application/geo+json", geojson),
  );
}

function save(name: string, type: string, text: string): void {
  const href = URL.createObjectURL(new Blob([text], { type }));
  h("a", { href, download: name }).click();
  // The browser reads the file after the click.
  setTimeout(() => URL.revokeObjectURL(href), 10_000);
}
