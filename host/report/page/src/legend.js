// The bar of colours, with its numbers and unit.
import { el } from "./dom.js";
import { number } from "./format.js";

/// `scale`: a Scale; `title` and `unit` as text; `show(value)` makes a number of the bar.
export function drawBar(place, scale, title, show) {
  const canvas = el("canvas", { width: 256, height: 1, "aria-hidden": "true" });
  const context = canvas.getContext("2d");
  const image = context.createImageData(256, 1);
  for (let i = 0; i < 256; ++i) {
    image.data.set(scale.colours.subarray(3 * i, 3 * i + 3), 4 * i);
    image.data[4 * i + 3] = 255;
  }
  context.putImageData(image, 0, 0);
  const ticks = [0, 0.25, 0.5, 0.75, 1].map((part) => el("span", {}, show(scale.value(part))));
  place.replaceChildren(el("p", { class: "bar-title" }, title), canvas, el("div", { class: "bar-ticks" }, ...ticks));
}

export const barNumber = (value) => number(value, 3);
