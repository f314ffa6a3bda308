// The page's own synthesis against `cowgpu reconstruct`, and its tables' order.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { read } from "../src/data.js";
import { Model, fieldNames } from "../src/model.js";
import { SphereGrid, angles, unit } from "../src/sphere.js";
import { legendre } from "../src/synthesis.js";
import { compare } from "../src/table.js";
import { dataOf, file, json, run, text } from "./support.mjs";

run("expand", "builtin:cow@1", "--of", "mass,stretch", "--lmax", "20", "-q", "-o", file("cow.json"));
run("report", file("cow.json"), "--mesh", "builtin:cow@1", "-q", "-o", file("cow.html"));
const data = read(dataOf(text("cow.html")));
const model = new Model(data);
const [surface] = data.surfaces;

/// Vertices of a binary little-endian PLY file.
function plyVertices(path) {
  const bytes = readFileSync(path);
  const end = bytes.indexOf("end_header\n") + "end_header\n".length;
  const header = bytes.toString("latin1", 0, end);
  assert.match(header, /format binary_little_endian/);
  const count = Number(header.match(/element vertex (\d+)/)[1]);
  const sizes = { double: 8, float: 4, int: 4, uint: 4, uchar: 1 };
  const properties = [...header.split(/element face/)[0].matchAll(/property (\w+) (\w+)/g)].map(([, type, name]) => ({
    type,
    name,
  }));
  const stride = properties.reduce((sum, { type }) => sum + sizes[type], 0);
  const out = new Float64Array(3 * count);
  let offset = end;
  for (const { type, name } of properties) {
    const c = ["x", "y", "z"].indexOf(name);
    if (c >= 0)
      for (let i = 0; i < count; ++i)
        out[3 * i + c] = type === "double" ? bytes.readDoubleLE(offset + i * stride) : bytes.readFloatLE(offset + i * stride);
    offset += sizes[type];
  }
  return out;
}

test("bodies of every order and both kinds of fields are the program's", () => {
  const resolution = (data.grid.rings - 1) / 2;
  for (const fields of ["xyz", "f"]) {
    run(
      "reconstruct",
      file("cow.json"),
      "--fields",
      fields,
      "--order",
      "0,1,7,20",
      "--resolution",
      String(resolution),
      "-q",
      "-o",
      file(`${fields}-{}.ply`),
    );
    for (const order of [0, 1, 7, 20]) {
      const here = model.bodyAt(surface, fields, order);
      const there = plyVertices(file(`${fields}-${order}.ply`));
      assert.equal(here.length, there.length);
      let worst = 0;
      for (let i = 0; i < here.length; ++i) worst = Math.max(worst, Math.abs(here[i] - there[i]));
      // Floats of size 1, angles near pi among them: a few of their last digits, 6e-8.
      assert.ok(worst < 5e-7, `${fields}, order ${order}: ${worst}`);
    }
  }
});

test("coefficients are those of the result, bit for bit", () => {
  const { coefficients } = json("cow.json").expansions.stretch;
  const count = coefficients.length;
  for (const [l, m, ...numbers] of coefficients) {
    const at = (m * (2 * surface.order + 1 - m)) / 2 + l;
    fieldNames.forEach((name, f) => {
      assert.equal(surface.coefficients[2 * (f * count + at)], numbers[2 * f], `${name} ${l} ${m}`);
      assert.equal(surface.coefficients[2 * (f * count + at) + 1], numbers[2 * f + 1], `${name} ${l} ${m}`);
    });
  }
  for (const [l, m, re, im] of json("cow.json").expansions.mass.coefficients) {
    const at = (m * (2 * data.mass.order + 1 - m)) / 2 + l;
    assert.deepEqual([data.mass.coefficients[2 * at], data.mass.coefficients[2 * at + 1]], [re, im]);
  }
});

test("Legendre functions are orthonormal and have the closed forms of low degree", () => {
  const theta = 0.7;
  const p = legendre(3, theta);
  const [c, s] = [Math.cos(theta), Math.sin(theta)];
  const closed = [
    Math.sqrt(1 / (4 * Math.PI)),
    Math.sqrt(3 / (4 * Math.PI)) * c,
    Math.sqrt(5 / (16 * Math.PI)) * (3 * c * c - 1),
  ];
  closed.forEach((value, l) => assert.ok(Math.abs(p[l] - value) < 1e-15));
  assert.ok(Math.abs(p[4] + Math.sqrt(3 / (8 * Math.PI)) * s) < 1e-15); // Y_11 is negative: Condon-Shortley
  let sum = 0; // of |P_3m|^2 over all m: (2 l + 1) / (4 pi), Unsoeld's theorem
  for (let m = 0; m <= 3; ++m) sum += (m === 0 ? 1 : 2) * p[(m * (7 - m)) / 2 + 3] ** 2;
  assert.ok(Math.abs(sum - 7 / (4 * Math.PI)) < 1e-14);
});

test("between two orders the body is between theirs, and whole orders are themselves", () => {
  const low = model.bodyAt(surface, "xyz", 3);
  const high = model.bodyAt(surface, "xyz", 4);
  const middle = model.positions(surface, "xyz", 3.25);
  for (let i = 0; i < low.length; i += 97) assert.ok(Math.abs(middle[i] - (0.75 * low[i] + 0.25 * high[i])) < 1e-6);
  assert.equal(model.positions(surface, "xyz", 4), high);
});

test("distances fall with the order and are there for all", () => {
  for (const shape of ["xyz", "f"]) {
    assert.equal(surface.distances[shape].length, surface.order + 1);
    assert.ok(surface.distances[shape][20].rms < surface.distances[shape][7].rms / 2);
    assert.ok(surface.distances[shape][7].rms < surface.distances[shape][0].rms / 2);
  }
});

test("a grid finds its own vertices, and directions go there and back", () => {
  const grid = new SphereGrid(9, 16);
  assert.equal(grid.faces().length / 3, 2 * (grid.vertices - 2));
  for (let vertex = 0; vertex < grid.vertices; ++vertex) {
    const values = new Float32Array(grid.vertices);
    values[vertex] = 1;
    const [theta, phi] = grid.angles(vertex);
    assert.ok(Math.abs(grid.sample(values, theta, phi) - 1) < 1e-12, `vertex ${vertex}`);
    const [there, round] = angles(unit(theta, phi));
    assert.ok(Math.abs(there - theta) < 1e-12);
    if (vertex > 0 && vertex + 1 < grid.vertices) assert.ok(Math.abs(Math.sin((round - phi) / 2)) < 1e-12);
  }
});

test("tables sort numbers by size, words with their numbers, and what is not known last", () => {
  const sorted = (values, down) => [...values].sort((a, b) => compare(a, b, down));
  assert.deepEqual(sorted([3, null, -1, 20], false), [-1, 3, 20, null]);
  assert.deepEqual(sorted([3, NaN, -1, 20], true), [20, 3, -1, NaN]);
  assert.deepEqual(sorted(["order 10", "order 9"], false), ["order 9", "order 10"]);
});
