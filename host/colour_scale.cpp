#include "host/colour_scale.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <vector>

namespace cowgpu {
namespace {

constexpr std::array<double, 3> grey = {0.55, 0.55, 0.55};
constexpr std::size_t left_out = 200; // one value in so many, at each end

// Every fifth of viridis' 256 colours.
constexpr std::uint32_t viridis_table[] = {
    0x440154, 0x46085c, 0x471063, 0x481769, 0x481d6f, 0x482475, 0x472a7a, 0x46307e, 0x453781, 0x433d84, 0x414287,
    0x3f4889, 0x3d4e8a, 0x3a538b, 0x38598c, 0x355e8d, 0x33638d, 0x31688e, 0x2e6d8e, 0x2c718e, 0x2a768e, 0x297b8e,
    0x27808e, 0x25848e, 0x23898e, 0x218e8d, 0x20928c, 0x1f978b, 0x1e9c89, 0x1fa188, 0x21a585, 0x24aa83, 0x28ae80,
    0x2eb37c, 0x35b779, 0x3dbc74, 0x46c06f, 0x50c46a, 0x5ac864, 0x65cb5e, 0x70cf57, 0x7cd250, 0x89d548, 0x95d840,
    0xa2da37, 0xb0dd2f, 0xbddf26, 0xcae11f, 0xd8e219, 0xe5e419, 0xf1e51d, 0xfde725};

std::array<double, 3> from_hex(std::uint32_t hex) {
  return {(hex >> 16) / 255.0, (hex >> 8 & 255) / 255.0, (hex & 255) / 255.0};
}

} // namespace

std::array<double, 3> viridis_colour(double t) {
  if (std::isnan(t)) return grey;
  const double place = std::clamp(t, 0.0, 1.0) * double(std::size(viridis_table) - 1);
  const auto i = std::min(std::size_t(place), std::size(viridis_table) - 2);
  const double part = place - double(i);
  const auto a = from_hex(viridis_table[i]), b = from_hex(viridis_table[i + 1]);
  return {a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1]), a[2] + part * (b[2] - a[2])};
}

double to_linear(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

double ColourRange::place(double value) const {
  if (std::isnan(value)) return value;
  // Halves, so that the difference of huge numbers stays finite.
  return high > low ? std::clamp((value / 2 - low / 2) / (high / 2 - low / 2), 0.0, 1.0) : 0.5;
}

ColourRange colour_range(std::span<const double> values) {
  std::vector<double> finite;
  finite.reserve(values.size());
  for (const double value : values)
    if (std::isfinite(value)) finite.push_back(value);
  if (finite.empty()) return {};
  const std::size_t cut = finite.size() / left_out;
  const auto low = finite.begin() + std::ptrdiff_t(cut), high = finite.end() - 1 - std::ptrdiff_t(cut);
  std::nth_element(finite.begin(), low, finite.end());
  const double least = *low;
  std::nth_element(finite.begin(), high, finite.end());
  return {least, *high};
}

} // namespace cowgpu
