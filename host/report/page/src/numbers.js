// The tabs below the body: spectra, coefficients, physics, provenance.
import { coefficientTable, findings, provenance } from "./documents.js";
import { el, options } from "./dom.js";
import { drawSpectrum, quantities } from "./spectra.js";
import { makeTabs } from "./tabs.js";

let data, tabs, spectrum;
let order = 0;

const spectrumState = { source: null, quantity: "power", hidden: new Set() };
const coefficientState = { source: null, to: 4, fields: "f" };
const sources = () => [
  ...data.surfaces.map((s) => [s.name, `surface over the ${s.name} map`]),
  ...(data.mass ? [["mass", "mass multipoles"]] : []),
];
const sourceOf = (name) =>
  name === "mass" && data.mass ? data.mass : (data.surfaces.find((s) => s.name === name) ?? data.surfaces[0] ?? data.mass);

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
    options(
      quantity,
      Object.entries(there).map(([key, { label }]) => [key, label]),
      spectrumState.quantity,
    );
    spectrum = drawSpectrum(
      place,
      {
        source: of,
        mass: of === data.mass,
        quantity: spectrumState.quantity,
        hidden: spectrumState.hidden,
        order,
      },
      draw,
    );
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
  options(
    fields,
    [
      ["f", "f_r, f_d\u03b8, f_d\u03c6"],
      ["xyz", "x, y, z"],
      ["all", "all six"],
    ],
    coefficientState.fields,
  );
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
  panel.append(
    el(
      "p",
      { class: "quiet" },
      "Orthonormal Y_lm with the Condon-Shortley phase; a_l,\u2212m = (\u22121)^m conj a_lm. Copied numbers have every digit.",
    ),
  );
  draw();
}

/// A document that is not as expected costs its own place, not the tab.
function shown(document) {
  try {
    return findings(document);
  } catch (error) {
    return el("p", { class: "note" }, `A document (${String(document?.schema)}) cannot be shown: ${error.message}`);
  }
}

function fillPhysics(panel) {
  if (data.physics.length === 0)
    panel.append(
      el(
        "p",
        { class: "quiet" },
        "No physics was put in. For instance: cowgpu tensors MESH --json > tensors.json, then cowgpu report with --physics tensors.json.",
      ),
    );
  panel.append(...data.physics.map(shown));
}

/// Fills the page's tabs from the document.
export function numbers(document) {
  data = document;
  tabs = makeTabs([
    { id: "spectra", label: "Spectra", fill: fillSpectra },
    { id: "coefficients", label: "Coefficients", fill: fillCoefficients },
    { id: "physics", label: "Physics", fill: fillPhysics },
    { id: "provenance", label: "Provenance", fill: (panel) => panel.append(provenance(data)) },
  ]);
}

/// The expansion that is shown above: it is shown here too.
export function showSource(name) {
  spectrumState.source = coefficientState.source = name;
  tabs?.refresh("spectra");
  tabs?.refresh("coefficients");
}

/// The order that is shown above: the spectrum marks it.
export function showOrder(now) {
  order = now;
  spectrum?.setOrder?.(now);
}
