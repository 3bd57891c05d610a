// Builds the page into `dist`: the same bytes from the same sources and lock file, on any machine.
//
// Names carry a hash of their content, so that a browser may keep them for ever; `index.html` alone is always asked for.
// No source maps: the build is committed and becomes part of the program.

import { createHash } from "node:crypto";
import { mkdir, readFile, rm, writeFile } from "node:fs/promises";
import { basename, dirname, extname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const out = join(here, "dist");
const maplibre = join(here, "node_modules/maplibre-gl/dist");

/** `name-HASH.ext` in `dist/assets`; returns its path from the page. */
async function asset(name, bytes) {
  const hash = createHash("sha256").update(bytes).digest("hex").slice(0, 10);
  const path = `assets/${basename(name, extname(name))}-${hash}${extname(name)}`;
  await writeFile(join(out, path), bytes);
  return `/${path}`;
}

async function bundle(entry, options) {
  const result = await build({
    entryPoints: [join(here, entry)],
    bundle: true,
    minify: true,
    format: "esm",
    target: ["chrome120", "firefox121", "safari17"],
    legalComments: "none",
    charset: "utf8",
    write: false,
    outdir: out,
    absWorkingDir: here,
    ...options,
  });
  return result.outputFiles;
}

await rm(out, { recursive: true, force: true });
await mkdir(join(out, "assets"), { recursive: true });

// MapLibre's worker is a module of its own; the page is told its name (the policy allows scripts of this origin only).
const worker = await asset("maplibre-worker.js", await readFile(join(maplibre, "maplibre-gl-worker.mjs")));

const fonts = new Map();
const styles = await bundle("src/styles/page.css", {
  loader: { ".woff2": "file" },
  assetNames: "assets/[name]-[hash]",
  publicPath: "/",
});
for (const file of styles) {
  if (file.path.endsWith(".woff2")) {
    fonts.set(basename(file.path), true);
    await writeFile(join(out, "assets", basename(file.path)), file.contents);
  }
}
const css = await asset("page.css", styles.find((file) => file.path.endsWith(".css")).contents);

// What traces areas is loaded when somebody traces.
const tracer = await asset("trace.js", (await bundle("src/trace/trace.ts", {}))[0].contents);
const script = await bundle("src/main.ts", { define: { WORKER_URL: JSON.stringify(worker), TRACE_URL: JSON.stringify(tracer) }, external: [tracer] });
const js = await asset("page.js", script[0].contents);

const html = (await readFile(join(here, "index.html"), "utf8")).replace("%CSS%", css).replace("%JS%", js);
await writeFile(join(out, "index.html"), html);
await writeFile(join(out, "favicon.svg"), await readFile(join(here, "favicon.svg")));
await writeFile(join(out, "licences.txt"), await licences());

/** What is bundled, and under which terms. */
async function licences() {
  const installed = (name) => join(here, "node_modules", name);
  const part = async (name, file) => {
    const { version } = JSON.parse(await readFile(join(installed(name), "package.json"), "utf8"));
    return `${name} ${version}\n\n${(await readFile(file, "utf8")).trim()}\n`;
  };
  // Its packages name the licence and have no text of it.
  const terraDraw = join(here, "licences/terra-draw.txt");
  const all = [
    await part("maplibre-gl", join(installed("maplibre-gl"), "LICENSE.txt")),
    await part("@fontsource-variable/inter", join(installed("@fontsource-variable/inter"), "LICENSE")),
    await part("terra-draw", terraDraw),
    await part("terra-draw-maplibre-gl-adapter", terraDraw),
  ];
  return all.join(`\n${"-".repeat(80)}\n\n`);
}
