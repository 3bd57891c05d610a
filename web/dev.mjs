// For development: builds on change and shows the page over a running `netcert serve`.
//
//     node dev.mjs http://127.0.0.1:8080 [PORT]

import { spawn } from "node:child_process";
import { watch } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { proxy } from "./tools/proxy.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const target = process.argv[2] ?? "http://127.0.0.1:8080";
const port = Number(process.argv[3] ?? 5173);

let building = Promise.resolve();
function rebuild() {
  building = new Promise((done) => {
    spawn(process.execPath, [join(here, "build.mjs")], { stdio: "inherit" }).on("exit", done);
  });
}
rebuild();
let timer;
for (const place of ["src", "index.html"]) {
  watch(join(here, place), { recursive: true }, () => {
    clearTimeout(timer);
    timer = setTimeout(rebuild, 100);
  });
}
await proxy(target, port, () => building);
console.log(`http://127.0.0.1:${port} → ${target}`);
