// The bodies of a result: positions, colours and values at any order, also between two.
import { count } from "./data.js";
import { SphereGrid, unit } from "./sphere.js";
import { Synthesis } from "./synthesis.js";

export const fieldNames = ["f_r", "f_dtheta", "f_dphi", "x", "y", "z"];
const cacheBytes = 96e6;

/// Keeps the arrays that were used last.
class Cache {
  constructor(most) {
    this.most = most;
    this.bytes = 0;
    this.entries = new Map();
  }

  get(key, make) {
    let value = this.entries.get(key);
    if (value) this.entries.delete(key);
    else {
      value = make();
      this.bytes += value.byteLength;
    }
    this.entries.set(key, value);
    for (const [old, array] of this.entries) {
      if (this.bytes <= this.most || old === key) break;
      this.entries.delete(old);
      this.bytes -= array.byteLength;
    }
    return value;
  }
}

function between(a, b, t) {
  if (t === 0) return a;
  const out = new Float32Array(a.length);
  for (let i = 0; i < a.length; ++i) out[i] = a[i] + t * (b[i] - a[i]);
  return out;
}

export class Model {
  constructor(data) {
    this.data = data;
    this.grid = new SphereGrid(data.grid.rings, data.grid.ring_length);
    this.cache = new Cache(cacheBytes);
    this.syntheses = new Map();
  }

  synthesis(order) {
    if (!this.syntheses.has(order)) this.syntheses.set(order, new Synthesis(this.grid, order));
    return this.syntheses.get(order);
  }

  /// Field `f` of degrees 0 to `order`, the removed mean of an angle put back.
  field(surface, f, order) {
    return this.cache.get(`${surface.name}/${f}/${order}`, () => {
      const all = 2 * count(surface.order);
      const values = this.synthesis(surface.order).field(surface.coefficients.subarray(f * all, (f + 1) * all), order);
      const mean = f === 1 ? surface.means[0] : f === 2 ? surface.means[1] : 0;
      if (mean !== 0) for (let i = 0; i < values.length; ++i) values[i] += mean;
      return values;
    });
  }

  /// x, y, z of every vertex. Order 0 is the sphere about the origin.
  bodyAt(surface, shape, order) {
    return this.cache.get(`${surface.name}/${shape}/body/${order}`, () => {
      const out = new Float32Array(3 * this.grid.vertices);
      const [ox, oy, oz] = surface.origin;
      if (order > 0 && shape === "xyz") {
        for (let c = 0; c < 3; ++c) {
          const values = this.field(surface, 3 + c, order);
          for (let i = 0; i < values.length; ++i) out[3 * i + c] = values[i];
        }
        return out;
      }
      const zero = order === 0;
      const r = zero ? null : this.field(surface, 0, order);
      const dtheta = zero ? null : this.field(surface, 1, order);
      const dphi = zero ? null : this.field(surface, 2, order);
      for (let i = 0; i < this.grid.vertices; ++i) {
        const [theta, phi] = this.grid.angles(i);
        const [x, y, z] = zero ? unit(theta, phi) : unit(theta + dtheta[i], phi + dphi[i]);
        const length = zero ? surface.radius : r[i];
        out[3 * i] = ox + length * x;
        out[3 * i + 1] = oy + length * y;
        out[3 * i + 2] = oz + length * z;
      }
      return out;
    });
  }

  positions(surface, shape, order) {
    const low = Math.floor(order);
    const t = order - low;
    const a = this.bodyAt(surface, shape, low);
    return t === 0 ? a : between(a, this.bodyAt(surface, shape, low + 1), t);
  }

  /// Values of a component: a field's name or "distance".
  values(surface, shape, component, order) {
    const low = Math.floor(order);
    const at = (l) =>
      component === "distance" ? surface.distances[shape][l].values : this.field(surface, fieldNames.indexOf(component), l);
    return order === low ? at(low) : between(at(low), at(low + 1), order - low);
  }

  hasDistance(surface, shape) {
    return surface.distances[shape].length > 0;
  }

  /// Largest distance and root mean square at an order, of whole orders; null where no mesh is known.
  distance(surface, shape, order) {
    return surface.distances[shape][Math.round(order)] ?? null;
  }

  /// The range of colours: of a field that of its highest order, so that orders compare; of distances 0 to the largest now.
  range(surface, shape, component, order) {
    const values = this.values(surface, shape, component, component === "distance" ? order : surface.order);
    let low = Infinity;
    let high = -Infinity;
    for (const value of values) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
    if (component === "distance") low = 0;
    return high > low ? [low, high] : [low - 1, high + 1];
  }

  /// To frame a body at every order: the middle of its box at the highest, and a radius about it that holds it then and as
  /// a sphere.
  frame(surface, shape) {
    const frame = frameOf(this.bodyAt(surface, shape, surface.order));
    const off = Math.hypot(...surface.origin.map((value, c) => value - frame.centre[c]));
    return { centre: frame.centre, radius: Math.max(frame.radius, off + surface.radius) };
  }
}

/// The middle of points' box, and the largest distance from it.
export function frameOf(points) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < points.length; ++i) {
    low[i % 3] = Math.min(low[i % 3], points[i]);
    high[i % 3] = Math.max(high[i % 3], points[i]);
  }
  const centre = low.map((value, c) => (value + high[c]) / 2);
  let radius = 0;
  for (let i = 0; i < points.length; i += 3)
    radius = Math.max(radius, Math.hypot(points[i] - centre[0], points[i + 1] - centre[1], points[i + 2] - centre[2]));
  return { centre, radius: radius || 1 };
}

/// Normals of vertices, by the areas of the faces about them.
export function normals(points, faces, out = new Float32Array(points.length)) {
  out.fill(0);
  for (let f = 0; f < faces.length; f += 3) {
    const a = 3 * faces[f];
    const b = 3 * faces[f + 1];
    const c = 3 * faces[f + 2];
    const ux = points[b] - points[a];
    const uy = points[b + 1] - points[a + 1];
    const uz = points[b + 2] - points[a + 2];
    const vx = points[c] - points[a];
    const vy = points[c + 1] - points[a + 1];
    const vz = points[c + 2] - points[a + 2];
    const x = uy * vz - uz * vy;
    const y = uz * vx - ux * vz;
    const z = ux * vy - uy * vx;
    for (const v of [a, b, c]) {
      out[v] += x;
      out[v + 1] += y;
      out[v + 2] += z;
    }
  }
  for (let i = 0; i < out.length; i += 3) {
    const length = Math.hypot(out[i], out[i + 1], out[i + 2]) || 1;
    out[i] /= length;
    out[i + 1] /= length;
    out[i + 2] /= length;
  }
  return out;
}
