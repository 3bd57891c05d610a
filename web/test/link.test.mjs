// A link brings back what was seen; what it cannot mean is ignored.

import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./support.mjs";

const { read, write } = await load("link.ts");
const { beginning } = await load("state.ts");

const first = beginning("AU-SEMI19", "lane");
const possible = { vehicles: ["AU-SEMI19", "AU-ATRIPLE53"], policies: ["lane", "carriageway"], changes: true };

test("everything in a link comes back", () => {
  const state = {
    ...first,
    vehicle: "AU-ATRIPLE53",
    policy: "carriageway",
    other: "AU-SEMI19",
    colourBy: "evidence",
    hidden: new Set(["unsafe", "unknown"]),
    hiddenClasses: new Set(["service"]),
    evidence: "tagged",
    camera: { zoom: 12.5, lat: -36.75, lon: 144.25 },
    selected: "8103123456789012345",
    route: [[144.1, -36.7], [144.2, -36.8]],
    atMost: "carriageway",
    stats: true,
    changes: true,
    units: "feet",
  };
  assert.deepEqual(read(write(state, first), first, possible), state);
});

test("a route may rest on attested places, which are no policy", () => {
  assert.equal(read("#most=attested", first, possible).atMost, "attested");
  assert.equal(read("#most=direction", first, possible).atMost, null);
});

test("without an older database a link shows no changes", () => {
  assert.equal(read("#changes=1", first, { ...possible, changes: false }).changes, false);
  assert.deepEqual(read("#changes=yes", first, possible), first);
});

test("the first state is a short link", () => {
  assert.equal(write(first, first), "#v=AU-SEMI19");
  assert.deepEqual(read("", first, possible), first);
});

for (const hash of [
  "#v=nobody&policy=air&with=<script>&by=x&hide=all&without=y&width=z",
  "#id=12;drop table edge&at=1e999,0,0&route=1,2,3",
  "#at=,,&id=&route=NaN,1;2,3",
  "#at=3,95,10",
  "#units=furlongs",
  "#%E0%A4%A",
]) {
  test(`${hash} changes nothing`, () => assert.deepEqual(read(hash, first, possible), first));
}

test("a route may wait for its places", () => {
  assert.deepEqual(read("#route=", first, possible).route, [null, null]);
  assert.deepEqual(read("#route=144.1,-36.7", first, possible).route, [[144.1, -36.7], null]);
  const waiting = { ...first, route: [null, [144.1, -36.7], [144.2, -36.8]] };
  assert.deepEqual(read(write(waiting, first), first, possible), waiting);
});
