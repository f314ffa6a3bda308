#include "host/map/laplacian.hpp"

#include "host/error.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/topology.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cowgpu {

namespace {

// Brings coordinates to a size whose squares and cubes are in range. A power of two: nothing is rounded.
double unit_scale(const ManifoldSurface& surface) {
  return std::exp2(-std::ilogb(bounding_box(surface.closed()).longest_side()));
}

[[noreturn]] void undefined(const ManifoldSurface& surface, std::size_t face, std::string_view reason,
                            EdgeWeights weights) {
  const Face& f = surface.faces()[face];
  throw Error(
      Fault::map_failed,
      fmt::format(
          "{} (vertices {}, {}, {}) {}, so {} weights are not defined there: {}", where(surface.closed().mesh(), face),
          f[0], f[1], f[2], reason, name(weights),
          weights == EdgeWeights::cotangent
              ? "collapse one of its edges or flip the longest, or take the stretch map, or mean-value or Tutte "
                "weights for a harmonic one"
              : "collapse the edge, or take Tutte weights"));
}

// For each half-edge the part that its own face has in the weights: half the cotangent of the angle facing it.
std::vector<double> half_cotangents(const ManifoldSurface& surface) {
  const double scale = unit_scale(surface);
  const auto& faces = surface.faces();
  std::vector<double> values(3 * faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    Vec3 side[3]; // side k runs from corner k to corner k + 1
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      side[k] = scale * (surface.vertices()[faces[f][(k + 1) % 3]] - surface.vertices()[faces[f][k]]);
      longest = std::max(longest, side[k].squaredNorm());
    }
    const double twice_area = side[0].cross(side[1]).norm();
    if (!(twice_area > degenerate_height * longest))
      undefined(surface, f, "has no area that can be told from zero", EdgeWeights::cotangent);
    for (std::size_t k = 0; k < 3; ++k)
      values[3 * f + k] = -side[(k + 1) % 3].dot(side[(k + 2) % 3]) / (2 * twice_area);
  }
  return values;
}

// tan(c / 2) at each corner, from corner to next and to previous; and the lengths of the half-edges.
struct Corners {
  std::vector<double> half_tangent, length;
};

Corners corners(const ManifoldSurface& surface) {
  const double scale = unit_scale(surface);
  const auto& faces = surface.faces();
  Corners c;
  c.half_tangent.resize(3 * faces.size());
  c.length.resize(3 * faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    Vec3 side[3];
    for (std::size_t k = 0; k < 3; ++k) {
      side[k] = scale * (surface.vertices()[faces[f][(k + 1) % 3]] - surface.vertices()[faces[f][k]]);
      c.length[3 * f + k] = side[k].norm();
      if (!(c.length[3 * f + k] > 0)) undefined(surface, f, "has an edge without length", EdgeWeights::mean_value);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 to_previous = -side[(k + 2) % 3];
      const double lengths = c.length[3 * f + k] * c.length[3 * f + (k + 2) % 3];
      const double denominator = lengths + side[k].dot(to_previous);
      if (!(denominator > degenerate_height * lengths))
        undefined(surface, f, "has edges that go opposite ways from one vertex", EdgeWeights::mean_value);
      c.half_tangent[3 * f + k] = side[k].cross(to_previous).norm() / denominator;
    }
  }
  return c;
}

std::vector<double> half_edge_weights(const ManifoldSurface& surface, const HalfEdges& half_edges,
                                      EdgeWeights weights) {
  const auto count = std::uint32_t(3 * surface.faces().size());
  std::vector<double> result(count, 1);
  if (weights == EdgeWeights::cotangent) {
    const auto half = half_cotangents(surface);
    for (std::uint32_t h = 0; h < count; ++h) result[h] = half[h] + half[half_edges.twin(h)];
  } else if (weights == EdgeWeights::mean_value) {
    const Corners c = corners(surface);
    for (std::uint32_t h = 0; h < count; ++h) {
      const std::uint32_t beside = HalfEdges::next(half_edges.twin(h)); // leaves the same vertex
      result[h] = (c.half_tangent[h] + c.half_tangent[beside]) / c.length[h];
    }
  }
  for (std::uint32_t h = 0; h < count; ++h)
    if (!std::isfinite(result[h])) undefined(surface, h / 3, "has a weight beyond double precision", weights);
  return result;
}

} // namespace

std::string_view name(EdgeWeights weights) {
  switch (weights) {
  case EdgeWeights::cotangent: return "cotangent";
  case EdgeWeights::mean_value: return "mean value";
  case EdgeWeights::tutte: return "tutte";
  }
  return "";
}

SparseMatrix laplacian(const ManifoldSurface& surface, const HalfEdges& half_edges, EdgeWeights weights) {
  const auto weight = half_edge_weights(surface, half_edges, weights);
  const auto& faces = surface.faces();
  const std::size_t vertices = surface.vertices().size();

  // Entry (i, j) belongs to the half-edge from i to j; column j holds those that arrive, and the diagonal.
  SparseMatrix matrix{Eigen::Index(vertices), Eigen::Index(vertices)};
  std::vector<int> begin(vertices + 1, 0);
  for (const Face& f : faces)
    for (const std::uint32_t v : f) ++begin[v + 1];
  for (std::size_t v = 0; v < vertices; ++v) begin[v + 1] += begin[v] + (begin[v + 1] > 0 ? 1 : 0);
  matrix.resizeNonZeros(begin[vertices]);
  std::copy(begin.begin(), begin.end(), matrix.outerIndexPtr());

  struct Entry {
    int row;
    double value;
  };
  std::vector<Entry> entries(matrix.nonZeros());
  std::vector<double> diagonal(vertices, 0);
  std::vector<int> end(begin.begin(), begin.end() - 1);
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = faces[f][k], to = faces[f][(k + 1) % 3];
      entries[std::size_t(end[to]++)] = {int(from), -weight[3 * f + k]};
      diagonal[from] += weight[3 * f + k];
    }
  for (std::size_t v = 0; v < vertices; ++v) {
    if (begin[v] == begin[v + 1]) continue;
    entries[std::size_t(end[v])] = {int(v), diagonal[v]};
    const auto column = entries.begin() + begin[v];
    std::sort(column, entries.begin() + begin[v + 1], [](const Entry& a, const Entry& b) { return a.row < b.row; });
  }
  for (std::size_t i = 0; i < entries.size(); ++i) {
    matrix.innerIndexPtr()[i] = entries[i].row;
    matrix.valuePtr()[i] = entries[i].value;
  }
  return matrix;
}

std::vector<double> vertex_areas(const ManifoldSurface& surface) {
  const double scale = unit_scale(surface);
  const auto& v = surface.vertices();
  std::vector<double> areas(v.size(), 0);
  long double total = 0;
  for (const Face& f : surface.faces()) {
    const Vec3 first = scale * (v[f[1]] - v[f[0]]), second = scale * (v[f[2]] - v[f[0]]);
    const double area = first.cross(second).norm();
    total += 3 * area;
    for (const std::uint32_t corner : f) areas[corner] += area;
  }
  for (double& area : areas) area = double(area / total);
  return areas;
}

} // namespace cowgpu
