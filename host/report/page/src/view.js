// What both drawings of the body share: where one looks from, and mouse, touch and keys that change it.
import { announce } from "./dom.js";

const limit = Math.PI / 2 - 0.02;

export class View {
  /// `element` gets pointer and keys; `changed()` draws again; `hover(x, y)` has the pointer in [-1, 1], y up, or null.
  constructor(element, changed, hover) {
    this.azimuth = 0.5; // about y, from the side
    this.elevation = 0.24;
    this.zoom = 1;
    this.changed = changed;
    const pointers = new Map();
    let spread = 0;
    element.addEventListener("pointerdown", (event) => {
      element.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
      spread = 0;
    });
    element.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) {
        const box = element.getBoundingClientRect();
        hover([(2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height]);
        return;
      }
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
      if (pointers.size === 2) {
        const [a, b] = [...pointers.values()];
        const now = Math.hypot(a[0] - b[0], a[1] - b[1]);
        if (spread > 0) this.zoomBy(now / spread);
        spread = now;
      } else this.turn((event.clientX - before[0]) / 160, (event.clientY - before[1]) / 160);
    });
    for (const end of ["pointerup", "pointercancel"])
      element.addEventListener(end, (event) => pointers.delete(event.pointerId));
    element.addEventListener("pointerleave", () => hover(null));
    element.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.zoomBy(Math.exp(-event.deltaY / 600));
      },
      { passive: false },
    );
    element.addEventListener("keydown", (event) => {
      const step = event.shiftKey ? 0.02 : 0.1;
      const act = {
        ArrowLeft: () => this.turn(-step, 0),
        ArrowRight: () => this.turn(step, 0),
        ArrowUp: () => this.turn(0, -step),
        ArrowDown: () => this.turn(0, step),
        "+": () => this.zoomBy(1.1),
        "=": () => this.zoomBy(1.1),
        "-": () => this.zoomBy(1 / 1.1),
        Home: () => this.reset(),
      }[event.key];
      if (!act) return;
      event.preventDefault();
      act();
      clearTimeout(this.said);
      this.said = setTimeout(() => announce(this.words()), 400);
    });
  }

  words() {
    const whole = (angle) => Math.round((angle * 180) / Math.PI);
    return `Seen from azimuth ${((whole(this.azimuth) % 360) + 360) % 360} degrees, elevation ${whole(this.elevation)} degrees.`;
  }

  turn(right, down) {
    this.azimuth -= right;
    this.elevation = Math.min(Math.max(this.elevation + down, -limit), limit);
    this.changed();
  }

  zoomBy(factor) {
    this.zoom = Math.min(Math.max(this.zoom * factor, 0.4), 8);
    this.changed();
  }

  reset() {
    this.azimuth = 0.5;
    this.elevation = 0.24;
    this.zoom = 1;
    this.changed();
  }

  /// From the body to the eye; y is up, and azimuth 0 looks along -z.
  direction() {
    const c = Math.cos(this.elevation);
    return [c * Math.sin(this.azimuth), Math.sin(this.elevation), c * Math.cos(this.azimuth)];
  }
}
