// A canvas with a body on it: by WebGL, or by hand where there is none.
import { SoftwareBody } from "./body_software.js";
import { WebglBody } from "./body_webgl.js";
import { el } from "./dom.js";
import { View } from "./view.js";

/// {body, view} in the element `place` of the panel `panel`; `changed()` when the view or the size did, `hover` as in View.
export function bodyCanvas(place, panel, label, changed, hover) {
  let canvas = el("canvas", { tabindex: "0", role: "img", "aria-label": label });
  let body;
  try {
    body = new WebglBody(canvas);
    place.dataset.by = "webgl";
  } catch {
    canvas = canvas.cloneNode();
    body = new SoftwareBody(canvas);
    place.dataset.by = "software";
    panel.append(el("p", { class: "quiet" }, "WebGL is not available, so the body is drawn without it, more slowly."));
  }
  place.append(canvas);
  const view = new View(canvas, changed, hover);
  canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
  fit(place, (width, height, ratio) => {
    body.resize(width, height, ratio);
    changed();
  });
  return { body, view };
}

/// Calls `resize` with an element's size and the pixels of a CSS pixel, now and when it changes.
export function fit(element, resize) {
  const now = () => {
    const { clientWidth, clientHeight } = element;
    if (clientWidth > 0 && clientHeight > 0) resize(clientWidth, clientHeight, Math.min(devicePixelRatio || 1, 2));
  };
  now();
  new ResizeObserver(now).observe(element);
}
