// What blocks a route: places that are not certified, on the way where they are fewest and smallest.

import type { Obstacle } from "../api/types.ts";
import { careful, evidenceWords, reasonWords } from "../words.ts";
import type { Item } from "./numbered.ts";

/** Successive obstacles on one road for one reason are one line, shown by the worst of them. */
export function obstacleItems(obstacles: readonly Obstacle[]): Item[] {
  return grouped(obstacles).map((group, index) => {
    const short = ({ rsc_m }: Obstacle): number => (rsc_m !== null && rsc_m > -100 ? Math.min(rsc_m, 0) : 0);
    const worst = group.reduce((most, one) => (short(one) < short(most) ? one : most));
    const missing = short(worst) < 0 ? `: ${group.length > 1 ? "up to " : ""}${careful(short(worst))} missing` : "";
    const { edge_id, from_edge, to_edge } = worst;
    return {
      number: index + 1,
      place: worst.place,
      title: worst.title.replace(/^(.+) into \1$/, "Turn on $1"),
      what: `${whyNot(worst)}${missing}`,
      more: [group.length > 1 ? `${group.length} places` : kindWords(worst.kind), assumption(worst)].filter(Boolean).join(" · "),
      road: edge_id ? { edge: edge_id } : from_edge && to_edge ? { from: from_edge, to: to_edge } : null,
    };
  });
}

/** `too narrow (31), no access (2)`, the most frequent first. */
export function reasons(obstacles: readonly Obstacle[]): string {
  const counts = new Map<string, number>();
  for (const obstacle of obstacles) counts.set(whyNot(obstacle), (counts.get(whyNot(obstacle)) ?? 0) + 1);
  const sorted = [...counts].sort((a, b) => b[1] - a[1]);
  return sorted.map(([why, count]) => `${why.charAt(0).toLowerCase()}${why.slice(1)} (${count})`).join(", ");
}

function kindWords(kind: Obstacle["kind"]): string {
  return { edge: "road", turn: "turn", roundabout: "roundabout", complex: "turn over several nodes" }[kind];
}

/** What the verdict rests on, where that is not law. */
function assumption({ verdict, width_source, kerb_assumed }: Obstacle): string | null {
  if (verdict === "forbidden") return null;
  if (width_source) return `width: ${evidenceWords[width_source].toLowerCase()}`;
  return kerb_assumed ? "kerb radius: assumed" : null;
}

function whyNot({ verdict, reason }: Obstacle): string {
  return verdict === "refuted" ? "Fails as part of the whole" : reasonWords(verdict, reason);
}

function grouped(obstacles: readonly Obstacle[]): Obstacle[][] {
  const groups: Obstacle[][] = [];
  for (const obstacle of obstacles) {
    const last = groups.at(-1)?.[0];
    const same = last && last.kind === "edge" && obstacle.kind === "edge" && last.title === obstacle.title && whyNot(last) === whyNot(obstacle);
    if (same) groups.at(-1)!.push(obstacle);
    else groups.push([obstacle]);
  }
  return groups;
}
