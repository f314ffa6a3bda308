// The tabs that are read: coefficients, physics, where it all comes from.
import { index, count } from "./data.js";
import { $, copyButton, el } from "./dom.js";
import { components, notKnown, number, plain, thousands, words } from "./format.js";
import { fieldNames } from "./model.js";
import { table } from "./table.js";

/// Coefficients of a surface or of the mass, degrees 0 to `to`, by l, then m. `fields`: indices.
export function coefficientTable(source, mass, fields, to) {
  const all = count(source.order);
  const names = mass ? ["Q_lm / R^l"] : fieldNames.map((name) => components[name].short);
  const columns = [
    { name: "l" },
    { name: "m" },
    ...fields.flatMap((f) => [{ name: `Re ${names[f]}` }, { name: `Im ${names[f]}` }]),
  ];
  const rows = [];
  for (let l = 0; l <= to; ++l)
    for (let m = 0; m <= l; ++m) {
      const at = index(source.order, l, m);
      rows.push([
        l,
        m,
        ...fields.flatMap((f) => [source.coefficients[2 * (f * all + at)], source.coefficients[2 * (f * all + at) + 1]]),
      ]);
    }
  return table(`Coefficients of degrees 0 to ${to}, m \u2265 0`, columns, rows);
}

const headOf = new Set(["schema", "program", "command", "created", "input", "notes", "units", "paper", "title"]);
const isTable = (value) => value && typeof value === "object" && Array.isArray(value.columns) && Array.isArray(value.rows);
const isMatrix = (value) => Array.isArray(value) && value.length > 0 && value.every(Array.isArray);

function matrix(rows, label) {
  const cell = (value) => el("td", {}, typeof value === "number" ? number(value) : valueText(value));
  const body = el("tbody", {}, ...rows.map((row) => el("tr", {}, ...row.map(cell))));
  return el(
    "div",
    { class: "wide", tabindex: "0", role: "group", "aria-label": label },
    el("table", { class: "matrix" }, body),
  );
}

function valueText(value) {
  if (value == null) return notKnown;
  if (typeof value === "number") return number(value, 8);
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value === "string") return value;
  if (Array.isArray(value)) return `(${value.map(valueText).join(", ")})`;
  return JSON.stringify(value);
}

const flat = (value) =>
  Array.isArray(value) ? value.map(flat).join(" ") : typeof value === "object" && value ? JSON.stringify(value) : plain(value);

function columnOf(column, i, units, rows) {
  const name = typeof column === "string" ? column : (column?.name ?? `column ${i + 1}`);
  const unit = typeof column === "object" ? column?.unit : units?.[i];
  return { name: words(String(name)), unit: unit || null, text: rows.some((row) => typeof row[i] === "string") };
}

/// A document of findings: its members with units, its tables, its notes, numbers beside the paper's.
export function findings(document) {
  const part = el("section", { class: "findings" });
  const kind = String(document.schema ?? "").split(".")[1] ?? "document";
  part.append(
    el(
      "h3",
      {},
      kind.replace(/^./, (c) => c.toUpperCase()),
    ),
  );
  const input = document.input ?? {};
  part.append(
    el(
      "p",
      { class: "quiet" },
      [input.name && `of ${input.name}`, Array.isArray(document.command) && document.command.slice(1).join(" ")]
        .filter(Boolean)
        .join("; "),
    ),
  );
  for (const note of document.notes ?? []) part.append(el("p", { class: "note" }, String(note)));
  const units = document.units ?? {};
  const list = el("dl", { class: "facts" });
  const lines = [];
  const tables = [];
  for (const [key, value] of Object.entries(document)) {
    if (headOf.has(key)) continue;
    if (isTable(value)) {
      tables.push(
        table(
          words(key),
          value.columns.map((column, i) => columnOf(column, i, value.units, value.rows)),
          value.rows,
        ),
      );
      continue;
    }
    const unit = units[key] ? String(units[key]) : "";
    lines.push([key, flat(value), unit]);
    list.append(
      el(
        "div",
        {},
        el("dt", {}, words(key)),
        el(
          "dd",
          {},
          isMatrix(value) ? matrix(value, words(key)) : valueText(value),
          unit ? el("span", { class: "unit" }, ` ${unit}`) : null,
        ),
      ),
    );
  }
  part.append(list, ...tables);
  if (Array.isArray(document.paper) && document.paper.length > 0)
    part.append(
      table(
        "Beside the paper's numbers",
        [
          { name: "quantity", text: true },
          { name: "here" },
          { name: "paper" },
          { name: "relative difference" },
          { name: "why", text: true },
        ],
        document.paper.map((row) => [row.quantity, row.ours, row.paper, row.relative_difference, row.why || ""]),
      ),
    );
  part.append(copyButton("Copy findings", () => lines.map((line) => line.join("\t")).join("\n") + "\n"));
  return part;
}

/// A command line as a shell reads it.
export const shellLine = (command) =>
  command.map((word) => (/^[\w@%+=:,./-]+$/.test(word) ? word : `'${String(word).replaceAll("'", "'\\''")}'`)).join(" ");

function facts(title, rows) {
  const list = el("dl", { class: "facts" });
  for (const [name, value] of rows) {
    if (value === undefined) continue;
    list.append(el("div", {}, el("dt", {}, name), el("dd", {}, value instanceof Node ? value : valueText(value))));
  }
  return el("section", {}, el("h3", {}, title), list);
}

// What is known of the multipoles, and whether the check passed; files without an estimate say the check's figure alone.
const accuracyOf = (accuracy) => {
  if (accuracy?.worst === undefined || accuracy.worst === null) return undefined;
  const check = `${number(accuracy.worst, 3)}, bound ${number(accuracy.bound, 3)}: ${accuracy.passed ? "passed" : "failed"}`;
  const sentences = accuracy.estimate?.sentences;
  if (!Array.isArray(sentences)) return check;
  return [...sentences.map(String), `error of the check over its estimate ${check}`].join("; ");
};

const lineOf = (command) => {
  const text = shellLine(command);
  return el(
    "span",
    { class: "command" },
    el("code", {}, text),
    copyButton("Copy", () => text),
  );
};

/// Where it all comes from.
export function provenance(data) {
  const { result } = data;
  const mesh = result.mesh ?? {};
  const device = result.device ?? {};
  const part = document.createDocumentFragment();
  const notes = [...(result.notes ?? []), ...(data.notes ?? [])];
  if (notes.length > 0)
    part.append(el("section", {}, el("h3", {}, "Notes"), ...notes.map((note) => el("p", { class: "note" }, String(note)))));
  part.append(
    facts("Result", [
      ["program", `${result.program?.name ?? "cowgpu"} ${result.program?.version ?? ""}`],
      ["command", Array.isArray(result.command) ? lineOf(result.command) : undefined],
      ["created", result.created],
      ["device", [device.name, device.driver, device.api].filter(Boolean).join(", ") || null],
      ["kind of device", device.type],
      ["accuracy", accuracyOf(result.accuracy)],
      ["time in all", typeof result.timings?.total === "number" ? `${number(result.timings.total, 4)} s` : undefined],
    ]),
    facts("Mesh", [
      ["name", mesh.name],
      ["SHA-256", mesh.sha256 ? el("code", { class: "hash" }, String(mesh.sha256)) : undefined],
      ["vertices, triangles", `${thousands(mesh.vertices)}, ${thousands(mesh.faces)}`],
      ["volume", mesh.volume],
      ["area", mesh.area],
      ["mass", mesh.mass],
      ["centre of mass", mesh.centre_of_mass],
      ["Brillouin radius", mesh.brillouin_radius],
      ["metres per unit", mesh.placement?.metres_per_unit],
      ["distances to", data.mesh ? data.mesh.name : "not known: the page was made without --mesh"],
    ]),
  );
  for (const surface of data.surfaces) {
    const { about } = surface;
    const map = about.map ?? {};
    part.append(
      facts(`Expansion over the ${surface.name} map`, [
        ["degrees", `0 to ${surface.lmax}; bodies and coefficients here to ${surface.order}`],
        ["recipe", about.recipe],
        ["origin", about.origin],
        ["convention", `${about.normalisation}, ${about.condon_shortley ? "with" : "without"} the Condon-Shortley phase`],
        ["axes", about.axes],
        ["units", about.units],
        [
          "removed means of the angles",
          about.removed_means ? [about.removed_means.f_dtheta, about.removed_means.f_dphi] : undefined,
        ],
        ["triangles flipped by the map", map.flipped],
        ["triangles smaller than the grid's cells", map.unseen],
        ["grid", about.grid ? `${about.grid.rings} rings of ${about.grid.ring_length}` : undefined],
      ]),
    );
  }
  if (data.mass)
    part.append(
      facts("Mass multipoles", [
        ["degrees", `0 to ${data.mass.lmax}; coefficients here to ${data.mass.order}`],
        ["density", data.mass.about.density],
        ["reference radius R", data.mass.about.reference_radius],
        ["units", data.mass.about.units],
        ["cut-off", data.mass.about.cut_off],
      ]),
    );
  part.append(
    facts("This page", [
      ["program", `${data.program.name} ${data.program.version}`],
      ["command", lineOf(data.command)],
      ["created", data.created],
      ["drawn with", "three.js, d3-geo, d3-geo-projection, d3-scale, d3-scale-chromatic"],
    ]),
  );
  const licences = $("licences").textContent;
  part.append(el("details", {}, el("summary", {}, "Licences of what it is drawn with"), el("pre", {}, licences)));
  return part;
}
