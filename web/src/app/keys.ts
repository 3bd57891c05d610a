// Keyboard shortcuts of one key. Keys typed into a field or with a modifier such as Ctrl are ignored.

export interface Commands {
  escape(): void;
  find(): void;
  chooseVehicle(): void;
  compare(): void;
  route(): void;
  showStats(): void;
  copyLink(): void;
  help(): void;
  /** Returns whether there is an older database. */
  toggleChanges(): boolean;
  toggleTheme(): void;
  /** Returns whether there was a drive. */
  toggleDrive(): boolean;
}

export const keys: readonly [key: string, does: string][] = [
  ["/", "find a road by name, number or id"],
  ["V", "choose a vehicle"],
  ["C", "compare two vehicles side by side"],
  ["R", "route: type or click where it begins and where it goes"],
  ["Space", "start and stop the drive"],
  ["N", "the region in numbers"],
  ["S", "what changed since the older database"],
  ["L", "copy a link to what you see"],
  ["D", "dark or light"],
  ["← ↑ ↓ → + −", "move and zoom the map, when it has the focus"],
  ["Enter", "on the map: take the place under the cross, or open the road under it"],
  ["Esc", "close what lies on top"],
  ["?", "this help"],
];

export function listenToKeys(commands: Commands): void {
  const actions: Record<string, () => void> = {
    "/": () => commands.find(),
    v: () => commands.chooseVehicle(),
    c: () => commands.compare(),
    r: () => commands.route(),
    n: () => commands.showStats(),
    l: () => commands.copyLink(),
    d: () => commands.toggleTheme(),
    "?": () => commands.help(),
    Escape: () => commands.escape(),
  };
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    const target = event.target as HTMLElement;
    if (target.closest("dialog")) return;
    const typing = target.matches("input:not([type=checkbox], [type=radio], [type=range]), select, textarea");
    if (typing) return;
    if (event.key === " " && !target.matches("button, input, summary, a")) {
      if (commands.toggleDrive()) event.preventDefault();
      return;
    }
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (event.key.toLowerCase() === "s" && commands.toggleChanges()) event.preventDefault();
    if (!action) return;
    event.preventDefault();
    action();
  });
}
