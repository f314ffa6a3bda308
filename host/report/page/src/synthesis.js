// Fields on a grid from their coefficients: f = sum over l, m of a_lm Y_lm, Y_lm orthonormal with the Condon-Shortley phase.
import { index } from "./data.js";

/// Orthonormal associated Legendre functions with the Condon-Shortley phase to degree `order`, sorted by m, then l, by the
/// standard recursion in l (Holmes and Featherstone, J. Geodesy 76 (2002) 279). To order 128, on the grids here, sin^m theta
/// is 1e-245 or more off the poles: nothing underflows.
export function legendre(order, theta, out = new Float64Array(((order + 1) * (order + 2)) / 2)) {
  const x = Math.cos(theta);
  const s = Math.sin(theta);
  let sectoral = Math.sqrt(1 / (4 * Math.PI));
  for (let m = 0; m <= order; ++m) {
    if (m > 0) sectoral *= -s * Math.sqrt((2 * m + 1) / (2 * m));
    let before = 0;
    let last = sectoral;
    out[index(order, m, m)] = last;
    for (let l = m + 1; l <= order; ++l) {
      const a = Math.sqrt(((2 * l + 1) * (2 * l - 1)) / ((l - m) * (l + m)));
      const b = l - 1 > m ? Math.sqrt(((2 * l + 1) * (l - 1 - m) * (l - 1 + m)) / ((2 * l - 3) * (l - m) * (l + m))) : 0;
      const next = a * x * last - b * before;
      before = last;
      last = next;
      out[index(order, l, m)] = next;
    }
  }
  return out;
}

export class Synthesis {
  /// For coefficients to degree `order`.
  constructor(grid, order) {
    this.grid = grid;
    this.order = order;
    this.functions = [];
    for (let ring = 0; ring < grid.rings; ++ring) this.functions.push(legendre(order, grid.theta(ring)));
    const n = grid.length;
    this.cosine = new Float64Array((order + 1) * n);
    this.sine = new Float64Array((order + 1) * n);
    for (let m = 0; m <= order; ++m)
      for (let j = 0; j < n; ++j) {
        const angle = (2 * Math.PI * ((m * j) % n)) / n;
        this.cosine[m * n + j] = Math.cos(angle);
        this.sine[m * n + j] = Math.sin(angle);
      }
  }

  /// A field's values at the vertices from its degrees 0 to `to`. `coefficients`: re, im by m, then l, to degree `order`.
  field(coefficients, to) {
    const { grid, order } = this;
    const n = grid.length;
    const values = new Float32Array(grid.vertices);
    const row = new Float64Array(n);
    for (let ring = 0; ring < grid.rings; ++ring) {
      const p = this.functions[ring];
      const pole = ring === 0 || ring === grid.rings - 1;
      row.fill(0);
      for (let m = 0; m <= (pole ? 0 : to); ++m) {
        let re = 0;
        let im = 0;
        for (let l = m; l <= to; ++l) {
          const at = index(order, l, m);
          re += p[at] * coefficients[2 * at];
          im += p[at] * coefficients[2 * at + 1];
        }
        if (m > 0) {
          re *= 2;
          im *= 2;
        }
        const base = m * n;
        for (let j = 0; j < n; ++j) row[j] += re * this.cosine[base + j] - im * this.sine[base + j];
      }
      if (pole) values[grid.vertex(ring, 0)] = row[0];
      else values.set(row, grid.vertex(ring, 0));
    }
    return values;
  }
}
