// Nobody has to tell two verdicts apart by a hue that they cannot see. Deuteranopia and protanopia are simulated with the
// matrices of Viénot, Brettel and Mollon (1999) in linear sRGB; differences are ΔE of CIELAB (1976).

import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./support.mjs";

const { palettes } = await load("map/palette.ts");

const simulations = {
  normal: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  protanopia: [[0.11238, 0.88762, 0], [0.11238, 0.88762, 0], [0.00401, -0.00401, 1]],
  deuteranopia: [[0.29275, 0.70725, 0], [0.29275, 0.70725, 0], [-0.02234, 0.02234, 1]],
};

const linear = (hex) => [1, 3, 5].map((at) => {
  const c = Number.parseInt(hex.slice(at, at + 2), 16) / 255;
  return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
});

function lab(rgb) {
  const [r, g, b] = rgb.map((c) => Math.min(Math.max(c, 0), 1));
  const xyz = [(0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505, 0.2126 * r + 0.7152 * g + 0.0722 * b, (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089];
  const [x, y, z] = xyz.map((t) => (t > 0.008856 ? Math.cbrt(t) : 7.787 * t + 16 / 116));
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

const seen = (hex, matrix) => lab(matrix.map((row) => row.reduce((sum, part, i) => sum + part * linear(hex)[i], 0)));
const difference = (a, b, matrix) => Math.hypot(...seen(a, matrix).map((value, i) => value - seen(b, matrix)[i]));

for (const [theme, palette] of Object.entries(palettes)) {
  for (const [name, matrix] of Object.entries(simulations)) {
    test(`${theme}: room and missing stay apart under ${name}`, () => {
      for (const room of palette.room) {
        for (const missing of palette.missing) {
          const apart = difference(room, missing, matrix);
          assert.ok(apart > 20, `${room} and ${missing}: ΔE ${apart.toFixed(1)}`);
        }
      }
    });
    test(`${theme}: steps of one scale can be told apart under ${name}`, () => {
      for (const scale of [palette.room, palette.missing]) {
        for (let i = 0; i + 1 < scale.length; i++) {
          const apart = difference(scale[i], scale[i + 1], matrix);
          assert.ok(apart > 8, `${scale[i]} and ${scale[i + 1]}: ΔE ${apart.toFixed(1)}`);
        }
      }
    });
  }
  test(`${theme}: strips have colours of their own, whoever looks`, () => {
    const colours = [...Object.values(palette.strips), palette.noStrip, palette.forbidden, palette.unknown];
    for (const [name, matrix] of Object.entries(simulations)) {
      for (const own of [...Object.values(palette.strips), palette.noStrip]) {
        for (const colour of colours.filter((other) => other !== own)) {
          const apart = difference(own, colour, matrix);
          assert.ok(apart > 20, `${own} and ${colour} under ${name}: ΔE ${apart.toFixed(1)}`);
        }
        for (const [ground, least] of [[palette.paper, 25], [palette.wood, 20], [palette.water, 20]]) {
          const apart = difference(own, ground, simulations.normal);
          assert.ok(apart > least, `${own} on ${ground}: ΔE ${apart.toFixed(1)}`);
        }
      }
    }
  });
  test(`${theme}: a route under conditions has a colour that no road and no other route has, whoever looks`, () => {
    for (const [name, matrix] of Object.entries(simulations)) {
      for (const colour of [...palette.room, ...palette.missing, palette.forbidden, palette.unknown, palette.conditionalGap]) {
        const apart = difference(colour, palette.conditional, matrix);
        assert.ok(apart > 25, `${colour} and ${palette.conditional} under ${name}: ΔE ${apart.toFixed(1)}`);
      }
    }
  });
  test(`${theme}: roads that are new or gone have colours that no verdict has, whoever looks`, () => {
    // Hollow and short dashes set both apart from the lines of verdicts, too.
    for (const [name, matrix] of Object.entries(simulations)) {
      for (const [own, others] of [[palette.appeared, [palette.went, palette.alarm, palette.forbidden, palette.conditional, palette.paper]], [palette.went, [palette.alarm, palette.conditional, palette.unknown, palette.paper]]]) {
        for (const colour of others) {
          const apart = difference(own, colour, matrix);
          assert.ok(apart > 15, `${own} and ${colour} under ${name}: ΔE ${apart.toFixed(1)}`);
        }
      }
    }
  });
  test(`${theme}: what is chosen shines from under every line, whoever looks`, () => {
    for (const [name, matrix] of Object.entries(simulations)) {
      for (const colour of [palette.paper, ...palette.room, ...palette.missing, palette.forbidden, palette.unknown]) {
        const apart = difference(colour, palette.glow, matrix);
        assert.ok(apart > 25, `${colour} on ${palette.glow} under ${name}: ΔE ${apart.toFixed(1)}`);
      }
    }
  });
  test(`${theme}: every line stands out from the paper, and from woods and water on it`, () => {
    for (const colour of [...palette.room, ...palette.missing, palette.forbidden, palette.unknown]) {
      for (const [ground, least] of [[palette.paper, 25], [palette.wood, 20], [palette.water, 20]]) {
        const apart = difference(colour, ground, simulations.normal);
        assert.ok(apart > least, `${colour} on ${ground}: ΔE ${apart.toFixed(1)}`);
      }
    }
  });
}
