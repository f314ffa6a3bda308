// The page: one state, drawn anew when it changes.
import { SoftwareBody } from "./body_software.js";
import { WebglBody } from "./body_webgl.js";
import { Scale } from "./colour.js";
import { read } from "./data.js";
import { coefficientTable, findings, provenance } from "./documents.js";
import { $, announce, el, reducedMotion } from "./dom.js";
import { components, degrees, fixed, notKnown, number, poles, thousands } from "./format.js";
import { barNumber, drawBar } from "./legend.js";
import { SphereMap } from "./map.js";
import { Model, fieldNames, frameOf, normals } from "./model.js";
import { angles, unit } from "./sphere.js";
import { drawSpectrum, quantities } from "./spectra.js";
import { makeTabs } from "./tabs.js";
import { View } from "./view.js";

const sweepSeconds = 12; // of "play", all orders
const stepMilliseconds = 700; // of one order where motion is not welcome
const markStep = Math.PI / 36;

const state = { surface: null, shape: "xyz", component: "f_r", order: 0, mark: null, playing: false };
let data, model, body, view, map, tabs, spectrum;

function start() {
  data = read($("data").textContent);
  heading();
  theme();
  if (data.surfaces.length > 0) bodies();
  else if (data.mesh?.vertices.length > 0) meshAlone();
  else {
    $("controls").hidden = true;
    document.querySelector(".stage").hidden = true;
  }
  numbers();
}

function heading() {
  const mesh = data.result.mesh ?? {};
  const name = String(mesh.name ?? "cowgpu report");
  $("title").textContent = name;
  document.title = `${name} - cowgpu`;
  const parts = [];
  if (mesh.faces !== undefined) parts.push(`${thousands(mesh.faces)} triangles`);
  if (data.surfaces.length > 0) parts.push(`expanded over the sphere to degree ${Math.max(...data.surfaces.map((s) => s.lmax))}`);
  if (data.mass) parts.push(`mass multipoles to degree ${data.mass.lmax}`);
  $("subtitle").textContent = parts.join(" \u00b7 ");
  $("footer").textContent = `${data.program.name} ${data.program.version}, ${data.created}. This file is complete: it loads nothing.`;
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
  };
  $("theme").addEventListener("click", () => {
    at = (at + 1) % choices.length;
    show();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => redraw());
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
  $("readout").replaceChildren(...(mark ? readout() : [el("div", { class: "quiet" }, "Point at the body or at the map: the same place is marked on both.")]));
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
    pair(`point (${lengthUnit()})`, point.map((value) => fixed(value, 4)).join(", ")),
    ...["f_r", "f_dtheta", "f_dphi"].map((name) => pair(components[name].short, `${number(valueAt(name), 4)} ${unitOf(name)}`)),
  ];
  rows.push(pair("to the mesh", model.hasDistance(surface, shape) ? `${number(valueAt("distance"), 2)} ${lengthUnit()}` : notKnown));
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
  hit.corners.forEach((vertex, k) => unit(...model.grid.angles(vertex)).forEach((value, c) => (sum[c] += hit.weights[k] * value)));
  setMark(angles(sum));
}

function mapKeys(event) {
  const step = event.shiftKey ? markStep / 5 : markStep;
  const move = { ArrowUp: [-step, 0], ArrowDown: [step, 0], ArrowLeft: [0, -step], ArrowRight: [0, step], Escape: null }[event.key];
  if (move === undefined) return;
  event.preventDefault();
  if (!move) return setMark(null);
  const [theta, phi] = state.mark ?? [Math.PI / 2, 0];
  const turn = 2 * Math.PI;
  setMark(state.mark ? [Math.min(Math.max(theta + move[0], 0), Math.PI), (((phi + move[1]) % turn) + turn) % turn] : [theta, phi]);
  clearTimeout(mapKeys.said);
  mapKeys.said = setTimeout(() => state.mark && announce($("readout").innerText.replace(/\s*\n\s*/g, " ")), 350);
}

// ---- order

const largest = () => state.surface.order;
const sliderPower = () => (largest() > 8 ? 2 : 1); // low orders, which change most, have most room
const toSlider = (order) => Math.round(1000 * Math.pow(order / Math.max(largest(), 1), 1 / sliderPower()));
const fromSlider = (place) => largest() * Math.pow(place / 1000, sliderPower());

function setOrder(order, { slider = true, box = true } = {}) {
  state.order = Math.min(Math.max(order, 0), largest());
  const whole = Math.round(state.order);
  const on = Math.abs(state.order - whole) < 0.005;
  if (on) state.order = whole;
  if (slider) $("order").value = toSlider(state.order);
  if (box) $("order-number").value = on ? whole : state.order.toFixed(2);
  const name = poles(data.order_names[whole] ?? "");
  const from = Math.floor(state.order);
  const distance = model.distance(state.surface, state.shape, whole);
  const words = on ? `order ${whole}${name ? `: to the ${name}` : ""}` : `between orders ${from} and ${from + 1}`;
  $("order-name").textContent = words + (on && distance ? ` \u00b7 distance to the mesh ${number(distance.rms, 3)} rms, ${number(distance.largest, 3)} at most (${lengthUnit()})` : "");
  $("order").setAttribute("aria-valuetext", words);
  spectrum?.setOrder?.(state.order);
  redraw("shape");
}

function orderControls() {
  $("order").addEventListener("input", () => {
    stopPlaying();
    setOrder(fromSlider(Number($("order").value)), { slider: false });
  });
  $("order").addEventListener("keydown", (event) => {
    const whole = state.order;
    const to = {
      ArrowRight: Math.floor(whole) + 1,
      ArrowUp: Math.floor(whole) + 1,
      ArrowLeft: Math.ceil(whole) - 1,
      ArrowDown: Math.ceil(whole) - 1,
      PageUp: Math.floor(whole) + 8,
      PageDown: Math.ceil(whole) - 8,
      Home: 0,
      End: largest(),
    }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    stopPlaying();
    setOrder(to);
  });
  $("order-number").addEventListener("input", () => {
    const order = Number($("order-number").value);
    if ($("order-number").value === "" || !Number.isFinite(order)) return;
    stopPlaying();
    setOrder(order, { box: order < 0 || order > largest() });
  });
  $("play").addEventListener("click", () => (state.playing ? stopPlaying() : play()));
}

function scaleOfSlider() {
  const top = largest();
  $("order-number").max = top;
  $("order").setAttribute("aria-label", `Order of the body, 0 to ${top}`);
  const orders = [...new Set([0, 1, 2, 4, 8, 16, 32, 64, 128].filter((l) => l < 0.85 * top).concat(top))];
  $("order-ticks").replaceChildren(
    ...orders.map((l) => {
      const tick = el("span", {}, String(l));
      tick.style.left = `${toSlider(l) / 10}%`;
      return tick;
    }),
  );
}

function stopPlaying() {
  state.playing = false;
  showPlaying();
}

function showPlaying() {
  $("play").setAttribute("aria-pressed", String(state.playing));
  $("play").querySelector("b").textContent = state.playing ? "Pause" : "Play";
}

function play() {
  state.playing = true;
  showPlaying();
  if (state.order >= largest()) setOrder(0);
  let last = performance.now();
  const next = (now) => {
    if (!state.playing) return;
    if (reducedMotion()) {
      if (now - last >= stepMilliseconds) {
        last = now;
        setOrder(Math.floor(state.order) + 1);
      }
    } else {
      const place = 1000 * Math.pow(state.order / Math.max(largest(), 1), 1 / sliderPower()) + (1000 * Math.min(now - last, 200)) / 1000 / sweepSeconds;
      last = now;
      setOrder(fromSlider(Math.min(place, 1000)));
    }
    if (state.order >= largest()) stopPlaying();
    else requestAnimationFrame(next);
  };
  requestAnimationFrame(next);
}

// ---- set-up

function options(select, entries, chosen) {
  select.replaceChildren(...entries.map(([value, label]) => el("option", { value }, label)));
  select.value = chosen;
}

function chooseComponents() {
  const there = [...fieldNames, ...(model.hasDistance(state.surface, state.shape) ? ["distance"] : [])];
  if (!there.includes(state.component)) state.component = "f_r";
  options($("component"), there.map((name) => [name, components[name].label]), state.component);
}

function chooseSurface(name) {
  state.surface = data.surfaces.find((surface) => surface.name === name);
  if (!state.surface.signed_dphi) state.shape = "xyz";
  options($("shape"), [["xyz", "x, y, z"], ...(state.surface.signed_dphi ? [["f", "f: distance and angles"]] : [])], state.shape);
  chooseComponents();
  scaleOfSlider();
  body.frameAt(model.frame(state.surface, state.shape));
  setOrder(Math.min(state.order, largest()));
}

/// The body's canvas: by WebGL, or by hand where there is none.
function openBody(hover) {
  let canvas = el("canvas", { tabindex: "0", role: "img", "aria-label": "The body in three dimensions. Arrow keys turn it, plus and minus zoom, Home resets." });
  try {
    body = new WebglBody(canvas);
    $("body").dataset.by = "webgl";
  } catch {
    canvas = canvas.cloneNode();
    body = new SoftwareBody(canvas);
    $("body").dataset.by = "software";
    $("body-panel").append(el("p", { class: "quiet" }, "WebGL is not to be had here, so the body is drawn without it, more slowly."));
  }
  $("body").append(canvas);
  view = new View(canvas, () => redraw("view"), hover);
  canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
  fit($("body"), (width, height, ratio) => {
    body.resize(width, height, ratio);
    redraw("view");
  });
}

function fit(element, resize) {
  const now = () => {
    const { clientWidth, clientHeight } = element;
    if (clientWidth > 0 && clientHeight > 0) resize(clientWidth, clientHeight, Math.min(devicePixelRatio || 1, 2));
  };
  now();
  new ResizeObserver(now).observe(element);
}

function openMap() {
  const canvas = el("canvas", { tabindex: "0", role: "img", "aria-label": "The sphere of directions in Mollweide projection, longitude 0 in the middle. Arrow keys move the marked point, Escape removes it." });
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
  options($("surface"), data.surfaces.map((surface) => [surface.name, surface.name]), data.surfaces[0].name);
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
    spectrumState.source = coefficientState.source = state.surface.name;
    tabs?.refresh("spectra");
    tabs?.refresh("coefficients");
  });
  $("shape").addEventListener("change", () => {
    state.shape = $("shape").value;
    chooseComponents();
    body.frameAt(model.frame(state.surface, state.shape));
    setOrder(state.order);
  });
  $("component").addEventListener("change", () => {
    state.component = $("component").value;
    redraw("colour");
  });
  state.order = Math.min(7, data.surfaces[0].order);
  chooseSurface(data.surfaces[0].name);
  orderControls();
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

// ---- tabs

const spectrumState = { source: null, quantity: "power", hidden: new Set() };
const coefficientState = { source: null, to: 4, fields: "f" };
const sources = () => [...data.surfaces.map((s) => [s.name, `surface over the ${s.name} map`]), ...(data.mass ? [["mass", "mass multipoles"]] : [])];
const sourceOf = (name) => (name === "mass" && data.mass ? data.mass : (data.surfaces.find((s) => s.name === name) ?? data.surfaces[0] ?? data.mass));

function labelled(label, control) {
  return el("label", {}, `${label} `, control);
}

function fillSpectra(panel) {
  if (sources().length === 0) return panel.append(el("p", { class: "quiet" }, "The result has no expansion."));
  spectrumState.source ??= sources()[0][0];
  const source = el("select");
  options(source, sources(), spectrumState.source);
  const quantity = el("select");
  const place = el("div");
  const draw = (focus) => {
    const of = sourceOf(spectrumState.source);
    const there = quantities(of);
    if (!there[spectrumState.quantity]) spectrumState.quantity = "power";
    options(quantity, Object.entries(there).map(([key, { label }]) => [key, label]), spectrumState.quantity);
    spectrum = drawSpectrum(place, { source: of, mass: of === data.mass, quantity: spectrumState.quantity, hidden: spectrumState.hidden, order: state.order }, draw);
    if (focus) place.querySelector(`[data-line="${focus}"]`)?.focus();
  };
  source.addEventListener("change", () => {
    spectrumState.source = source.value;
    draw();
  });
  quantity.addEventListener("change", () => {
    spectrumState.quantity = quantity.value;
    draw();
  });
  panel.append(el("div", { class: "choices" }, labelled("Of", source), labelled("Shown", quantity)), place);
  let drawnFor = 0;
  new ResizeObserver(() => {
    if (place.clientWidth === 0 || place.clientWidth === drawnFor || place.contains(document.activeElement)) return;
    drawnFor = place.clientWidth;
    draw();
  }).observe(place);
  draw();
}

function fillCoefficients(panel) {
  if (sources().length === 0) return panel.append(el("p", { class: "quiet" }, "The result has no expansion."));
  coefficientState.source ??= sources()[0][0];
  const source = el("select");
  options(source, sources(), coefficientState.source);
  const fields = el("select");
  options(fields, [["f", "f_r, f_d\u03b8, f_d\u03c6"], ["xyz", "x, y, z"], ["all", "all six"]], coefficientState.fields);
  const to = el("input", { type: "number", min: 0, step: 1 });
  const fieldsLabel = labelled("Fields", fields);
  const place = el("div");
  const draw = () => {
    const of = sourceOf(coefficientState.source);
    const mass = of === data.mass;
    fieldsLabel.hidden = mass;
    to.max = of.order;
    coefficientState.to = Math.min(Math.max(Math.round(coefficientState.to), 0), of.order);
    const chosen = mass ? [0] : { f: [0, 1, 2], xyz: [3, 4, 5], all: [0, 1, 2, 3, 4, 5] }[coefficientState.fields];
    place.replaceChildren(coefficientTable(of, mass, chosen, coefficientState.to));
  };
  to.value = Math.min(coefficientState.to, sourceOf(coefficientState.source).order);
  source.addEventListener("change", () => {
    coefficientState.source = source.value;
    draw();
  });
  fields.addEventListener("change", () => {
    coefficientState.fields = fields.value;
    draw();
  });
  to.addEventListener("input", () => {
    if (to.value === "") return;
    coefficientState.to = Number(to.value);
    draw();
  });
  panel.append(el("div", { class: "choices" }, labelled("Of", source), fieldsLabel, labelled("Degrees to", to)), place);
  panel.append(el("p", { class: "quiet" }, "Orthonormal Y_lm with the Condon-Shortley phase; a_l,\u2212m = (\u22121)^m conj a_lm. Copied numbers have every digit."));
  draw();
}

function fillPhysics(panel) {
  if (data.physics.length === 0)
    panel.append(el("p", { class: "quiet" }, "No physics was put in. For instance: cowgpu tensors MESH --json > tensors.json, then cowgpu report with --physics tensors.json."));
  panel.append(...data.physics.map(findings));
}

function numbers() {
  tabs = makeTabs([
    { id: "spectra", label: "Spectra", fill: fillSpectra },
    { id: "coefficients", label: "Coefficients", fill: fillCoefficients },
    { id: "physics", label: "Physics", fill: fillPhysics },
    { id: "provenance", label: "Provenance", fill: (panel) => panel.append(provenance(data)) },
  ]);
}

try {
  start();
} catch (error) {
  $("failure").hidden = false;
  $("failure").textContent = `This page could not be shown: ${error.message}`;
  console.error(error);
}
