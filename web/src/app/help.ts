// The help dialog: the meaning of the map, and the keys.

import { Dialog } from "../ui/dialog.ts";
import { h } from "../ui/dom.ts";
import { changeLine } from "../panel/changes.ts";
import { CHANGES, VERDICTS, changeWords, routeWords, verdictWords } from "../words.ts";
import { keys } from "./keys.ts";

export class HelpDialog {
  readonly #dialog = new Dialog("help", "How to read this map");

  /** `changes` says whether there is an older database. */
  constructor(changes: boolean) {
    const verdicts = VERDICTS.map((name) =>
      h("div", {}, h("dt", {}, h("i", { class: `line line-${name}` }), verdictWords[name].name), h("dd", {}, verdictWords[name].meaning)),
    );
    const routes = Object.entries(routeWords).map(([kind, text]) => h("div", {}, h("dt", {}, h("i", { class: `line line-${kind}` }), "Route"), h("dd", {}, text)));
    const kinds = CHANGES.map((name) => h("div", {}, h("dt", {}, changeLine(name), changeWords[name].name), h("dd", {}, changeWords[name].meaning)));
    const since = changes ? [h("h3", {}, "Changes since the older database"), h("dl", { class: "meanings" }, ...kinds)] : [];
    const rows = keys.filter(([key]) => changes || key !== "S").map(([key, does]) => h("div", {}, h("dt", {}, h("kbd", {}, key)), h("dd", {}, does)));
    this.#dialog.body.append(
      h(
        "p",
        {},
        "Every line is one direction of a road, drawn on the side on which it is driven. Certified means: driven forward, with the errors of steering and of every axle within their stated bounds, no part of the combination leaves the strip of road that it may use. The margin says by how much; where it is negative, so much is missing.",
      ),
      h("dl", { class: "meanings" }, ...verdicts, ...routes),
      h("p", {}, "A certificate is worth no more than the width that it rests on: colour by evidence to see where widths come from. Bridges, loads, crests and what the map does not know are not in it. No permit comes from this page: an authority gives it."),
      ...since,
      h("h3", {}, "Keys"),
      h("dl", { class: "keys" }, ...rows),
    );
  }

  open(): void {
    this.#dialog.open();
  }
}
