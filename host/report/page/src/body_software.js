// The body without WebGL: triangles into a buffer of depths, on a 2-D canvas. The same members as body_webgl.js.
import { colour } from "./dom.js";

const fieldOfView = 26;
const background = 0xffffffff;

export class SoftwareBody {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.points = this.overlay = this.ghost = this.marker = null;
    this.frame = { centre: [0, 0, 0], radius: 1 };
  }

  setFaces(faces, vertices) {
    this.faces = faces;
    this.colours = new Uint8Array(3 * vertices);
    this.screen = new Float32Array(3 * vertices);
  }

  setShape(positions, normals) {
    this.points = positions;
    this.normals = normals.slice();
  }

  setColours(indices, table) {
    for (let i = 0; i < indices.length; ++i) for (let c = 0; c < 3; ++c) this.colours[3 * i + c] = table[3 * indices[i] + c];
  }

  setLines(points) {
    this.overlay = points;
  }

  setGhost(points) {
    this.ghost = points;
  }

  setMarker(point) {
    this.marker = point;
  }

  frameAt(frame) {
    this.frame = frame;
  }

  theme() {}

  resize(width, height, ratio) {
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
  }

  /// Axes of the picture, and the function from a point to pixel and depth.
  project(view) {
    const { width, height } = this.canvas;
    const { centre, radius } = this.frame;
    const d = view.direction();
    const right = [d[2] / Math.hypot(d[0], d[2]), 0, -d[0] / Math.hypot(d[0], d[2])];
    const up = [d[1] * right[2] - d[2] * right[1], d[2] * right[0] - d[0] * right[2], d[0] * right[1] - d[1] * right[0]];
    const tangent = Math.tan((fieldOfView * Math.PI) / 360);
    const away = (0.9 * radius) / Math.sin(Math.atan(tangent * Math.min(1, width / height))) / view.zoom;
    const scale = height / 2 / tangent;
    const dot = (a, x, y, z) => a[0] * x + a[1] * y + a[2] * z;
    this.axes = { right, up, d };
    return (x, y, z, out, at) => {
      x -= centre[0];
      y -= centre[1];
      z -= centre[2];
      const depth = away - dot(d, x, y, z);
      out[at] = width / 2 + (scale * dot(right, x, y, z)) / depth;
      out[at + 1] = height / 2 - (scale * dot(up, x, y, z)) / depth;
      out[at + 2] = depth;
    };
  }

  draw(view) {
    if (!this.points) return;
    const { width, height } = this.canvas;
    const place = this.project(view);
    const { points, screen, faces } = this;
    for (let i = 0; i < points.length; i += 3) place(points[i], points[i + 1], points[i + 2], screen, i);
    const image = this.context.createImageData(width, height);
    this.depth = new Float32Array(width * height).fill(Infinity);
    this.owner = new Uint32Array(width * height).fill(background);
    for (let f = 0; f < faces.length; f += 3) this.triangle(f, image.data);
    this.context.putImageData(image, 0, 0);
    this.segments(this.overlay, place, colour("--body-lines"), 0.35);
    this.segments(this.ghost, place, colour("--ghost"), 0.2);
    if (this.marker) this.dot(place);
  }

  // The light of a vertex: from the upper left of the eye, and some from everywhere.
  shade(v) {
    const { right, up, d } = this.axes;
    const n = this.normals;
    const dot = (a) => a[0] * n[v] + a[1] * n[v + 1] + a[2] * n[v + 2];
    const facing = dot(d) < 0 ? -1 : 1;
    const lamp = (facing * (-0.41 * dot(right) + 0.68 * dot(up) + 0.61 * dot(d))) / 1.0;
    return Math.min(1, 0.62 + 0.46 * Math.max(0, lamp));
  }

  triangle(f, data) {
    const { screen: s, colours, faces, depth, owner } = this;
    const { width, height } = this.canvas;
    const corners = [3 * faces[f], 3 * faces[f + 1], 3 * faces[f + 2]];
    const [a, b, c] = corners;
    const twice = (s[b] - s[a]) * (s[c + 1] - s[a + 1]) - (s[c] - s[a]) * (s[b + 1] - s[a + 1]);
    if (!twice) return;
    const x0 = Math.max(0, Math.floor(Math.min(s[a], s[b], s[c])));
    const x1 = Math.min(width - 1, Math.ceil(Math.max(s[a], s[b], s[c])));
    const y0 = Math.max(0, Math.floor(Math.min(s[a + 1], s[b + 1], s[c + 1])));
    const y1 = Math.min(height - 1, Math.ceil(Math.max(s[a + 1], s[b + 1], s[c + 1])));
    const shades = corners.map((v) => this.shade(v));
    for (let y = y0; y <= y1; ++y)
      for (let x = x0; x <= x1; ++x) {
        const px = x + 0.5;
        const py = y + 0.5;
        const u = ((s[b] - px) * (s[c + 1] - py) - (s[c] - px) * (s[b + 1] - py)) / twice;
        const v = ((s[c] - px) * (s[a + 1] - py) - (s[a] - px) * (s[c + 1] - py)) / twice;
        const w = 1 - u - v;
        if (u < 0 || v < 0 || w < 0) continue;
        const z = u * s[a + 2] + v * s[b + 2] + w * s[c + 2];
        const at = y * width + x;
        if (z >= depth[at]) continue;
        depth[at] = z;
        owner[at] = f;
        const bright = u * shades[0] + v * shades[1] + w * shades[2];
        for (let k = 0; k < 3; ++k) data[4 * at + k] = bright * (u * colours[a + k] + v * colours[b + k] + w * colours[c + k]);
        data[4 * at + 3] = 255;
      }
  }

  segments(points, place, stroke, opacity) {
    if (!points) return;
    const { context } = this;
    const ends = [0, 0, 0, 0, 0, 0];
    context.beginPath();
    for (let i = 0; i + 5 < points.length; i += 6) {
      place(points[i], points[i + 1], points[i + 2], ends, 0);
      place(points[i + 3], points[i + 4], points[i + 5], ends, 3);
      if (this.hidden(ends)) continue;
      context.moveTo(ends[0], ends[1]);
      context.lineTo(ends[3], ends[4]);
    }
    context.globalAlpha = opacity;
    context.strokeStyle = stroke;
    context.stroke();
    context.globalAlpha = 1;
  }

  hidden(ends) {
    const x = Math.round((ends[0] + ends[3]) / 2);
    const y = Math.round((ends[1] + ends[4]) / 2);
    const depth = this.depth[y * this.canvas.width + x];
    return depth !== undefined && depth < (ends[2] + ends[5]) / 2 - 0.015 * this.frame.radius;
  }

  dot(place) {
    const at = [0, 0, 0];
    place(...this.marker, at, 0);
    this.context.beginPath();
    this.context.arc(at[0], at[1], 5, 0, 2 * Math.PI);
    this.context.fillStyle = colour("--marker");
    this.context.fill();
  }

  pick([x, y]) {
    const { width, height } = this.canvas;
    const px = Math.floor(((x + 1) / 2) * width);
    const py = Math.floor(((1 - y) / 2) * height);
    const f = this.owner?.[py * width + px];
    if (f === undefined || f === background) return null;
    return { corners: [...this.faces.slice(f, f + 3)], weights: [1 / 3, 1 / 3, 1 / 3] };
  }
}
