// The context of every part of the page: the state, and facts of the database that do not change while the page is open.

import type { Region, Vehicle } from "./api/types.ts";
import type { Question } from "./api/client.ts";
import type { Store } from "./state.ts";
import type { Units } from "./units.ts";
import type { ThemeSwitch } from "./ui/theme.ts";

export interface Context {
  store: Store;
  region: Region;
  vehicles: Vehicle[];
  theme: ThemeSwitch;
}

export function vehicleOf({ vehicles }: Context, id: string): Vehicle | undefined {
  return vehicles.find((vehicle) => vehicle.id === id);
}

/** The units of the reader's choice, else those that are usual where the vehicle comes from. */
export function unitsOf(context: Context): Units {
  const { units, vehicle } = context.store.state;
  return units ?? (vehicleOf(context, vehicle)?.region === "US" ? "feet" : "metres");
}

/** Whether both databases have the vehicle under the policy of the first map, so that they can be compared. */
export function comparable(context: Context): boolean {
  const { vehicle, policy } = question(context);
  return context.region.before?.sets.some((set) => set.vehicle === vehicle && set.policy === policy) ?? false;
}

/** The vehicle and policy of the first map. */
export function question({ store }: Context): Question {
  return { vehicle: store.state.vehicle, policy: store.state.policy };
}
