// What every part of the page is given: the state, and what of the database does not change while the page is open.

import type { Region, Vehicle } from "./api/types.ts";
import type { Question } from "./api/client.ts";
import type { Store } from "./state.ts";
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

/** What the first map asks for. */
export function question({ store }: Context): Question {
  return { vehicle: store.state.vehicle, policy: store.state.policy };
}
