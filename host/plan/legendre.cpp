#include "host/plan/legendre.hpp"

#include "host/parallel.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu::plan {
namespace {

void set_rings(Legendre& plan, const SphereGrid& grid) {
  // Rings without a mirror image: the equator, and the pole of grids that have one only.
  const bool pole_alone = grid.kind == GridKind::driscoll_healy || grid.kind == GridKind::driscoll_healy_square;
  const int mirror_sum = pole_alone ? grid.rings : grid.rings - 1; // sum of the indices of a pair
  plan.pairs = mirror_sum / 2 + 1;
  plan.blocks = (plan.pairs + block_pairs - 1) / block_pairs;
  const auto padded = std::size_t(plan.blocks) * block_pairs;
  plan.north.assign(padded, -1);
  plan.south.assign(padded, -1);
  plan.x.assign(padded, 0);
  plan.t.assign(padded, 0);
  plan.weight.assign(padded, 0);
  plan.sine.assign(padded, 0);
  for (int i = 0; i < plan.pairs; ++i) {
    const auto at = std::size_t(i);
    const int mirror = mirror_sum - i;
    plan.north[at] = i;
    plan.south[at] = mirror == i || mirror >= grid.rings ? -1 : mirror;
    plan.x[at] = double(grid.cosine[at]);
    plan.sine[at] = grid.sine[at];
    plan.weight[at] = double(grid.weights[at] * (2 * std::numbers::pi_v<long double> / grid.ring_length));
  }
  while (plan.polar_blocks < plan.blocks &&
         plan.sine[std::size_t(plan.polar_blocks) * block_pairs] < std::numbers::sqrt2_v<long double> / 2 &&
         plan.north[std::size_t(plan.polar_blocks) * block_pairs] >= 0)
    ++plan.polar_blocks;
  for (int i = 0; i < plan.pairs; ++i) {
    const auto at = std::size_t(i);
    const bool polar = i < plan.polar_blocks * block_pairs;
    plan.t[at] = double(polar ? -grid.sine[at] * grid.sine[at] : grid.cosine[at] * grid.cosine[at]);
  }
}

void set_recurrence(Legendre& plan, unsigned threads) {
  const int lmax = plan.lmax;
  plan.offset.assign(std::size_t(lmax) + 2, 0);
  plan.e_offset = plan.offset;
  for (int m = 0; m <= lmax; ++m) {
    const auto at = std::size_t(m), steps = std::size_t(plan.padded_steps(m));
    plan.offset[at + 1] = plan.offset[at] + steps;
    plan.e_offset[at + 1] = plan.e_offset[at] + 2 * steps + 2;
  }
  for (auto* array : {&plan.a, &plan.b, &plan.b_polar, &plan.alpha}) array->assign(plan.offset.back(), 0);
  plan.e.assign(plan.e_offset.back(), 0);
  constexpr std::size_t chunk = 16;
  parallel_for(threads, (std::size_t(lmax) + chunk) / chunk, [&](std::size_t task, unsigned) {
    for (int m = int(task * chunk); m <= std::min(lmax, int((task + 1) * chunk) - 1); ++m) {
      const std::size_t at = plan.offset[std::size_t(m)];
      double* e = &plan.e[plan.e_offset[std::size_t(m)]];
      const auto square = [m](int j) { // e_l^2 for l = m + j
        const double l = m + j, n = double(j) * (2.0 * m + j);
        return n / ((2 * l - 1) * (2 * l + 1));
      };
      const int steps = plan.steps(m);
      for (int j = 1; j < 2 * plan.padded_steps(m) + 2; ++j) e[j] = std::sqrt(square(j));
      double alpha = 1 / e[1];
      for (int k = 0; k < steps; ++k) {
        const double sign = k % 2 ? -1 : 1, a = sign * alpha * alpha;
        const double sum = square(2 * k + 1) + square(2 * k + 2);
        const std::size_t i = at + std::size_t(k);
        plan.alpha[i] = alpha;
        plan.a[i] = a;
        plan.b[i] = -a * sum;
        plan.b_polar[i] = a * (1 - sum);
        alpha = sign / (e[2 * k + 2] * e[2 * k + 3] * alpha);
      }
    }
  });
}

} // namespace

Legendre legendre(const SphereGrid& grid, int lmax, unsigned threads) {
  Legendre plan;
  plan.lmax = lmax;
  set_rings(plan, grid);
  set_recurrence(plan, threads);
  return plan;
}

Legendre recurrence(int lmax, unsigned threads) {
  Legendre plan;
  plan.lmax = lmax;
  set_recurrence(plan, threads);
  return plan;
}

double active_steps(const Legendre& plan, const Seeds& seeds) {
  double steps = 0;
  for (int m = 0; m <= plan.lmax; ++m) {
    const std::uint32_t* start = &seeds.start[std::size_t(m / seeds.orders) * std::size_t(plan.blocks)];
    for (int block = 0; block < plan.blocks; ++block)
      if (start[block] != Seeds::never)
        steps += std::max(0.0, double(plan.padded_steps(m)) - double(start[block]) * seeds.segment) * block_pairs;
  }
  return steps;
}

} // namespace cowgpu::plan
