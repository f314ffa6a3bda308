// The page: one state, drawn anew when it changes.
import { bodyCanvas, fit } from "./body_canvas.js";
import { Scale } from "./colour.js";
import { read } from "./data.js";
import { $, announce, el, options } from "./dom.js";
import { components, degrees, notKnown, number, poles, thousands } from "./format.js";
import { barNumber, drawBar } from "./legend.js";
import { SphereMap } from "./map.js";
import { Model, fieldNames, frameOf, normals } from "./model.js";
import { numbers, showOrder, showSource } from "./numbers.js";
import { OrderSlider } from "./order.js";
import { angles, unit } from "./sphere.js";
import { showValues } from "./values.js";

const markStep = Math.PI / 36;

const state = { surface: null, shape: "xyz", component: "f_r", order: 0, mark: null };
let data, model, body, view, map, slider, onMesh;

function start() {
  data = read($("data").textContent);
  heading();
  theme();
  if (data.values) onMesh = showValues(data);
  if (data.surfaces.length > 0) bodies();
  else if (data.mesh?.vertices.length > 0 && !data.values) meshAlone();
  else {
    $("controls").hidden = true;
    $("stage").hidden = true;
  }
  numbers(data);
}

function heading() {
  const mesh = data.result.mesh ?? {};
  const name = String(mesh.name ?? "cowgpu report");
  $("title").textContent = name;
  document.title = `${name} - cowgpu`;
  const parts = [];
  if (mesh.faces !== undefined) parts.push(`${thousands(mesh.faces)} triangles`);
  if (data.surfaces.length > 0)
    parts.push(`expanded over the sphere to degree ${Math.max(...data.surfaces.map((s) => s.lmax))}`);
  if (data.mass) parts.push(`mass multipoles to degree ${data.mass.lmax}`);
  $("subtitle").textContent = parts.join(" \u00b7 ");
  $("footer").textContent =
    `${data.program.name} ${data.program.version}, ${data.created}. This file is complete: it loads nothing.`;
}

const lengthUnit = () => (typeof data.result.mesh?.placement?.metres_per_unit === "number" ? "m" : "mesh unit");
const unitOf = (component) => (components[component].unit === "angle" ? "rad" : lengthUnit());

function theme() {
  const choices = ["automatic", "light", "dark"];
  let at = 0;
  const show = () => {
    if (at === 0) delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = choices[at];
    $("theme").textContent = `Theme: ${choices[at]}`;
    redraw();
    onMesh?.theme();
  };
  $("theme").addEventListener("click", () => {
    at = (at + 1) % choices.length;
    show();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    redraw();
    onMesh?.theme();
  });
  show();
}

// ---- drawing, once a frame

const dirty = new Set();

/// Draws what changed: "shape" and "colour" recompute, "view" and "mark" only draw.
function redraw(...what) {
  if (!body) return;
  if (dirty.size === 0) requestAnimationFrame(frame);
  for (const part of what.length > 0 ? what : ["theme"]) dirty.add(part);
}

function frame() {
  const now = new Set(dirty);
  dirty.clear();
  if (now.has("theme")) body.theme();
  if (state.surface) {
    if (now.has("shape")) updateShape();
    if (now.has("shape") || now.has("colour")) updateColours();
    if (now.has("shape") || now.has("mark")) updateMark();
    if (!(now.size === 1 && now.has("view"))) map.draw();
  }
  body.draw(view);
}

function updateShape() {
  const positions = model.positions(state.surface, state.shape, state.order);
  state.positions = positions;
  state.normals = normals(positions, state.faces, state.normals);
  body.setShape(positions, state.normals);
  body.setLines($("graticule").checked ? graticule(positions) : null);
}

function updateColours() {
  const { surface, shape, component, order } = state;
  const values = model.values(surface, shape, component, order);
  const scale = new Scale(model.range(surface, shape, component, order), component === "distance");
  const indices = new Uint8Array(values.length);
  for (let i = 0; i < values.length; ++i) indices[i] = scale.index(values[i]);
  body.setColours(indices, scale.colours);
  map.setValues(values, scale);
  drawBar($("bar"), scale, `${components[component].label} (${unitOf(component)})`, barNumber);
}

let graticulePoints;

/// The lines of 30 degrees of the map, on the body.
function graticule(positions) {
  graticulePoints ??= graticuleDirections().map(([theta, phi]) => model.grid.about(theta, phi));
  const out = new Float32Array(3 * graticulePoints.length);
  graticulePoints.forEach((about, i) => {
    for (const [vertex, weight] of about) for (let c = 0; c < 3; ++c) out[3 * i + c] += weight * positions[3 * vertex + c];
  });
  return out;
}

function graticuleDirections() {
  const out = [];
  const steps = 2 * model.grid.rings;
  const line = (at) => {
    for (let k = 0; k < steps; ++k) out.push(at(k / steps), at((k + 1) / steps));
  };
  for (let m = 0; m < 12; ++m) line((t) => [Math.PI * t, (Math.PI * m) / 6]);
  for (let p = 1; p < 6; ++p) line((t) => [(Math.PI * p) / 6, 2 * Math.PI * t]);
  return out;
}

// ---- the point that is marked on both

function updateMark() {
  const { mark } = state;
  map.mark = mark;
  body.setMarker(mark ? model.grid.sample(state.positions, ...mark, 3) : null);
  $("readout").replaceChildren(
    ...(mark
      ? readout()
      : [el("div", { class: "quiet" }, "Point at the body or at the map: the same place is marked on both.")]),
  );
  $("readout").dataset.mark = mark ? mark.map((angle) => angle.toFixed(5)).join(" ") : "";
}

const pair = (name, value) => el("div", {}, el("dt", {}, name), el("dd", {}, value));

function valueAt(component) {
  const { surface, shape, order, mark } = state;
  return model.grid.sample(model.values(surface, shape, component, order), ...mark);
}

function readout() {
  const { surface, shape, mark, positions } = state;
  const point = model.grid.sample(positions, ...mark, 3);
  const rows = [
    pair("\u03b8, \u03c6", `${degrees(mark[0])}, ${degrees(mark[1])}`),
    pair(`point (${lengthUnit()})`, point.map((value) => number(value, 4)).join(", ")),
    ...["f_r", "f_dtheta", "f_dphi"].map((name) => pair(components[name].short, `${number(valueAt(name), 4)} ${unitOf(name)}`)),
  ];
  rows.push(
    pair("to the mesh", model.hasDistance(surface, shape) ? `${number(valueAt("distance"), 2)} ${lengthUnit()}` : notKnown),
  );
  return rows;
}

function setMark(mark) {
  state.mark = mark;
  redraw("mark");
}

function hoverBody(at) {
  if (!at) return setMark(null);
  const hit = body.pick(at);
  if (!hit) return setMark(null);
  const sum = [0, 0, 0];
  hit.corners.forEach((vertex, k) =>
    unit(...model.grid.angles(vertex)).forEach((value, c) => (sum[c] += hit.weights[k] * value)),
  );
  setMark(angles(sum));
}

function mapKeys(event) {
  const step = event.shiftKey ? markStep / 5 : markStep;
  const move = { ArrowUp: [-step, 0], ArrowDown: [step, 0], ArrowLeft: [0, -step], ArrowRight: [0, step], Escape: null }[
    event.key
  ];
  if (move === undefined) return;
  event.preventDefault();
  if (!move) return setMark(null);
  const [theta, phi] = state.mark ?? [Math.PI / 2, 0];
  const turn = 2 * Math.PI;
  setMark(
    state.mark ? [Math.min(Math.max(theta + move[0], 0), Math.PI), (((phi + move[1]) % turn) + turn) % turn] : [theta, phi],
  );
  clearTimeout(mapKeys.said);
  mapKeys.said = setTimeout(
    () =>
      state.mark &&
      announce(
        readout()
          .map((row) => [...row.children].map((part) => part.textContent).join(" "))
          .join("; "),
      ),
    350,
  );
}

// ---- order

/// Draws an order, and says what it is.
function drawOrder(order) {
  state.order = order;
  const whole = Math.round(order);
  const name = poles(data.order_names[whole] ?? "");
  const distance = order === whole ? model.distance(state.surface, state.shape, whole) : null;
  const from = Math.floor(order);
  const words = order === whole ? `order ${whole}${name ? `: to the ${name}` : ""}` : `between orders ${from} and ${from + 1}`;
  const numbers = distance && `${number(distance.rms, 3)} rms, ${number(distance.largest, 3)} at most (${lengthUnit()})`;
  $("order-name").textContent = words + (numbers ? ` \u00b7 distance to the mesh ${numbers}` : "");
  showOrder(order);
  redraw("shape");
  return words;
}

// ---- set-up

function chooseComponents() {
  const there = [...fieldNames, ...(model.hasDistance(state.surface, state.shape) ? ["distance"] : [])];
  if (!there.includes(state.component)) state.component = "f_r";
  options(
    $("component"),
    there.map((name) => [name, components[name].option]),
    state.component,
  );
}

function chooseSurface(name) {
  state.surface = data.surfaces.find((surface) => surface.name === name);
  if (!state.surface.signed_dphi) state.shape = "xyz";
  options(
    $("shape"),
    [["xyz", "x, y, z"], ...(state.surface.signed_dphi ? [["f", "f: distance and angles"]] : [])],
    state.shape,
  );
  chooseComponents();
  slider.setLargest(state.surface.order);
  body.frameAt(model.frame(state.surface, state.shape));
  slider.set(state.order);
}

function openBody(hover) {
  const opened = bodyCanvas(
    $("body"),
    $("body-panel"),
    "The body in three dimensions. Arrow keys turn it, plus and minus zoom, Home resets.",
    () => redraw("view"),
    hover,
  );
  ({ body, view } = opened);
  redraw("view");
}

function openMap() {
  const canvas = el("canvas", {
    tabindex: "0",
    role: "img",
    "aria-label":
      "The sphere of directions in Mollweide projection, longitude 0 in the middle. Arrow keys move the marked point, Escape removes it.",
  });
  $("map").append(canvas);
  map = new SphereMap(canvas, model.grid);
  let waiting = null;
  canvas.addEventListener("pointermove", (event) => {
    const box = canvas.getBoundingClientRect();
    waiting = [event.clientX - box.left, event.clientY - box.top];
    setMark(map.direction(...waiting));
  });
  canvas.addEventListener("pointerdown", (event) => {
    const box = canvas.getBoundingClientRect();
    setMark(map.direction(event.clientX - box.left, event.clientY - box.top));
  });
  canvas.addEventListener("pointerleave", () => document.activeElement !== canvas && setMark(null));
  canvas.addEventListener("keydown", mapKeys);
  fit($("map"), (width, height, ratio) => {
    map.resize(width, height, ratio);
    redraw("mark");
  });
}

/// The mesh's edges, each once, as pairs of points.
function edges({ vertices, faces }) {
  const seen = new Set();
  const out = [];
  const most = vertices.length / 3;
  for (let f = 0; f < faces.length; f += 3)
    for (let k = 0; k < 3; ++k) {
      const a = Math.min(faces[f + k], faces[f + ((k + 1) % 3)]);
      const b = Math.max(faces[f + k], faces[f + ((k + 1) % 3)]);
      if (seen.has(a * most + b)) continue;
      seen.add(a * most + b);
      out.push(...vertices.subarray(3 * a, 3 * a + 3), ...vertices.subarray(3 * b, 3 * b + 3));
    }
  return new Float32Array(out);
}

function bodies() {
  model = new Model(data);
  state.faces = model.grid.faces();
  openBody(hoverBody);
  body.setFaces(state.faces, model.grid.vertices);
  openMap();
  slider = new OrderSlider(drawOrder);
  options(
    $("surface"),
    data.surfaces.map((surface) => [surface.name, surface.name]),
    data.surfaces[0].name,
  );
  $("surface-choice").hidden = data.surfaces.length < 2;
  const meshThere = data.mesh?.vertices.length > 0;
  $("ghost-choice").hidden = !meshThere;
  let ghost = null;
  $("ghost").addEventListener("change", () => {
    ghost ??= edges(data.mesh);
    body.setGhost($("ghost").checked ? ghost : null);
    redraw("view");
  });
  $("graticule").addEventListener("change", () => {
    map.graticule = $("graticule").checked;
    redraw("shape");
  });
  $("surface").addEventListener("change", () => {
    chooseSurface($("surface").value);
    showSource(state.surface.name);
  });
  $("shape").addEventListener("change", () => {
    state.shape = $("shape").value;
    chooseComponents();
    body.frameAt(model.frame(state.surface, state.shape));
    slider.set(state.order);
  });
  $("component").addEventListener("change", () => {
    state.component = $("component").value;
    redraw("colour");
  });
  state.order = Math.min(7, data.surfaces[0].order);
  chooseSurface(data.surfaces[0].name);
}

/// A result without a surface, beside its mesh: the mesh is drawn.
function meshAlone() {
  $("controls").hidden = true;
  $("map-panel").hidden = true;
  const { vertices, faces } = data.mesh;
  openBody(() => {});
  body.setFaces(faces, vertices.length / 3);
  body.setShape(vertices, normals(vertices, faces));
  body.setColours(new Uint8Array(vertices.length / 3), Uint8Array.from([190, 170, 140]));
  body.frameAt(frameOf(vertices));
  redraw();
}

try {
  start();
} catch (error) {
  $("failure").hidden = false;
  $("failure").textContent = `This page could not be shown: ${error.message}`;
  console.error(error);
}
