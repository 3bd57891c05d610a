// Forty routes at a time, more than the server takes at once: by what the page does with 503, all are answered in the end.

import assert from "node:assert/strict";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { demoDatabase, program } from "./databases.mjs";
import { load, serve } from "./support.mjs";

const ROUTES = 40;
const { patient } = await load("api/patient.ts");

test("forty routes at a time are all answered", { skip: program ? false : "no netcert program" }, async () => {
  const folder = mkdtempSync(join(tmpdir(), "netcert-load-"));
  const server = await serve(demoDatabase(folder));
  let refused = 0;
  const counting = globalThis.fetch;
  globalThis.fetch = async (...asked) => {
    const answer = await counting(...asked);
    if (answer.status === 503) refused += 1;
    return answer;
  };
  try {
    const region = await (await patient(`${server.direct}/api/region`)).json();
    const [west, south, east, north] = region.focus ?? region.bbox;
    const place = (x, y) => `${(west + x * (east - west)).toFixed(6)},${(south + y * (north - south)).toFixed(6)}`;
    const question = (n) => `vehicle=AU-SEMI19&from=${place(0.3 + n / 200, 0.4)}&to=${place(0.6, 0.3 + n / 150)}&snap=5000&conditions=none`;
    const begin = Date.now();
    const all = await Promise.all(Array.from({ length: ROUTES }, (_, n) => patient(`${server.direct}/api/route?${question(n)}`)));
    const statuses = all.map((answer) => answer.status);
    console.log(`${ROUTES} routes at a time: ${refused} refusals, all answered after ${Date.now() - begin} ms`);
    assert.deepEqual([...new Set(statuses)], [200]);
    assert.ok(refused > 0, "the queue was never full, so nothing was tested");
  } finally {
    globalThis.fetch = counting;
    await server.stop();
    rmSync(folder, { recursive: true, force: true });
  }
});
