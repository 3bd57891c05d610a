// Serves `dist` as it lies on the disk, and passes everything else on to a running `netcert serve`: the page without
// building the program anew. Answers carry the program's own security headers.

import { readFile } from "node:fs/promises";
import { createServer, request } from "node:http";
import { dirname, extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";

const dist = join(dirname(fileURLToPath(import.meta.url)), "../dist");
const types = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript",
  ".css": "text/css",
  ".svg": "image/svg+xml",
  ".woff2": "font/woff2",
  ".txt": "text/plain; charset=utf-8",
};

/** Listens on `port` of loopback (0: any) once `ready` allows; returns the server. */
export async function proxy(target, port, ready = () => Promise.resolve()) {
  const headers = Object.fromEntries((await fetch(target)).headers);
  const security = { "content-security-policy": headers["content-security-policy"] ?? "", "x-content-type-options": "nosniff" };
  const { host, hostname, port: to } = new URL(target);
  const server = createServer(async (incoming, outgoing) => {
    await ready();
    const { pathname } = new URL(incoming.url, "http://page");
    const name = pathname === "/" ? "/index.html" : normalize(pathname);
    const file = await readFile(join(dist, name)).catch(() => null);
    if (file) {
      outgoing.writeHead(200, { ...security, "content-type": types[extname(name)] ?? "application/octet-stream" });
      outgoing.end(file);
      return;
    }
    // The server must take this page for its own.
    const own = incoming.headers.origin === `http://${incoming.headers.host}` ? { origin: `http://${host}` } : {};
    const passed = request(
      { hostname, port: to, path: incoming.url, method: incoming.method, headers: { ...incoming.headers, ...own, host } },
      (answer) => {
        outgoing.writeHead(answer.statusCode, answer.headers);
        answer.pipe(outgoing);
      },
    );
    passed.on("error", (error) => outgoing.writeHead(502).end(String(error)));
    incoming.pipe(passed);
  });
  await new Promise((done) => server.listen(port, "127.0.0.1", done));
  return server;
}
