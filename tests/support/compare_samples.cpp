#include "tests/support/compare_samples.hpp"

#include "host/error.hpp"
#include "host/reference/sample.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <set>

namespace cowgpu::test {
namespace {

// Exact for determinants of vectors whose components are 0 or 2^-100 to 2: the last bit of a product of three weighs
// 2^-459.
using Exact =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<512, boost::multiprecision::digit_base_2>,
                                  boost::multiprecision::et_off>;

} // namespace

SphereSamples sample(Backend& backend, const MappedMesh& map, const SphereGrid& grid, RunReport* report) {
  Monitor silent;
  return backend.sphere_sampler(grid)->sample(map.positions, map.faces, silent, report);
}

bool compare_samples(Paths& paths, const MappedMesh& map, const SphereGrid& grid, double figure) {
  for (const Vec3& p : map.positions)
    for (int k = 0; k < 3; ++k) REQUIRE((p[k] == 0 || std::abs(p[k]) > 0x1p-100));
  INFO(map.name << " on a " << name(grid.kind) << " grid of " << grid.rings << " rings of " << grid.ring_length);
  const SphereDirections directions(grid);
  const reference::Sampler<Exact> reference(map.positions, map.faces);
  std::vector<reference::Sample> truth;
  SphereSamples counts;
  std::set<std::uint32_t> hit;
  bool open = false;
  for (int i = 0; i < grid.rings; ++i)
    for (int j = 0; j < grid.ring_length; ++j) {
      truth.push_back(reference(directions(i, j)));
      open = open || truth.back().face == reference::no_face;
      counts.folded_points += truth.back().inside > 1;
      counts.edge_points += truth.back().edge;
      counts.flipped_points += truth.back().flipped;
      hit.insert(truth.back().face);
    }
  for (const int sign : reference.signs()) {
    counts.flipped_faces += sign < 0;
    counts.flat_faces += sign == 0;
  }
  SphereSamples first;
  paths.each([&](Backend& backend) {
    INFO(backend.facts().type);
    if (open) {
      try {
        sample(backend, map, grid);
        FAIL("a direction is open, but the map was not refused");
      } catch (const Error& error) {
        CHECK(error.fault() == Fault::map_failed);
      }
      return;
    }
    const SphereSamples found = sample(backend, map, grid);
    REQUIRE(found.points() == truth.size());
    REQUIRE(found.weights.size() == truth.size());
    CHECK(found.rings == grid.rings);
    CHECK(found.ring_length == grid.ring_length);
    std::size_t wrong = 0;
    double error = 0;
    for (std::size_t p = 0; p < truth.size(); ++p) {
      wrong += found.faces[p] != truth[p].face;
      double sum = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double apart = std::abs(found.weights[p][k] - truth[p].weights[k]);
        if (!(apart <= error)) error = apart;
        if (!(found.weights[p][k] >= 0)) error = INFINITY;
        sum += found.weights[p][k];
      }
      if (!(std::abs(sum - 1) <= 4e-16)) error = INFINITY;
    }
    CHECK(wrong == 0);
    check_at_most(error, figure, "weights");
    CHECK(found.faces_hit == hit.size());
    CHECK(found.folded_points == counts.folded_points);
    CHECK(found.edge_points == counts.edge_points);
    CHECK(found.flipped_points == counts.flipped_points);
    CHECK(found.flipped_faces == counts.flipped_faces);
    CHECK(found.flat_faces == counts.flat_faces);
    if (first.faces.empty())
      first = found;
    else
      CHECK(found.weights == first.weights);
  });
  return !open;
}

} // namespace cowgpu::test
