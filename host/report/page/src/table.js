// Tables that sort by a click on a column's head and copy as tab-separated text.
import { announce, copyButton, el } from "./dom.js";
import { notKnown, number, plain } from "./format.js";

const shown = (value) => {
  if (value == null) return notKnown;
  if (typeof value === "number") return number(value);
  if (typeof value === "boolean") return value ? "yes" : "no";
  return Array.isArray(value) ? `(${value.map(shown).join(", ")})` : String(value);
};

const missing = (value) => value == null || (typeof value === "number" && !Number.isFinite(value));

/// Those that are not known stand last, whichever way it is sorted.
export function compare(a, b, down) {
  if (missing(a) || missing(b)) return missing(a) - missing(b);
  const order =
    typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b), "en", { numeric: true });
  return down ? -order : order;
}

/// `columns`: {name, unit, text: true for words}; `rows`: lists of values. A figure with copy button, and a table below.
export function table(caption, columns, rows) {
  let order = { column: -1, down: false };
  let sorted = rows;
  const body = el("tbody");
  const fill = () => body.replaceChildren(...sorted.map(row));
  const row = (values) =>
    el(
      "tr",
      {},
      ...values.map((value, c) =>
        el(
          c === 0 ? "th" : "td",
          {
            scope: c === 0 ? "row" : null,
            class: columns[c].text ? "text" : null,
            title: typeof value === "number" && Number.isFinite(value) ? plain(value) : null,
          },
          shown(value),
        ),
      ),
    );
  const heads = columns.map((column, c) => {
    const head = el("th", { scope: "col", "aria-sort": "none", class: column.text ? "text" : null });
    const button = el(
      "button",
      { type: "button" },
      column.name,
      column.unit ? el("small", {}, ` ${column.unit}`) : null,
      el("span", { class: "arrow", "aria-hidden": "true" }),
    );
    button.addEventListener("click", () => {
      order = { column: c, down: order.column === c && !order.down };
      sorted = rows
        .map((values, i) => [values, i])
        .sort(([a, i], [b, j]) => compare(a[c], b[c], order.down) || i - j)
        .map(([values]) => values);
      heads.forEach((other, k) => other.setAttribute("aria-sort", k !== c ? "none" : order.down ? "descending" : "ascending"));
      fill();
      announce(`Sorted by ${column.name}, ${order.down ? "largest" : "smallest"} first.`);
    });
    head.append(button);
    return head;
  });
  const text = () =>
    [
      columns.map((column) => (column.unit ? `${column.name} (${column.unit})` : column.name)),
      ...sorted.map((values) => values.map((value) => (Array.isArray(value) ? value.map(plain).join(" ") : plain(value)))),
    ]
      .map((line) => line.join("\t"))
      .join("\n") + "\n";
  fill();
  return el(
    "figure",
    { class: "table" },
    el("figcaption", {}, el("span", {}, caption), copyButton("Copy table", text)),
    el(
      "div",
      { class: "scroll", tabindex: "0", role: "region", "aria-label": caption },
      el("table", {}, el("caption", { class: "hidden" }, caption), el("thead", {}, el("tr", {}, ...heads)), body),
    ),
  );
}
