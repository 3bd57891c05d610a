// The databases of the drawn region that the page's tests open. Each is made once for a program and copied from then on.
//
// Environment: NETCERT the program, NETCERT_TEST_DB a database instead of the drawn region's.

import { execFileSync } from "node:child_process";
import { createHash } from "node:crypto";
import { copyFileSync, cpSync, existsSync, mkdirSync, mkdtempSync, readFileSync, renameSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = fileURLToPath(import.meta.url);
export const root = join(dirname(here), "../..");
export const first = (paths) => paths.find((path) => path && existsSync(path));
export const program = first([process.env.NETCERT, join(root, "target/release/netcert"), join(root, "target/debug/netcert")]);

const extract = join(root, "data/demo.osm.pbf");
const vehicles = ["--vehicle", "AU-SEMI19", "--vehicle", "AU-ATRIPLE53"];
const run = (...args) => execFileSync(program, ["--quiet", ...args], { stdio: ["ignore", "ignore", "inherit"] });

/** Where databases lie that this program has made of these inputs: the name is a hash of what their bytes follow from. */
function kept() {
  const hash = createHash("sha256");
  for (const path of [program, extract, here]) hash.update(readFileSync(path));
  return join(root, "target/fixtures", hash.digest("hex").slice(0, 16));
}

/** Copies into `folder` what `make` writes. `make` runs once for a program: it writes beside, and the whole is renamed. */
function copyOf(name, folder, make) {
  const all = kept();
  const whole = join(all, name);
  if (!existsSync(whole)) {
    // Those of older programs are of no use any more.
    if (!existsSync(all)) rmSync(dirname(all), { recursive: true, force: true });
    mkdirSync(all, { recursive: true });
    const made = mkdtempSync(join(all, `${name}-`));
    make(made);
    // Another process may have been faster. Its files are the same.
    if (!existsSync(whole)) renameSync(made, whole);
    else rmSync(made, { recursive: true });
  }
  cpSync(whole, folder, { recursive: true });
}

/** The drawn region, certified for two vehicles under two policies. */
export function demoDatabase(folder) {
  if (process.env.NETCERT_TEST_DB) return process.env.NETCERT_TEST_DB;
  copyOf("demo", folder, (made) => {
    const db = join(made, "demo.gpkg");
    run("ingest", extract, "--db", db, ...vehicles);
    run("certify", "--db", db, ...vehicles, "--corridor", "carriageway", "--needs", "all");
  });
  return join(folder, "demo.gpkg");
}

/**
 * Two databases of the drawn region, `old.gpkg` and `new.gpkg`: in the newer one a road is measured narrower and another one wider, a
 * third one has a limit of weight, a fourth one is gone, and there is a new one. The newer one has a lake and a town, too.
 */
export function twoDatabases(folder) {
  copyOf("two", folder, makeTwoDatabases);
  const [before, db] = ["old.gpkg", "new.gpkg"].map((name) => join(folder, name));
  return { before, db };
}

function makeTwoDatabases(folder) {
  const [before, db] = ["old.gpkg", "new.gpkg"].map((name) => join(folder, name));
  run("ingest", extract, "--db", before, ...vehicles);
  copyFileSync(before, db);
  const measured = ["quantity,value,unit,way_id,source", "carriageway_width,5.4,m,15,tape", "carriageway_width,9,m,57,tape", "max_weight,12,t,36,sign"];
  writeFileSync(join(folder, "measured.csv"), measured.join("\n"));
  run("evidence", "add", join(folder, "measured.csv"), "--db", db);
  const gone = '<delete><way id="49" version="99"/></delete>';
  const node = '<node id="900001" version="1" lat="-30.2" lon="126.06"/>';
  const way = '<way id="900002" version="1"><nd ref="158"/><nd ref="900001"/><tag k="highway" v="primary"/><tag k="width" v="12"/><tag k="name" v="New Ring Road"/></way>';
  const shore = Array.from({ length: 24 }, (_, k) => {
    const [angle, reach] = [(2 * Math.PI * k) / 24, 1 + 0.15 * Math.sin(k * 1.7)];
    return [126.02 + 0.02 * reach * Math.cos(angle), -30.226 + 0.007 * reach * Math.sin(angle)];
  }).map(([lon, lat], k) => `<node id="${900010 + k}" version="1" lat="${lat.toFixed(7)}" lon="${lon.toFixed(7)}"/>`);
  const round = [...shore.keys(), 0].map((k) => `<nd ref="${900010 + k}"/>`).join("");
  const lake = `${shore.join("")}<way id="900050" version="1">${round}<tag k="natural" v="water"/></way>`;
  const town = '<node id="900060" version="1" lat="-30.215" lon="126"><tag k="place" v="town"/><tag k="name" v="Laketon"/></node>';
  writeFileSync(join(folder, "later.osc"), `<osmChange version="0.6">${gone}<create>${node}${way}${lake}${town}</create></osmChange>`);
  run("update", "--db", db, join(folder, "later.osc"), "--extract", extract);
}
