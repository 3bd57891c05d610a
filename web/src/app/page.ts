// The page as a whole. It makes the parts and passes each change of the state to the parts that need it.

import { api } from "../api/client.ts";
import type { Stats } from "../api/stats.ts";
import type { ChangedRoad, Explanation, SearchHit } from "../api/types.ts";
import { question, unitsOf, vehicleOf, type Context } from "../context.ts";
import type { Possible } from "../link.ts";
import type { Under } from "../map/view.ts";
import { ExplainPanel } from "../panel/explain.ts";
import { StatsDialog } from "../panel/stats.ts";
import { WholeRoadCard } from "../panel/wholeroad.ts";
import { VehicleDialog, fittingPolicy } from "../panel/vehicle.ts";
import { UNPLACED, complete, type State } from "../state.ts";
import { h } from "../ui/dom.ts";
import { toast } from "../ui/toast.ts";
import { speakIn } from "../units.ts";
import { ChangesSince } from "./changes.ts";
import { Drawer } from "./drawer.ts";
import { History } from "./history.ts";
import { HelpDialog } from "./help.ts";
import { listenToKeys } from "./keys.ts";
import { Maps } from "./maps.ts";
import { renew, toldBefore } from "./renew.ts";
import { Routing } from "./routing.ts";
import { Side } from "./side.ts";
import { Tools } from "./tools.ts";
import { Welcome, welcomed } from "./welcome.ts";

export class Page {
  readonly #maps: Maps;
  readonly #side: Side;
  readonly #drawer: Drawer;
  readonly #explain: ExplainPanel;
  readonly #routing: Routing;
  readonly #vehicles: VehicleDialog;
  readonly #stats: StatsDialog;
  readonly #help: HelpDialog;
  /** Null without an older database. */
  readonly #changes: ChangesSince | null;
  readonly #tools: Tools;
  readonly #welcome: Welcome;
  readonly #history: History;
  readonly #whole: WholeRoadCard;
  #numbers: Promise<Stats> | null = null;

  constructor(private readonly context: Context, first: State, possible: Possible) {
    // Read before the state is written into it.
    const bare = location.hash.length <= 1;
    const { region, store, theme } = context;
    this.#help = new HelpDialog(region.before !== null);
    this.#vehicles = new VehicleDialog(context);
    this.#stats = new StatsDialog(context);
    this.#drawer = new Drawer(() => this.#close(), () => store.set({ selected: null }));
    this.#maps = new Maps(context, {
      click: (under, lon, lat) => this.#click(under, lon, lat),
      moved: (camera) => store.set({ camera }),
      chooseOther: () => this.chooseOther(),
      endComparing: () => store.set({ other: null }),
    });
    this.#explain = new ExplainPanel({
      place: (explanation, goTo) => this.#place(explanation, goTo),
      shapes: (shapes) => this.#maps.shapes(shapes),
      select: (selected) => store.set({ selected }),
      source: () => this.#source(),
      editing: region.editing,
      renew: (words) => renew(words, store.state.baseMap),
      trace: (done) => this.#maps.trace(done),
      route: (end, place, name) => this.#routing.from(end, place, name),
      other: () => (store.state.other ? { ...question(context), vehicle: store.state.other } : null),
      changed: (id) => {
        const changed = this.#changes?.of(id);
        const note = this.#changes?.note(id);
        return changed && note ? { changed, note } : null;
      },
    });
    const { before } = region;
    this.#changes = before && new ChangesSince(context, before, this.#maps.first, { go: (road) => this.#goToChange(road), known: () => this.#changesKnown() });
    this.#routing = new Routing(context, this.#maps.first, this.#drawer);
    this.#side = new Side(context, { chooseVehicle: () => this.chooseVehicle(), go: (hit) => this.#search(hit), help: () => this.#help.open() }, this.#changes?.panel.element ?? null);
    this.#whole = new WholeRoadCard(context, this.#maps.first, (edge, lon, lat) => {
      store.set({ selected: edge });
      this.#maps.fit([lon, lat, lon, lat]);
    });
    this.#side.search.element.after(this.#whole.element);
    this.#tools = new Tools(context, {
      route: () => this.route(),
      compare: () => this.compare(),
      stats: () => store.set({ stats: !store.state.stats }),
      link: () => void this.copyLink(),
      home: () => this.#maps.home(),
      zoom: (by) => this.#maps.zoom(by),
    });
    this.#welcome = new Welcome(context, this.#maps.first, { chooseVehicle: () => this.chooseVehicle(), help: () => this.#help.open() });
    store.listen((_, changed) => this.#changed(changed));
    theme.listen(() => this.#recolour());
    this.#history = new History(store, first, possible, (camera) => this.#maps.jump(camera));
    listenToKeys(this);
    this.#changed(new Set(Object.keys(store.state) as (keyof State)[]), true);
    if (bare && !welcomed()) {
      this.#drawer.show(this.#welcome.element);
      this.#maps.home();
    }
    toldBefore();
    // For tests and for people who use the console.
    Object.assign(globalThis, { netcert: { map: this.#maps.first.map, store } });
  }

  /** Goes one step back. What is on top is closed first. */
  escape(): void {
    const { store } = this.context;
    if (this.#routing.drive.under) this.#routing.drive.end();
    else if (store.state.selected || store.state.route) this.#close();
    else if (store.state.other) store.set({ other: null });
    else this.#close();
  }

  /** Closes the explanation; if there is none, the route or the welcome. */
  #close(): void {
    const { store } = this.context;
    if (store.state.selected) return store.set({ selected: null });
    store.set({ route: null });
    this.#drawer.hide();
    this.#welcome.end();
  }

  /** What a printed sheet says of the database. */
  #source(): Node {
    const { region } = this.context;
    const made = [region.attribution, region.timestamp ? `map data of ${region.timestamp.slice(0, 10)}` : null, `netcert ${region.netcert}`, `database ${region.database_hash.slice(0, 16)}`];
    const printed = new Date().toISOString().slice(0, 10);
    return h("p", { class: "scope" }, `${made.filter(Boolean).join("; ")}. Printed ${printed} from ${location.href}`);
  }

  find(): void {
    this.#side.search.focus();
  }

  chooseVehicle(): void {
    const { store } = this.context;
    this.#vehicles.open("Choose a vehicle", store.state.vehicle, (vehicle) =>
      store.set({ vehicle, policy: fittingPolicy(this.context, vehicle) }),
    );
  }

  chooseOther(): void {
    const { store } = this.context;
    this.#vehicles.open("Compare with …", store.state.other ?? "", (other) => {
      if (!vehicleOf(this.context, other)?.certified.includes(store.state.policy)) {
        toast(`${other} is not certified under this policy.`);
      } else {
        store.set({ other });
      }
    });
  }

  compare(): void {
    const { store } = this.context;
    if (store.state.other) store.set({ other: null });
    else this.chooseOther();
  }

  route(): void {
    const { store } = this.context;
    const open = store.state.route !== null;
    store.set({ selected: null, route: open ? null : UNPLACED });
    // On a touch screen the keyboard would cover the map.
    if (!open && !matchMedia("(pointer: coarse)").matches) this.#routing.focus();
  }

  showStats(): void {
    this.context.store.set({ stats: true });
  }

  toggleChanges(): boolean {
    this.#changes?.toggle();
    return this.#changes !== null;
  }

  help(): void {
    this.#help.open();
  }

  toggleTheme(): void {
    this.context.theme.toggle();
  }

  toggleDrive(): boolean {
    return this.#routing.drive.toggle();
  }

  async copyLink(): Promise<void> {
    try {
      await navigator.clipboard.writeText(location.href);
      toast("Link copied: it holds vehicle, filters, place and route.");
    } catch {
      toast("The address bar holds the link to what you see.");
    }
  }

  #click(under: Under | null, lon: number, lat: number): void {
    const { store } = this.context;
    const { route } = store.state;
    const id = under?.id ?? null;
    if (this.#maps.tracing) return;
    if (route && !complete(route)) this.#routing.take([lon, lat]);
    else if (under?.kind === "overview") this.#maps.approach(lon, lat);
    else if (!this.#routing.drive.under) {
      store.set({ selected: id });
      if (id) this.#maps.reveal(lon, lat);
    }
  }

  /** Selects a search result as a click would. Of a road the edge that the result names is selected, and the whole of it is shown. A place has a ring. */
  #search(hit: SearchHit): void {
    // Set first, so that the drawer is open when the map is fitted to the visible area.
    this.context.store.set({ selected: hit.kind === "place" ? null : hit.edge_id });
    this.#maps.fit(hit.bbox);
    // With the focus on the map, the arrow keys, + and − work.
    this.#maps.first.map.getCanvas().focus({ preventScroll: true });
    if (hit.kind === "edge") this.#whole.close();
    else void this.#whole.show(hit);
  }

  /** Chooses the longest edge of a changed road, and shows all that changed of it. */
  #goToChange({ edge_id, bbox }: ChangedRoad): void {
    if (innerWidth < 760) this.#side.close();
    this.context.store.set({ selected: edge_id });
    this.#maps.fit(bbox, 16);
  }

  /** The explanation tells of the change of its road, which may be known later than the explanation. */
  #changesKnown(): void {
    const { selected } = this.context.store.state;
    if (selected && this.#changes) void this.#explain.changesKnown(selected, question(this.context));
    this.#outlineGone();
  }

  /** A road that is gone has no explanation with a line, so its change tells the line. */
  #outlineGone(): void {
    const { selected } = this.context.store.state;
    if (selected && this.#changes?.of(selected)?.change === "went") this.#maps.outline(this.#changes.line(selected));
  }

  #place(explanation: Explanation | null, goTo: boolean): void {
    this.#maps.mark(explanation && explanation.verdict !== "forbidden" ? explanation.at : null);
    this.#maps.outline(explanation?.geometry?.coordinates ?? []);
    if (!goTo || !explanation) return;
    const { geometry, at } = explanation;
    const line = geometry?.coordinates;
    if (line && line.length > 0) {
      const [lons, lats] = [line.map(([lon]) => lon), line.map(([, lat]) => lat)];
      this.#maps.fit([Math.min(...lons), Math.min(...lats), Math.max(...lons), Math.max(...lats)], 17);
    } else if (at) {
      this.#maps.fit([...at, ...at], 17);
    }
  }

  #changed(changed: ReadonlySet<keyof State>, first = false): void {
    const { state } = this.context.store;
    const certificates = changed.has("vehicle") || changed.has("policy");
    const respelt = speakIn(unitsOf(this.context)) && !first;
    if (respelt) this.#respell();
    if (certificates || changed.has("other")) this.#number(changed.has("policy"));
    this.#side.draw(certificates);
    this.#maps.update(changed);
    this.#changes?.update(changed);
    this.#tools.draw();
    this.#welcome.draw();
    if (!first && (changed.has("selected") || changed.has("route"))) this.#welcome.end();
    if (changed.has("route") || ((certificates || changed.has("atMost")) && state.route)) this.#routing.update();
    const again = (certificates || respelt || changed.has("other")) && state.selected;
    if (changed.has("selected") || changed.has("route") || again) this.#select(first && !state.camera);
    if (changed.has("stats")) {
      if (state.stats) void this.#stats.open();
      else this.#stats.close();
    }
    this.#history.write(changed);
  }

  #select(goTo: boolean): void {
    const { state } = this.context.store;
    if (state.selected) {
      this.#drawer.show(this.#explain.element, state.route !== null);
      void this.#explain.show(state.selected, question(this.context), goTo);
      this.#outlineGone();
    } else {
      this.#explain.end();
      if (!this.#routing.present()) this.#drawer.hide();
    }
  }

  #number(policyChanged: boolean): void {
    const { policy, vehicle } = this.context.store.state;
    if (policyChanged || !this.#numbers) this.#numbers = this.#maps.first.drawn.then(() => api.stats(policy));
    this.#numbers
      .then((stats) => {
        const { state } = this.context.store;
        const of = (wanted: string | null) => stats.vehicles.find(({ id }) => id === wanted) ?? null;
        if (state.vehicle !== vehicle || state.policy !== stats.policy) return;
        this.#side.number(of(vehicle));
        this.#maps.number(of(state.other));
      })
      .catch((error: Error) => {
        this.#numbers = null;
        toast(error.message);
      });
  }

  /** Puts all words anew, because units are other ones. */
  #respell(): void {
    this.#side.respell();
    this.#routing.recolour();
    this.#number(false);
  }

  #recolour(): void {
    this.#side.draw(false);
    this.#maps.update(new Set());
    this.#changes?.update(new Set());
    this.#routing.recolour();
    this.#tools.draw();
  }
}
