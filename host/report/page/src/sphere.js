// The grid on the sphere: rings at theta_i = pi i / (rings - 1), points at phi_j = 2 pi j / length. Vertices are the north
// pole, the rings between from north to south, the south pole (triangulation() of host/spectrum/reconstruct.hpp).
export class SphereGrid {
  constructor(rings, length) {
    this.rings = rings;
    this.length = length;
    this.vertices = 2 + (rings - 2) * length;
  }

  theta(ring) {
    return (Math.PI * ring) / (this.rings - 1);
  }

  phi(j) {
    return (2 * Math.PI * j) / this.length;
  }

  vertex(ring, j) {
    if (ring <= 0) return 0;
    if (ring >= this.rings - 1) return this.vertices - 1;
    return 1 + (ring - 1) * this.length + (((j % this.length) + this.length) % this.length);
  }

  /// [theta, phi] of a vertex.
  angles(vertex) {
    if (vertex === 0) return [0, 0];
    if (vertex === this.vertices - 1) return [Math.PI, 0];
    return [this.theta(1 + Math.floor((vertex - 1) / this.length)), this.phi((vertex - 1) % this.length)];
  }

  /// Counter-clockwise seen from outside.
  faces() {
    const { rings, length } = this;
    const out = new Uint32Array(6 * length * (rings - 2));
    let at = 0;
    const face = (a, b, c) => {
      out[at++] = a;
      out[at++] = b;
      out[at++] = c;
    };
    for (let j = 0; j < length; ++j) face(0, this.vertex(1, j), this.vertex(1, j + 1));
    for (let i = 1; i + 2 < rings; ++i)
      for (let j = 0; j < length; ++j) {
        face(this.vertex(i, j), this.vertex(i + 1, j), this.vertex(i + 1, j + 1));
        face(this.vertex(i, j), this.vertex(i + 1, j + 1), this.vertex(i, j + 1));
      }
    for (let j = 0; j < length; ++j) face(this.vertex(rings - 2, j), this.vertices - 1, this.vertex(rings - 2, j + 1));
    return out;
  }

  /// Four vertices about a direction and their bilinear weights.
  about(theta, phi) {
    const u = Math.min(Math.max((theta / Math.PI) * (this.rings - 1), 0), this.rings - 1);
    const v = (phi / (2 * Math.PI)) * this.length;
    const i = Math.min(Math.floor(u), this.rings - 2);
    const j = Math.floor(v);
    const s = u - i;
    const t = v - j;
    return [
      [this.vertex(i, j), (1 - s) * (1 - t)],
      [this.vertex(i, j + 1), (1 - s) * t],
      [this.vertex(i + 1, j), s * (1 - t)],
      [this.vertex(i + 1, j + 1), s * t],
    ];
  }

  /// A field's value in a direction; `width` numbers a vertex.
  sample(values, theta, phi, width = 1) {
    const out = new Array(width).fill(0);
    for (const [vertex, weight] of this.about(theta, phi))
      for (let c = 0; c < width; ++c) out[c] += weight * values[width * vertex + c];
    return width === 1 ? out[0] : out;
  }
}

/// Unit vector of a direction, and back with 0 <= phi < 2 pi.
export const unit = (theta, phi) => [Math.sin(theta) * Math.cos(phi), Math.sin(theta) * Math.sin(phi), Math.cos(theta)];
export function angles([x, y, z]) {
  const phi = Math.atan2(y, x);
  return [Math.atan2(Math.hypot(x, y), z), phi < 0 ? phi + 2 * Math.PI : phi];
}
