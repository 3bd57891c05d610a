// A drawn aerial picture behind a WMS: grass, and one paved square.

import { createServer } from "node:http";
import { deflateSync } from "node:zlib";

const RADIUS_M = 6_378_137;

/** The Mercator coordinates of a place, metres. */
const mercator = ([lon, lat]) => [(RADIUS_M * lon * Math.PI) / 180, RADIUS_M * Math.log(Math.tan(Math.PI / 4 + (lat * Math.PI) / 360))];

function crc(bytes) {
  let value = ~0;
  for (const byte of bytes) {
    value ^= byte;
    for (let bit = 0; bit < 8; bit += 1) value = (value >>> 1) ^ (value & 1 ? 0xedb88320 : 0);
  }
  return ~value >>> 0;
}

function chunk(name, data) {
  const named = Buffer.concat([Buffer.from(name), data]);
  const [length, check] = [Buffer.alloc(4), Buffer.alloc(4)];
  length.writeUInt32BE(data.length);
  check.writeUInt32BE(crc(named));
  return Buffer.concat([length, named, check]);
}

/** A PNG of `size` pixels each way. `colour` gives red, green and blue of a pixel. */
function png(size, colour) {
  const head = Buffer.from([0, 0, 0, 0, 0, 0, 0, 0, 8, 2, 0, 0, 0]);
  head.writeUInt32BE(size, 0);
  head.writeUInt32BE(size, 4);
  const rows = Array.from({ length: size }, (_, y) => [0, ...Array.from({ length: size }, (_, x) => colour(x, y)).flat()]);
  return Buffer.concat([Buffer.from("\x89PNG\r\n\x1a\n", "latin1"), chunk("IHDR", head), chunk("IDAT", deflateSync(Buffer.from(rows.flat()))), chunk("IEND", Buffer.alloc(0))]);
}

/** Starts the service. `square` is the middle of what is paved, longitude and latitude, and half its side in metres; it may be set later. */
export async function orthophoto() {
  const photo = { square: null, asked: [] };
  const server = createServer((request, answer) => {
    const { searchParams } = new URL(request.url, "http://photo");
    const [west, south, east, north] = searchParams.get("bbox").split(",").map(Number);
    photo.asked.push(Object.fromEntries(searchParams));
    const size = Number(searchParams.get("width"));
    const paved = (x, y) => {
      if (!photo.square) return false;
      const { middle, half_m } = photo.square;
      const [lon, lat] = mercator(middle);
      const reach = half_m / Math.cos((middle[1] * Math.PI) / 180);
      return Math.abs(west + ((x + 0.5) / size) * (east - west) - lon) < reach && Math.abs(north - ((y + 0.5) / size) * (north - south) - lat) < reach;
    };
    answer.writeHead(200, { "content-type": "image/png", "access-control-allow-origin": "*" });
    answer.end(png(size, (x, y) => (paved(x, y) ? [120, 120, 124] : [70, 110, 60])));
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  const at = `http://127.0.0.1:${server.address().port}`;
  const close = () => {
    server.close();
    server.closeAllConnections();
  };
  const template = `${at}/wms?service=WMS&version=1.3.0&request=GetMap&layers=aerial&styles=&crs=EPSG:3857&width=256&height=256&format=image/png&bbox={bbox-epsg-3857}`;
  return Object.assign(photo, { at, template, close });
}
