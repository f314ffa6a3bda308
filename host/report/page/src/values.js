// A quantity at the faces or vertices of the mesh, on the mesh in colours, with the numbers of the place under the pointer.
import { bodyCanvas } from "./body_canvas.js";
import { Scale } from "./colour.js";
import { $, announce, el, options } from "./dom.js";
import { number, thousands, words } from "./format.js";
import { barNumber, drawBar } from "./legend.js";
import { frameOf, normals } from "./model.js";

const digits = 5;
const withUnit = (text, unit) => (unit === "deg" ? `${text}\u00b0` : unit === "" || unit === "1" ? text : `${text} ${unit}`);
const lengths = (column) => {
  if (column.components === 1) return column.values;
  const out = new Float32Array(column.values.length / 3);
  for (let i = 0; i < out.length; ++i) out[i] = Math.hypot(...column.values.subarray(3 * i, 3 * i + 3));
  return out;
};

/// The mesh with the corners of each face apart, so that a face has one colour; shading stays smooth.
function apart({ vertices, faces }) {
  const smooth = normals(vertices, faces);
  const positions = new Float32Array(3 * faces.length);
  const directions = new Float32Array(3 * faces.length);
  for (let i = 0; i < faces.length; ++i) {
    positions.set(vertices.subarray(3 * faces[i], 3 * faces[i] + 3), 3 * i);
    directions.set(smooth.subarray(3 * faces[i], 3 * faces[i] + 3), 3 * i);
  }
  return { positions, directions, faces: Uint32Array.from(faces, (_, i) => i) };
}

/// Fills the part of the page for `data.values`. Returns {theme()}.
export function showValues(data) {
  const { mesh, values } = data;
  const ofFaces = values.place === "faces";
  const one = ofFaces ? "face" : "vertex";
  const count = values.places.length / 3;
  const shape = ofFaces
    ? apart(mesh)
    : { positions: mesh.vertices, directions: normals(mesh.vertices, mesh.faces), faces: mesh.faces };
  let column = values.columns.find((c) => c.name === values.shown && c.components === 1) ?? values.columns[0];
  let marked = null;
  let waiting = false;
  const draw = () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      body.draw(view);
    });
  };

  $("values-stage").hidden = false;
  $("values-title").textContent = `On the ${thousands(count)} ${values.place}`;
  const { body, view } = bodyCanvas(
    $("values-body"),
    $("values-panel"),
    "The mesh in three dimensions, coloured by a quantity. Arrow keys turn it, plus and minus zoom, Home resets.",
    () => draw(),
    (at) => mark(at ? placeOf(body.pick(at)) : null),
  );
  body.setFaces(shape.faces, shape.positions.length / 3);
  body.setShape(shape.positions, shape.directions);
  body.frameAt(frameOf(mesh.vertices));

  function placeOf(hit) {
    if (!hit) return null;
    if (ofFaces) return Math.floor(hit.corners[0] / 3);
    return hit.corners[hit.weights.indexOf(Math.max(...hit.weights))];
  }

  /// Where a face or vertex is on the mesh, which is placed as the result is.
  function pointOf(i) {
    if (!ofFaces) return [...mesh.vertices.subarray(3 * i, 3 * i + 3)];
    const sum = [0, 0, 0];
    for (let k = 0; k < 3; ++k)
      for (let c = 0; c < 3; ++c) sum[c] += mesh.vertices[3 * mesh.faces[3 * i + k] + c] / 3;
    return sum;
  }

  function colours() {
    const scale = new Scale(column.range[1] > column.range[0] ? column.range : [column.range[0], column.range[0] + 1], false);
    const numbers = lengths(column);
    const indices = new Uint8Array(shape.positions.length / 3);
    for (let i = 0; i < indices.length; ++i) indices[i] = scale.index(numbers[ofFaces ? Math.floor(i / 3) : i]);
    body.setColours(indices, scale.colours);
    const unit = column.unit === "" || column.unit === "1" ? "" : ` (${column.unit === "deg" ? "\u00b0" : column.unit})`;
    drawBar($("values-bar"), scale, nameOf(column) + unit, barNumber);
    $("values-meaning").textContent = `${column.meaning}.`;
    draw();
  }

  const nameOf = (c) => (c.components === 3 ? `size of ${words(c.name)}` : words(c.name));
  const numberAt = (c, i) =>
    c.components === 1
      ? number(c.values[i], digits)
      : `(${[0, 1, 2].map((k) => number(c.values[3 * i + k], digits)).join(", ")})`;
  const row = (name, text) => el("div", {}, el("dt", {}, name), el("dd", {}, text));

  function mark(i) {
    if (i === marked && i !== null) return;
    marked = i;
    body.setMarker(i === null ? null : pointOf(i));
    if (i !== null) $("values-number").value = i;
    const place = i === null ? null : [...values.places.subarray(3 * i, 3 * i + 3)];
    $("values-readout").replaceChildren(
      ...(i === null
        ? [el("div", { class: "quiet" }, `Point at the body, or give the number of a ${one}: its values stand here.`)]
        : [
            row("place", withUnit(`(${place.map((x) => number(x, digits)).join(", ")})`, values.length_unit)),
            ...values.columns.map((c) =>
              row(c.components === 3 ? `${words(c.name)} (x, y, z)` : words(c.name), withUnit(numberAt(c, i), c.unit)),
            ),
          ]),
    );
    $("values-readout").dataset.place = i ?? "";
    draw();
  }

  $("values-number").max = count - 1;
  $("values-number-label").textContent = ofFaces ? "Face" : "Vertex";
  $("values-number").addEventListener("change", () => {
    const i = Math.round(Number($("values-number").value));
    if (!(i >= 0 && i < count)) return;
    mark(i);
    announce(`${one} ${i}: ${nameOf(column)} ${withUnit(numberAt(column, i), column.unit)}`);
  });
  options(
    $("quantity"),
    values.columns.map((c, i) => [String(i), nameOf(c)]),
    String(values.columns.indexOf(column)),
  );
  $("quantity").addEventListener("change", () => {
    column = values.columns[Number($("quantity").value)];
    colours();
  });
  $("values-notes").replaceChildren(...values.notes.map((note) => el("p", {}, note)));
  colours();
  mark(null);
  return {
    theme() {
      body.theme();
      draw();
    },
  };
}
