// For development: builds on change, serves `dist` and passes everything else on to a running `netcert serve`.
//
//     node dev.mjs http://127.0.0.1:8080 [PORT]

import { spawn } from "node:child_process";
import { watch } from "node:fs";
import { readFile } from "node:fs/promises";
import { createServer, request } from "node:http";
import { dirname, extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const target = new URL(process.argv[2] ?? "http://127.0.0.1:8080");
const port = Number(process.argv[3] ?? 5173);
const types = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript",
  ".css": "text/css",
  ".svg": "image/svg+xml",
  ".woff2": "font/woff2",
  ".txt": "text/plain; charset=utf-8",
};

let building = Promise.resolve();
function rebuild() {
  building = new Promise((done) => {
    spawn(process.execPath, [join(here, "build.mjs")], { stdio: "inherit" }).on("exit", done);
  });
}
rebuild();
let timer;
for (const folder of ["src", "index.html"]) {
  watch(join(here, folder), { recursive: true }, () => {
    clearTimeout(timer);
    timer = setTimeout(rebuild, 100);
  });
}

createServer(async (incoming, outgoing) => {
  await building;
  const { pathname } = new URL(incoming.url, "http://page");
  const name = pathname === "/" ? "/index.html" : normalize(pathname);
  const file = await readFile(join(here, "dist", name)).catch(() => null);
  if (file) {
    outgoing.writeHead(200, { "content-type": types[extname(name)] ?? "application/octet-stream" });
    outgoing.end(file);
    return;
  }
  const headers = { ...incoming.headers, host: target.host };
  const passed = request(new URL(incoming.url, target), { method: incoming.method, headers }, (answer) => {
    outgoing.writeHead(answer.statusCode, answer.headers);
    answer.pipe(outgoing);
  });
  passed.on("error", (error) => outgoing.writeHead(502).end(String(error)));
  incoming.pipe(passed);
}).listen(port, "127.0.0.1", () => console.log(`http://127.0.0.1:${port} → ${target.href}`));
