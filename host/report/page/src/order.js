// The slider of the order, its box of numbers, and the button that plays through the orders.
import { $, el, reducedMotion } from "./dom.js";

const sweepSeconds = 12; // of "play", all orders
const stepMilliseconds = 700; // of one order where motion is not welcome

export class OrderSlider {
  /// `changed(order)` draws, and returns what the order is, in words.
  constructor(changed) {
    this.changed = changed;
    this.largest = 0;
    this.order = 0;
    this.playing = false;
    $("order").addEventListener("input", () => {
      this.stop();
      this.set(this.at(Number($("order").value)), { slider: false });
    });
    $("order").addEventListener("keydown", (event) => this.key(event));
    $("order-number").addEventListener("input", () => {
      const order = Number($("order-number").value);
      if ($("order-number").value === "" || !Number.isFinite(order)) return;
      this.stop();
      this.set(order, { box: order < 0 || order > this.largest });
    });
    $("play").addEventListener("click", () => (this.playing ? this.stop() : this.play()));
  }

  // Low orders, which change most, have most room.
  get power() {
    return this.largest > 8 ? 2 : 1;
  }

  /// The slider's place of an order, 0 to 1000, and back.
  place(order) {
    return 1000 * Math.pow(order / Math.max(this.largest, 1), 1 / this.power);
  }

  at(place) {
    return this.largest * Math.pow(place / 1000, this.power);
  }

  setLargest(largest) {
    this.largest = largest;
    $("order-number").max = largest;
    $("order").setAttribute("aria-label", `Order of the body, 0 to ${largest}`);
    const named = [0, 1, 2, 4, 8, 16, 32, 64, 128].filter((l) => l < 0.85 * largest).concat(largest);
    $("order-ticks").replaceChildren(
      ...named.map((l) => {
        const tick = el("span", {}, String(l));
        tick.style.left = `${this.place(l) / 10}%`;
        return tick;
      }),
    );
  }

  /// An order, whole or between two; `slider` and `box` say which of both follows.
  set(order, { slider = true, box = true } = {}) {
    this.order = Math.min(Math.max(order, 0), this.largest);
    const whole = Math.round(this.order);
    const on = Math.abs(this.order - whole) < 0.005;
    if (on) this.order = whole;
    if (slider) $("order").value = Math.round(this.place(this.order));
    if (box) $("order-number").value = on ? whole : this.order.toFixed(2);
    $("order").setAttribute("aria-valuetext", this.changed(this.order));
  }

  key(event) {
    const { order } = this;
    const to = {
      ArrowRight: Math.floor(order) + 1,
      ArrowUp: Math.floor(order) + 1,
      ArrowLeft: Math.ceil(order) - 1,
      ArrowDown: Math.ceil(order) - 1,
      PageUp: Math.floor(order) + 8,
      PageDown: Math.ceil(order) - 8,
      Home: 0,
      End: this.largest,
    }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    this.stop();
    this.set(to);
  }

  stop() {
    this.playing = false;
    this.showPlaying();
  }

  showPlaying() {
    $("play").setAttribute("aria-pressed", String(this.playing));
    $("play").querySelector("b").textContent = this.playing ? "Pause" : "Play";
  }

  play() {
    this.playing = true;
    this.showPlaying();
    if (this.order >= this.largest) this.set(0);
    let last = performance.now();
    const next = (now) => {
      if (!this.playing) return;
      const gone = now - last;
      if (!reducedMotion()) {
        last = now;
        this.set(this.at(Math.min(this.place(this.order) + Math.min(gone, 200) / sweepSeconds, 1000)));
      } else if (gone >= stepMilliseconds) {
        last = now;
        this.set(Math.floor(this.order) + 1);
      }
      if (this.order >= this.largest) this.stop();
      else requestAnimationFrame(next);
    };
    requestAnimationFrame(next);
  }
}
