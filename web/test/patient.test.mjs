// A server that is busy is asked again when it says, a few times, and not after the reader has gone on.

import assert from "node:assert/strict";
import { createServer } from "node:http";
import { after, before, beforeEach, test } from "node:test";
import { load } from "./support.mjs";

const { patient } = await load("api/patient.ts");

/** Answers with 503 so many times, then with 200; remembers when it was asked. */
let busy = 0;
let retryAfter = "1";
let asked = [];
const server = createServer((_, response) => {
  asked.push(Date.now());
  const refuse = asked.length <= busy;
  response.writeHead(refuse ? 503 : 200, refuse && retryAfter !== null ? { "retry-after": retryAfter } : {});
  response.end("said");
});
let url;
before(async () => {
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  url = `http://127.0.0.1:${server.address().port}/`;
});
after(() => server.close());
beforeEach(() => {
  [busy, retryAfter, asked] = [0, "1", []];
});

test("what is answered is asked once", async () => {
  assert.equal(await (await patient(url)).text(), "said");
  assert.equal(asked.length, 1);
});

test("after a 503 it waits as long as the server says, and asks again", async () => {
  busy = 1;
  assert.equal((await patient(url)).status, 200);
  assert.equal(asked.length, 2);
  assert.ok(asked[1] - asked[0] >= 990, `${asked[1] - asked[0]} ms`);
});

test("a date is a time to wait for, too", async () => {
  busy = 1;
  retryAfter = new Date(Date.now() + 2500).toUTCString(); // to the second: 1.5 s at least
  assert.equal((await patient(url)).status, 200);
  assert.ok(asked[1] - asked[0] >= 1400, `${asked[1] - asked[0]} ms`);
});

test("it does not ask for ever", async () => {
  [busy, retryAfter] = [100, "0"];
  const answer = await patient(url);
  assert.deepEqual([answer.status, await answer.text(), asked.length], [503, "said", 8]);
});

for (const [name, header] of [["no time", null], ["a time that is none", "soon"], ["too long a time", "3600"]]) {
  test(`with ${name} the refusal is told at once`, async () => {
    [busy, retryAfter] = [100, header];
    const answer = await patient(url);
    assert.deepEqual([answer.status, asked.length], [503, 1]);
  });
}

test("whoever gives up while it waits is asked no more", async () => {
  [busy, retryAfter] = [100, "5"];
  const giving = new AbortController();
  const answer = patient(url, { signal: giving.signal });
  setTimeout(() => giving.abort(), 200);
  const begin = Date.now();
  await assert.rejects(answer, { name: "AbortError" });
  assert.ok(Date.now() - begin < 2000 && asked.length === 1);
});
