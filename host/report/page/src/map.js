// The sphere of directions in Mollweide's projection, on a canvas: colours, the grid, a point that is marked.
import { geoGraticule, geoPath } from "d3-geo";
import { geoMollweide } from "d3-geo-projection";
import { colour } from "./dom.js";

const rasterWidth = 720;
const rasterHeight = 360;
const margin = 2; // of the outline's stroke, css pixels

/// Where in the raster a direction lies, longitude 0 in the middle, growing to the right, north up.
const flat = () => geoMollweide().precision(0.1);
const toAngles = ([lambda, psi]) => [((90 - psi) * Math.PI) / 180, ((((lambda % 360) + 360) % 360) * Math.PI) / 180];
const toLonLat = ([theta, phi]) => {
  const lambda = (phi * 180) / Math.PI;
  return [lambda > 180 ? lambda - 360 : lambda, 90 - (theta * 180) / Math.PI];
};

export class SphereMap {
  constructor(canvas, grid) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.grid = grid;
    this.raster = document.createElement("canvas");
    this.raster.width = rasterWidth;
    this.raster.height = rasterHeight;
    this.image = this.raster.getContext("2d").createImageData(rasterWidth, rasterHeight);
    this.graticule = true;
    this.prepare();
  }

  // The four vertices about every pixel and their weights. Pixels beyond the outline take its colour, for smooth edges.
  prepare() {
    const projection = flat().fitSize([rasterWidth, rasterHeight], { type: "Sphere" });
    const radius = projection([180 - 1e-9, 0])[0] - rasterWidth / 2;
    const pixels = rasterWidth * rasterHeight;
    this.corners = new Uint32Array(4 * pixels);
    this.weights = new Float32Array(4 * pixels);
    for (let y = 0; y < rasterHeight; ++y) {
      const sine = Math.min(1, Math.abs(y + 0.5 - rasterHeight / 2) / (radius / 2));
      const reach = radius * Math.sqrt(1 - sine * sine) * (1 - 1e-6);
      for (let x = 0; x < rasterWidth; ++x) {
        const inside = Math.min(Math.max(x + 0.5 - rasterWidth / 2, -reach), reach) + rasterWidth / 2;
        const [theta, phi] = toAngles(projection.invert([inside, y + 0.5]));
        const at = 4 * (y * rasterWidth + x);
        this.grid.about(Number.isFinite(theta) ? theta : 0, Number.isFinite(phi) ? phi : 0).forEach(([vertex, weight], k) => {
          this.corners[at + k] = vertex;
          this.weights[at + k] = weight;
        });
      }
    }
  }

  setValues(values, scale) {
    const { data } = this.image;
    const { corners, weights } = this;
    for (let i = 0; i < corners.length; i += 4) {
      let value = 0;
      for (let k = 0; k < 4; ++k) value += weights[i + k] * values[corners[i + k]];
      const at = 3 * scale.index(value);
      data[i] = scale.colours[at];
      data[i + 1] = scale.colours[at + 1];
      data[i + 2] = scale.colours[at + 2];
      data[i + 3] = 255;
    }
    this.raster.getContext("2d").putImageData(this.image, 0, 0);
  }

  resize(width, height, ratio) {
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.ratio = ratio;
    this.size = [width, height];
    this.projection = flat().fitExtent(
      [
        [margin, margin],
        [width - margin, height - margin],
      ],
      { type: "Sphere" },
    );
  }

  draw() {
    if (!this.projection) return;
    const { context, projection } = this;
    const [width, height] = this.size;
    const path = geoPath(projection, context);
    const outline = (shape) => {
      context.beginPath();
      path(shape);
    };
    context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    const [[x0, y0], [x1, y1]] = geoPath(projection).bounds({ type: "Sphere" });
    context.save();
    outline({ type: "Sphere" });
    context.clip();
    context.imageSmoothingQuality = "high";
    context.drawImage(this.raster, x0, y0, x1 - x0, y1 - y0);
    context.restore();
    if (this.graticule) {
      outline(
        geoGraticule()
          .step([30, 30])
          .extent([
            [-180, -89.9],
            [180, 89.9],
          ])(),
      );
      context.strokeStyle = colour("--map-lines");
      context.lineWidth = 0.8;
      context.stroke();
    }
    outline({ type: "Sphere" });
    context.strokeStyle = colour("--line-strong");
    context.lineWidth = 1.2;
    context.stroke();
    if (this.mark) this.drawMark();
  }

  drawMark() {
    const { context } = this;
    const [x, y] = this.projection(toLonLat(this.mark));
    for (const [radius, width, stroke] of [
      [7, 4, colour("--marker-rim")],
      [7, 2, colour("--marker")],
    ]) {
      context.beginPath();
      context.arc(x, y, radius, 0, 2 * Math.PI);
      context.lineWidth = width;
      context.strokeStyle = stroke;
      context.stroke();
    }
  }

  /// The direction [theta, phi] under a point of the canvas in css pixels, or null beyond the outline.
  direction(x, y) {
    const back = this.projection.invert([x, y]);
    if (!back || !back.every(Number.isFinite) || Math.abs(back[0]) > 180 || Math.abs(back[1]) > 90) return null;
    const there = this.projection(back);
    return Math.hypot(there[0] - x, there[1] - y) < 0.5 ? toAngles(back) : null;
  }

  /// Where a direction is drawn, css pixels.
  place(direction) {
    return this.projection(toLonLat(direction));
  }
}
