// Perceptually uniform colours, and what a value is on their scale.
import { interpolateCividis, interpolateViridis } from "d3-scale-chromatic";

const parsed = (text) =>
  text[0] === "#" ? [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16)) : text.match(/\d+/g).map(Number);

/// 256 colours, three bytes each.
function table(map) {
  const out = new Uint8Array(3 * 256);
  for (let i = 0; i < 256; ++i) out.set(parsed(map(i / 255)), 3 * i);
  return out;
}

const viridis = table(interpolateViridis);
const cividis = table(interpolateCividis);

/// Values to colours. Distances are drawn by their square root, which shows small ones beside large ones.
export class Scale {
  constructor([low, high], root) {
    this.low = low;
    this.high = high;
    this.root = root;
    this.colours = root ? cividis : viridis;
  }

  /// 0 to 1.
  part(value) {
    const part = Math.min(Math.max((value - this.low) / (this.high - this.low), 0), 1);
    return this.root ? Math.sqrt(part) : part;
  }

  value(part) {
    return this.low + (this.high - this.low) * (this.root ? part * part : part);
  }

  index(value) {
    return Math.round(255 * this.part(value)) || 0;
  }
}

/// sRGB bytes to light, for a renderer that reckons in light.
export const light = Float32Array.from({ length: 256 }, (_, i) => {
  const c = i / 255;
  return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
});
