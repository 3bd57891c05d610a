// Metres, or feet and inches. The page counts in metres; this module alone puts lengths into words, rounded to the cautious side.

export type Units = "metres" | "feet";
export const UNITS: readonly Units[] = ["metres", "feet"];

const KEY = "netcert.units";
const INCH_M = 0.0254;
const MILE_M = 1609.344;

let units: Units = "metres";

/** The units in which all words are made from now on. Returns whether they are other ones than before. */
export function speakIn(next: Units): boolean {
  const other = next !== units;
  units = next;
  return other;
}

export function spoken(): Units {
  return units;
}

/** What the reader chose on this machine, if anything. */
export function storedUnits(): Units | null {
  try {
    return UNITS.find((one) => one === localStorage.getItem(KEY)) ?? null;
  } catch {
    return null;
  }
}

export function storeUnits(chosen: Units): void {
  try {
    localStorage.setItem(KEY, chosen);
  } catch {
    // Private windows may refuse storage. The choice then lasts until the page is closed, and is in the link.
  }
}

type Rounding = "down" | "up" | "near";

/** Rounds so that an error of computing does not count as a step. */
function rounded(value: number, rounding: Rounding): number {
  if (rounding === "near") return Math.round(value);
  return rounding === "down" ? Math.floor(value + 1e-6) : Math.ceil(value - 1e-6);
}

/** A length at the scale of a vehicle: `2.23 m`, or `7 ft 4 in`. */
export function length(metres: number, rounding: Rounding = "near"): string {
  if (units === "metres") return `${(rounded(metres * 100, rounding) / 100).toFixed(2)} m`;
  const inches = rounded(metres / INCH_M, rounding);
  const [feet, rest] = [Math.floor(inches / 12), inches % 12];
  return [feet > 0 ? `${feet} ft` : "", rest > 0 || feet === 0 ? `${rest} in` : ""].filter(Boolean).join(" ");
}

const whole = new Intl.NumberFormat("en", { maximumFractionDigits: 0 });

/** A length of road: `547 km`, or `340 mi`. */
export function roadLength(metres: number): string {
  const [size, name] = units === "metres" ? [1000, "km"] : [MILE_M, "mi"];
  const many = metres / size;
  if (many === 0) return `0 ${name}`;
  if (many < 0.1) return `< 0.1 ${name}`;
  return many < 10 ? `${many.toFixed(1)} ${name}` : `${whole.format(many)} ${name}`;
}

/** An area of ground: `784 m²`, or `8,439 square feet`. */
export function square(metres2: number): string {
  return units === "metres" ? `${whole.format(metres2)} m²` : `${whole.format(metres2 / (12 * INCH_M) ** 2)} square feet`;
}

/** A distance along a way: `240 m` or `3.41 km`, or `790 ft` or `2.12 mi`. */
export function distance(metres: number): string {
  if (units === "metres") return metres < 1000 ? `${whole.format(metres)} m` : `${(metres / 1000).toFixed(metres < 10000 ? 2 : 1)} km`;
  const miles = metres / MILE_M;
  return miles < 0.19 ? `${whole.format(metres / (12 * INCH_M))} ft` : `${miles.toFixed(miles < 10 ? 2 : 1)} mi`;
}
