// Power by degree, both axes logarithmic.
import { scaleLog } from "d3-scale";
import { el, svg } from "./dom.js";
import { components, notKnown, number, power10 } from "./format.js";
import { fieldNames } from "./model.js";
import { table } from "./table.js";

const widths = [340, 1200];
const height = 380;
const edge = { left: 64, right: 18, top: 14, bottom: 44 };
const deepest = 1e-14; // of the largest: what is below is rounding and would flatten the rest
const shapes = ["", "7 3", "2 3", "9 3 2 3", "5 2", "1 4"];

/// What is drawn over the degree: its title, unit, and [field][degree].
export function quantities(source) {
  const degreesOf = (f) => source.power[f];
  const all = {
    power: {
      label: "power of a degree, S_l",
      note: "S_l = sum over m of |a_lm|\u00b2",
      unit: "square of the field's unit",
      lines: source.power,
    },
    mean: {
      label: "power of one coefficient, S_l / (2l+1)",
      note: "the mean of |a_lm|\u00b2 over m",
      unit: "square of the field's unit",
      lines: source.power.map((_, f) => degreesOf(f).map((value, l) => value / (2 * l + 1))),
    },
  };
  const left = source.about.truncation;
  if (Array.isArray(left) && left.length > 0)
    all.left = {
      label: "what degrees to l leave out",
      note: "root mean square over the sphere of the field less its degrees 0 to l",
      unit: "the field's unit",
      lines: source.power.map((_, f) => left.map((row) => row[f])),
    };
  return all;
}

const positive = (value) => typeof value === "number" && Number.isFinite(value) && value > 0;

function powersBetween(low, high, most) {
  const first = Math.ceil(Math.log10(low) - 1e-9);
  const last = Math.floor(Math.log10(high) + 1e-9);
  const step = Math.max(1, Math.ceil((last - first + 1) / most));
  const out = [];
  for (let n = first; n <= last; n += step) out.push(n);
  return out;
}

/// Draws it into `place`. `state`: {source, mass, quantity, hidden: Set of names, order}.
export function drawSpectrum(place, state, changed) {
  const { source } = state;
  const width = Math.min(Math.max(place.clientWidth || 0, widths[0]), widths[1]);
  const names = state.mass ? ["Q_lm"] : fieldNames;
  const labels = state.mass ? ["mass multipoles Q_lm / R^l"] : fieldNames.map((name) => components[name].short);
  const all = quantities(source);
  const quantity = all[state.quantity] ?? all.power;
  const lines = names.map((name, i) => ({ name, label: labels[i], at: i, values: quantity.lines[i] }));
  const drawn = lines.filter((line) => !state.hidden.has(line.name));
  const degreesThere = quantity.lines[0].length - 1;
  const values = drawn.flatMap((line) => line.values.slice(1)).filter(positive);
  const chart = svg("svg", {
    viewBox: `0 0 ${width} ${height}`,
    class: "chart",
    role: "img",
    "aria-label": `${quantity.label} over the degree, both axes logarithmic. The table below has the numbers.`,
  });
  const figure = el("figure", { class: "spectrum" });
  const readout = el("p", { class: "chart-readout" }, "\u00a0");
  const legend = el("div", { class: "legend", role: "group", "aria-label": "Lines" });
  for (const line of lines) {
    const box = el("input", { type: "checkbox" });
    box.checked = !state.hidden.has(line.name);
    box.disabled = lines.length === 1;
    box.addEventListener("change", () => {
      if (box.checked) state.hidden.delete(line.name);
      else state.hidden.add(line.name);
      changed(line.name);
    });
    box.dataset.line = line.name;
    const sample = svg(
      "svg",
      { viewBox: "0 0 26 10", width: 26, height: 10, "aria-hidden": "true" },
      svg("line", { x1: 0, x2: 26, y1: 5, y2: 5, class: `line series-${line.at}`, "stroke-dasharray": shapes[line.at] }),
    );
    legend.append(el("label", { class: "check" }, box, sample, line.label));
  }
  if (values.length === 0 || degreesThere < 1) {
    figure.append(legend, el("p", { class: "quiet" }, "There is no power above 0 to draw beyond degree 0."));
  } else {
    const high = Math.max(...values);
    const low = Math.max(Math.min(...values), high * deepest);
    const x = scaleLog([1, Math.max(degreesThere, 2)], [edge.left, width - edge.right]);
    const y = scaleLog([low / 1.5, high * 1.8], [height - edge.bottom, edge.top]);
    chart.append(...axes(x, y, width, degreesThere, quantity));
    const clip = svg(
      "clipPath",
      { id: "plot" },
      svg("rect", {
        x: edge.left,
        y: edge.top,
        width: width - edge.left - edge.right,
        height: height - edge.top - edge.bottom,
      }),
    );
    chart.append(svg("defs", {}, clip));
    const now = svg("line", { class: "now", y1: edge.top, y2: height - edge.bottom });
    chart.append(now);
    const setOrder = (order) => {
      now.setAttribute("visibility", order >= 1 ? "visible" : "hidden");
      now.setAttribute("x1", x(Math.max(order, 1)));
      now.setAttribute("x2", x(Math.max(order, 1)));
    };
    setOrder(state.order);
    figure.setOrder = setOrder;
    for (const line of drawn) {
      let path = "";
      let pen = "M";
      for (let l = 1; l <= degreesThere; ++l) {
        if (!positive(line.values[l])) {
          pen = "M";
          continue;
        }
        path += `${pen}${x(l).toFixed(2)},${y(line.values[l]).toFixed(2)}`;
        pen = "L";
      }
      chart.append(
        svg("path", {
          d: path,
          class: `line series-${line.at}`,
          "stroke-dasharray": shapes[line.at],
          "clip-path": "url(#plot)",
        }),
      );
      if (degreesThere <= 40)
        for (let l = 1; l <= degreesThere; ++l)
          if (positive(line.values[l]))
            chart.append(
              svg("circle", {
                cx: x(l),
                cy: y(line.values[l]),
                r: 2.4,
                class: `dot series-${line.at}`,
                "clip-path": "url(#plot)",
              }),
            );
    }
    const cursor = svg("line", { class: "cursor", y1: edge.top, y2: height - edge.bottom, visibility: "hidden" });
    chart.append(cursor);
    chart.addEventListener("pointermove", (event) => {
      const box = chart.getBoundingClientRect();
      const at = x.invert(((event.clientX - box.left) * width) / box.width);
      const l = Math.min(Math.max(Math.round(at), 1), degreesThere);
      cursor.setAttribute("visibility", "visible");
      cursor.setAttribute("x1", x(l));
      cursor.setAttribute("x2", x(l));
      readout.textContent = `l = ${l}: ${drawn.map((line) => `${line.label} ${number(line.values[l], 4)}`).join(",  ")}`;
    });
    chart.addEventListener("pointerleave", () => {
      cursor.setAttribute("visibility", "hidden");
      readout.textContent = "\u00a0";
    });
    figure.append(legend, chart, readout);
  }
  const zero = lines.map(
    (line) => `${line.label} ${positive(line.values[0]) ? number(line.values[0], 5) : line.values[0] === 0 ? "0" : notKnown}`,
  );
  figure.append(
    el(
      "figcaption",
      { class: "quiet" },
      `${quantity.note}; ${quantity.unit}. Degree 0, which a logarithmic axis has no place for: ${zero.join(", ")}.`,
    ),
  );
  const rows = Array.from({ length: degreesThere + 1 }, (_, l) => [l, ...quantity.lines.map((line) => line[l])]);
  const details = el(
    "details",
    {},
    el("summary", {}, "As a table"),
    table(`${quantity.label}, by degree`, [{ name: "l" }, ...labels.map((name) => ({ name }))], rows),
  );
  place.replaceChildren(figure, details);
  return figure;
}

function axes(x, y, width, degreesThere, quantity) {
  const parts = [];
  const bottom = height - edge.bottom;
  const tick = (label, attributes) => svg("text", { class: "tick", ...attributes }, label);
  for (const n of powersBetween(...y.domain(), 9)) {
    const at = y(10 ** n);
    parts.push(
      svg("line", { class: "grid", x1: edge.left, x2: width - edge.right, y1: at, y2: at }),
      tick(power10(n), { x: edge.left - 8, y: at + 4, "text-anchor": "end" }),
    );
  }
  for (let decade = 1; decade <= degreesThere; decade *= 10)
    for (const digit of [1, 2, 3, 4, 5, 6, 7, 8, 9]) {
      const l = digit * decade;
      if (l > degreesThere) break;
      const at = x(l);
      const named = digit === 1 || digit === 2 || digit === 5 || (degreesThere < 8 && digit < 8);
      parts.push(svg("line", { class: named ? "grid" : "grid faint", x1: at, x2: at, y1: edge.top, y2: bottom }));
      if (named) parts.push(tick(String(l), { x: at, y: bottom + 18, "text-anchor": "middle" }));
    }
  parts.push(
    svg("line", { class: "axis", x1: edge.left, x2: width - edge.right, y1: bottom, y2: bottom }),
    svg("line", { class: "axis", x1: edge.left, x2: edge.left, y1: edge.top, y2: bottom }),
  );
  parts.push(tick("degree l", { x: (edge.left + width - edge.right) / 2, y: height - 6, "text-anchor": "middle" }));
  parts.push(
    tick(quantity.label, {
      x: 14,
      y: (edge.top + bottom) / 2,
      "text-anchor": "middle",
      transform: `rotate(-90 14 ${(edge.top + bottom) / 2})`,
    }),
  );
  return parts;
}
