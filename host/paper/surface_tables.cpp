#include "host/paper/surface_tables.hpp"

#include "host/error.hpp"

#include <algorithm>
#include <cmath>

namespace cowgpu {
namespace {

constexpr PaperRow harmonic[] = {
    {0, 0, {{{0.5825, 0}, {0, 0}, {0, 0}}}},
    {1, 0, {{{-0.0996, 0}, {2.5793, 0}, {-0.4817, 0}}}},
    {1, 1, {{{0.0237, 0.0}, {-0.3161, 1.66}, {0.475, 0.4784}}}},
    {2, 0, {{{0.0106, 0}, {-0.0125, 0}, {-0.2309, 0}}}},
    {2, 1, {{{0.0193, 0.0061}, {0.0425, -0.2846}, {0.1581, 1.5432}}}},
    {2, 2, {{{0.0591, 0.0193}, {0.1197, -0.18}, {0.8938, -0.0098}}}},
    {3, 0, {{{0.0005, 0}, {0.1995, 0}, {0.2132, 0}}}},
    {3, 1, {{{-0.002, 0.0003}, {0.0226, -0.0683}, {0.1065, -0.3695}}}},
    {3, 2, {{{-0.0358, -0.0127}, {-0.0657, 0.0821}, {-0.2082, -0.0496}}}},
    {3, 3, {{{-0.0083, -0.0094}, {-0.0272, 0.0286}, {-0.1859, 0.19}}}},
};

constexpr PaperRow flow[] = {
    {0, 0, {{{1.075, 0}, {0, 0}, {0, 0}}}},
    {1, 0, {{{0.001, 0}, {0.734, 0}, {0.0016, 0}}}},
    {1, 1, {{{0.0567, 0.0145}, {-0.0008, 0.0045}, {0.0236, -0.0683}}}},
    {2, 0, {{{-0.2681, 0}, {0.0051, 0}, {0.2863, 0}}}},
    {2, 1, {{{-0.0007, -0.0006}, {-0.0085, 0.0474}, {0.0006, -0.0045}}}},
    {2, 2, {{{0.1178, -0.0438}, {0.001, -0.0006}, {-0.1602, -0.0209}}}},
    {3, 0, {{{0.0008, 0}, {-0.1178, 0}, {-0.0017, 0}}}},
    {3, 1, {{{0.0182, -0.0307}, {-0.002, 0.0028}, {0.0542, -0.0645}}}},
    {3, 2, {{{-0.0003, 0.0025}, {0.0489, 0.0091}, {0.0001, 0.0002}}}},
    {3, 3, {{{0.0392, 0.0763}, {-0.001, -0.0011}, {-0.124, 0.0255}}}},
};

void check_degree(const SurfaceExpansion& expansion) {
  if (expansion.coefficients.lmax < 3)
    throw Error(Fault::bad_argument, "the paper's table goes to degree 3: expand to degree 3 at least");
}

} // namespace

std::span<const PaperRow> paper_harmonic_table() {
  return harmonic;
}

std::span<const PaperRow> paper_flow_table() {
  return flow;
}

std::array<double, 3> paper_misfits(const SurfaceExpansion& expansion, std::span<const PaperRow> table) {
  check_degree(expansion);
  std::array<double, 3> misfits{};
  for (int f = 0; f < 3; ++f) {
    double difference = 0, size = 0;
    for (const PaperRow& row : table) {
      if (row.l == 0) continue;
      const int times = row.m == 0 ? 1 : 2;
      const std::complex<double> value = row.values[std::size_t(f)];
      difference += times * std::norm(expansion.coefficients.at(f, row.l, row.m) - value);
      size += times * std::norm(value);
    }
    misfits[std::size_t(f)] = std::sqrt(difference / size);
  }
  return misfits;
}

std::array<double, 3> paper_distances(const SurfaceExpansion& expansion, std::span<const PaperRow> table) {
  check_degree(expansion);
  std::array<double, 3> largest{};
  for (const PaperRow& row : table)
    for (int f = 0; f < 3; ++f) {
      double& most = largest[std::size_t(f)];
      most = std::max(most, std::abs(expansion.coefficients.at(f, row.l, row.m) - row.values[std::size_t(f)]));
    }
  return largest;
}

} // namespace cowgpu
