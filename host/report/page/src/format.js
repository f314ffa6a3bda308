// Numbers and names as they are shown.

const minus = "\u2212";
const raised = {
  "-": "\u207b",
  0: "\u2070",
  1: "\u00b9",
  2: "\u00b2",
  3: "\u00b3",
  4: "\u2074",
  5: "\u2075",
  6: "\u2076",
  7: "\u2077",
  8: "\u2078",
  9: "\u2079",
};
export const notKnown = "not known";

export const superscript = (n) => [...String(n)].map((c) => raised[c]).join("");
export const power10 = (n) => `10${superscript(n)}`;

/// A number with so many digits: 0.012346, 1.2346 10^-7; what is no finite number is not known.
export function number(value, digits = 6) {
  if (typeof value !== "number" || !Number.isFinite(value)) return notKnown;
  if (value === 0) return "0";
  if (Number.isInteger(value) && Math.abs(value) < 1e9) return String(value).replace("-", minus);
  const size = Math.abs(value);
  if (size >= 1e-4 && size < 1e7) return value.toPrecision(digits).replace("-", minus);
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  return `${mantissa.replace("-", minus)}\u00d7${power10(Number(exponent))}`;
}

/// The same for a table that is copied: every digit, and nothing where it is not known.
export function plain(value) {
  if (value == null || (typeof value === "number" && !Number.isFinite(value))) return "";
  return Object.is(value, -0) ? "0" : String(value);
}

/// "2^32-pole" as it is printed.
export const poles = (name) => name.replace(/\^(\d+)/, (_, n) => superscript(n));

export const degrees = (radians, digits = 1) => `${((radians * 180) / Math.PI).toFixed(digits).replace("-", minus)}\u00b0`;

/// "qdddot2_over_omega6_SI" as words.
export const words = (key) => key.replaceAll("_", " ");

export const thousands = (value) =>
  typeof value === "number" && Number.isFinite(value) ? String(value).replace(/\B(?=(\d{3})+$)/g, "\u202f") : notKnown;

export const components = {
  f_r: { option: "f_r: distance", label: "f_r, distance from the origin", short: "f_r", unit: "length" },
  f_dtheta: {
    option: "f_d\u03b8: polar angle",
    label: "f_d\u03b8, angle from the pole, of body less sphere",
    short: "f_d\u03b8",
    unit: "angle",
  },
  f_dphi: {
    option: "f_d\u03c6: longitude",
    label: "f_d\u03c6, longitude, of body less sphere",
    short: "f_d\u03c6",
    unit: "angle",
  },
  x: { option: "x", label: "x", short: "x", unit: "length" },
  y: { option: "y", label: "y", short: "y", unit: "length" },
  z: { option: "z", label: "z", short: "z", unit: "length" },
  distance: {
    option: "distance to the mesh",
    label: "distance to the true mesh",
    short: "distance to the mesh",
    unit: "length",
  },
};
