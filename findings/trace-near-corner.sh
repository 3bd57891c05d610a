#!/usr/bin/env bash
# terra-draw closes a polygon when a corner is clicked within 40 pixels of the corner before it, and drops the corner that was clicked.
# A good guess is that only a click on the first corner, or on the last one again, closes the polygon.
#
# Behaviour (terra-draw 1.35.0, `TerraDrawPolygonMode` with its default options): from the third corner on, a click counts as one on the last
# corner if it is nearer than `pointerDistance`, which is 40 pixels. The polygon then ends at the last corner. With `pointerDistance: 10` the same
# clicks draw all corners.
#
# Output seen on 2026-11-30:
#   40 pixels (default): closed by click 4 of 5, with 3 corners
#   10 pixels: open after 5 clicks
#
# Needs Node 20 or newer with npm. Fails if the behaviour is another one.
#
# Users of netcert trace kerbs, whose corners lie closer together than that. The page sets 10 pixels.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
echo '{"private": true, "type": "module"}' >package.json
npm install --silent --ignore-scripts --no-audit --no-fund terra-draw@1.35.0
cat >clicks.js <<'JS'
import { TerraDraw, TerraDrawExtend, TerraDrawPolygonMode } from "terra-draw";

/** A map without a browser: a degree is a million pixels. */
class Plane extends TerraDrawExtend.TerraDrawBaseAdapter {
  register(callbacks) {
    this.callbacks = callbacks;
    callbacks.onReady?.();
  }
  unregister() {}
  getMapEventElement() {
    return { addEventListener() {}, removeEventListener() {} };
  }
  getLngLatFromEvent() {
    return null;
  }
  project(lng, lat) {
    return { x: lng * 1e6, y: -lat * 1e6 };
  }
  unproject(x, y) {
    return { lng: x / 1e6, lat: -y / 1e6 };
  }
  setCursor() {}
  setDoubleClickToZoom() {}
  setDraggability() {}
  render() {}
  clear() {}
  click(x, y) {
    const event = { ...this.unproject(x, y), containerX: x, containerY: y, button: "left", heldKeys: [], isContextMenu: false };
    this.callbacks.onMouseMove(event);
    this.callbacks.onClick(event);
  }
}

// The fourth corner is 32 pixels from the third.
const clicks = [[0, 0], [200, 0], [200, 200], [170, 210], [0, 200]];

function told(options) {
  const plane = new Plane({});
  const draw = new TerraDraw({ adapter: plane, modes: [new TerraDrawPolygonMode(options)] });
  let closed = null;
  draw.on("finish", (id) => (closed = draw.getSnapshotFeature(id)));
  draw.start();
  draw.setMode("polygon");
  for (const [number, [x, y]] of clicks.entries()) {
    plane.click(x, y);
    if (closed) return `closed by click ${number + 1} of ${clicks.length}, with ${closed.geometry.coordinates[0].length - 1} corners`;
  }
  return `open after ${clicks.length} clicks`;
}

console.log(`40 pixels (default): ${told({})}`);
console.log(`10 pixels: ${told({ pointerDistance: 10 })}`);
JS
node clicks.js | tee seen
diff seen - <<'SEEN'
40 pixels (default): closed by click 4 of 5, with 3 corners
10 pixels: open after 5 clicks
SEEN
