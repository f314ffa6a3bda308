// The data that `cowgpu report` puts into the page (host/report/page.hpp): JSON with lists as base64.

/// The bytes of a base64 text.
export function bytes(text) {
  const raw = atob(text);
  const out = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; ++i) out[i] = raw.charCodeAt(i);
  return out;
}

const doubles = (text) => new Float64Array(bytes(text).buffer);

/// Where (l, m) stands within a field: sorted by m, then l.
export const index = (lmax, l, m) => (m * (2 * lmax + 1 - m)) / 2 + l;
export const count = (lmax) => ((lmax + 1) * (lmax + 2)) / 2;

/// The document with its lists decoded. Coefficients: by field, index(order, l, m), re and im.
export function read(text) {
  const data = JSON.parse(text);
  if (data.schema !== "cowgpu.page.v1") throw new Error("This page holds no result: `cowgpu report` puts one in.");
  for (const surface of data.surfaces) {
    surface.coefficients = doubles(surface.coefficients);
    for (const shape of ["xyz", "f"])
      for (const distance of surface.distances[shape]) {
        const roots = bytes(distance.roots);
        distance.values = Float32Array.from(roots, (root) => distance.largest * (root / 255) ** 2);
        delete distance.roots;
      }
  }
  if (data.mass) data.mass.coefficients = doubles(data.mass.coefficients);
  if (data.mesh) {
    data.mesh.vertices = new Float32Array(bytes(data.mesh.vertices).buffer);
    data.mesh.faces = new Uint32Array(bytes(data.mesh.faces).buffer);
  }
  if (data.values) {
    data.values.places = new Float32Array(bytes(data.values.places).buffer);
    for (const column of data.values.columns) column.values = new Float32Array(bytes(column.values).buffer);
  }
  return data;
}
