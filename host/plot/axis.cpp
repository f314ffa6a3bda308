#include "host/plot/axis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cowgpu::plot {
namespace {

constexpr double largest = 1e300, margin = 0.04;

std::string with_minus(std::string number) {
  if (number.find_first_not_of("-0.") == std::string::npos && !number.empty() && number[0] == '-') number.erase(0, 1);
  if (!number.empty() && number[0] == '-') number.replace(0, 1, "−");
  return number;
}

/// i times 10^e, rounded once where that can be.
double decimal(double i, int e) {
  if (e >= 0) return i * std::pow(10.0, e);
  return e >= -300 ? i / std::pow(10.0, -e) : i / 1e300 / std::pow(10.0, -e - 300);
}

Ticks linear_ticks(const Range& range, int most) {
  const double raw = (range.high / most - range.low / most);
  int e = int(std::floor(std::log10(raw)));
  int k = 1;
  double first = 0, last = 0;
  // The step grows until no more than `most` ticks are left.
  for (const int grown : {1, 2, 5, 10, 20, 50}) {
    k = grown;
    const double step = decimal(k, e), slack = 1e-9 * (range.high / step - range.low / step);
    first = std::ceil(range.low / step - slack);
    last = std::floor(range.high / step + slack);
    if (last - first + 1 <= most) break;
  }
  const double end = std::max(std::abs(decimal(first * k, e)), std::abs(decimal(last * k, e)));
  while (k >= 10) k /= 10, ++e;
  Ticks found;
  if (end > 0 && (end >= 1e5 || end < 0.9e-3)) found.power = int(std::floor(std::log10(end) + 1e-12));
  const int decimals = std::max(0, found.power - e);
  for (double i = first; i <= last; ++i) {
    // Labels from the whole numbers themselves: they stay right at any power.
    const double label = decimal(i * k, e - found.power);
    found.ticks.push_back({decimal(i * k, e), with_minus(fmt::format("{:.{}f}", label, decimals))});
  }
  return found;
}

std::string decade_label(int k, bool plain) {
  if (!plain) return fmt::format("10$^{{{}}}$", with_minus(std::to_string(k)));
  return k >= 0 ? fmt::format("{:.0f}", std::pow(10.0, k)) : fmt::format("{:.{}f}", std::pow(10.0, k), -k);
}

Ticks logarithmic_ticks(const Range& range, int most) {
  const double low = std::log10(range.low), high = std::log10(range.high);
  if (high - low < 1) return linear_ticks(range, most);
  const int first = int(std::ceil(low - 1e-9)), last = int(std::floor(high + 1e-9));
  const int needed = (last - first + most) / most;
  int stride = 1;
  for (const int nice : {1, 2, 3, 5, 10, 20, 50, 100, 200, 300})
    if (stride < needed) stride = nice;
  const bool plain = first >= -2 && last <= 3, few = last - first <= 2 && 3 * (last - first + 1) <= most;
  Ticks found;
  for (int k = first - 1; k <= last; ++k)
    for (int i = 1; i < 10; ++i) {
      const double at = decimal(i, k);
      if (at < range.low * (1 - 1e-9) || at > range.high * (1 + 1e-9)) continue;
      if (i == 1) {
        const bool labelled = ((k % stride) + stride) % stride == 0;
        if (labelled || stride <= 5) found.ticks.push_back({at, labelled ? decade_label(k, plain) : ""});
      } else if (stride == 1 && last - first <= 12) {
        const bool labelled = few && (i == 2 || i == 5);
        std::string label;
        if (labelled && plain) label = k >= 0 ? fmt::format("{:.0f}", at) : fmt::format("{:.{}f}", at, -k);
        if (labelled && !plain) label = fmt::format("{}·{}", i, decade_label(k, false));
        found.ticks.push_back({at, label});
      }
    }
  return found;
}

} // namespace

bool shown(double value, Scale scale) {
  return std::abs(value) <= largest && (scale == Scale::linear || value >= 1 / largest);
}

Range axis_range(const Axis& axis, std::span<const std::span<const double>> values) {
  const Scale scale = axis.scale;
  const bool logarithmic = scale == Scale::logarithmic;
  double low = largest, high = -largest;
  bool any = false;
  for (const std::span<const double> part : values)
    for (const double value : part)
      if (shown(value, scale)) {
        any = true;
        low = std::min(low, value);
        high = std::max(high, value);
      }
  // Ends that are named count as data do, and come back unchanged.
  const bool has_low = shown(axis.low, scale), has_high = shown(axis.high, scale);
  if (!any) {
    low = has_low ? axis.low : has_high ? (logarithmic ? axis.high / 10 : axis.high - 1) : logarithmic ? 1 : 0;
    high = has_high ? axis.high : logarithmic ? low * 10 : low + 1;
  } else {
    if (has_low) low = axis.low;
    if (has_high) high = axis.high;
  }
  if (low > high) std::swap(low, high);

  Range range{low, high};
  if (logarithmic) {
    const double decades = std::log10(high) - std::log10(low);
    const double widened = decades > 1e-9 ? std::pow(10.0, margin * decades) : 10;
    if (!any && decades > 1e-9) return range;
    if (!has_low || decades <= 1e-9) range.low = std::max(low / widened, 1 / largest);
    if (!has_high || decades <= 1e-9) range.high = std::min(high * widened, largest);
    return range;
  }
  const double size = std::max(std::abs(low), std::abs(high)), half = high / 2 - low / 2;
  // Below that rounding would put ticks on top of each other.
  const bool equal = half <= std::max(1e-11 * size, 1e-280);
  const double widened = !equal ? 2 * margin * half : size > 1e-270 ? 0.1 * size : 1;
  if (!any && !equal) return range;
  if (!has_low || equal) range.low = std::max(low - widened, -largest);
  if (!has_high || equal) range.high = std::min(high + widened, largest);
  return range;
}

double axis_place(double value, const Range& range, Scale scale) {
  constexpr double far = 1e7; // as far off as anything need be
  if (scale == Scale::linear)
    return std::clamp((value / 2 - range.low / 2) / (range.high / 2 - range.low / 2), -far, far);
  const double low = std::log10(range.low), high = std::log10(range.high);
  return std::clamp((std::log10(value) - low) / (high - low), -far, far);
}

Ticks axis_ticks(const Range& range, Scale scale, int most) {
  most = std::max(most, 2);
  return scale == Scale::linear ? linear_ticks(range, most) : logarithmic_ticks(range, most);
}

} // namespace cowgpu::plot
