#include "host/map/quality.hpp"

#include "host/error.hpp"
#include "host/geometry/orientation.hpp"
#include "host/mesh/half_edges.hpp"
#include "host/mesh/topology.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

namespace cowgpu {

namespace {

constexpr double sphere = 4 * std::numbers::pi;

// The determinant of three unit vectors, from differences.
double determinant(const Vec3& a, const Vec3& b, const Vec3& c) {
  return a.dot((b - a).cross(c - a));
}

// The smallest angle between a corner and the great circle through the other two.
double height(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double base = std::max({a.cross(b - a).norm(), b.cross(c - b).norm(), c.cross(a - c).norm()});
  return base > 0 ? std::asin(std::min(1.0, std::abs(determinant(a, b, c)) / base)) : 0;
}

struct Weighted {
  double value, weight;
};

template <std::size_t n>
std::array<double, n> quantiles(std::vector<Weighted> values, const std::array<double, n>& parts) {
  std::sort(values.begin(), values.end(), [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  double total = 0;
  for (const Weighted& v : values) total += v.weight;
  std::array<double, n> result{};
  double sum = 0;
  std::size_t i = 0;
  for (std::size_t q = 0; q < n && !values.empty(); ++q) {
    while (i + 1 < values.size() && (parts[q] == 1 || sum + values[i].weight < parts[q] * total))
      sum += values[i++].weight;
    result[q] = values[i].value;
  }
  return result;
}

// A triangle, relative to its first corner.
struct Shape {
  Vec3 first, second;
  double twice_area;
};

Shape shape(const Vec3& a, const Vec3& b, const Vec3& c) {
  Shape s{b - a, c - a, 0};
  s.twice_area = s.first.cross(s.second).norm();
  return s;
}

Shape shape(const ManifoldSurface& surface, const Face& f) {
  const auto& v = surface.vertices();
  return shape(v[f[0]], v[f[1]], v[f[2]]);
}

// Ratio of the singular values of the map from one triangle to another, from its similar and its anti-similar part, in
// frames whose first axes run along the first sides: nothing cancels where they are similar.
double shear(const Shape& from, const Shape& to) {
  if (!(to.twice_area > 0)) return std::numeric_limits<double>::infinity();
  const double base = from.first.norm(), image = to.first.norm(), stretch = image / base;
  const double across = (to.first.dot(to.second) / image - stretch * (from.first.dot(from.second) / base)) * base;
  const double upper = across / from.twice_area, lower = to.twice_area / image * (base / from.twice_area);
  const double largest = (std::hypot(stretch + lower, upper) + std::hypot(stretch - lower, upper)) / 2;
  return largest * largest / (stretch * lower);
}

// The connected sets of the marked faces, largest area first.
std::vector<UnseenPart> connected_parts(const ManifoldSurface& surface, const std::vector<bool>& marked, double total) {
  const auto& faces = surface.faces();
  const HalfEdges half_edges(surface);
  DisjointSets sets(faces.size());
  for (std::uint32_t h = 0; h < 3 * faces.size(); ++h)
    if (const std::uint32_t twin = half_edges.twin(h); marked[h / 3] && marked[twin / 3]) sets.join(h / 3, twin / 3);
  std::map<std::size_t, UnseenPart> parts;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!marked[f]) continue;
    UnseenPart& part = parts[sets.find(f)];
    const double area = shape(surface, faces[f]).twice_area / 2;
    ++part.triangles;
    part.area += area;
    for (const std::uint32_t v : faces[f]) part.middle += area / 3 * surface.vertices()[v];
  }
  std::vector<UnseenPart> result;
  for (auto& [first, part] : parts) {
    if (part.area > 0) part.middle /= part.area;
    part.area /= total;
    result.push_back(part);
  }
  std::stable_sort(result.begin(), result.end(), [](const auto& a, const auto& b) { return a.area > b.area; });
  return result;
}

std::string part_sentence(const MapQuality& q) {
  std::string text;
  std::size_t listed = 0;
  for (const UnseenPart& part : q.parts) {
    if (part.area < 0.01 || listed == 6) break;
    text += fmt::format("{}{:.1f} % round ({:.3g}, {:.3g}, {:.3g})", listed == 0 ? "" : ", ", 100 * part.area,
                        part.middle.x(), part.middle.y(), part.middle.z());
    ++listed;
  }
  return listed == 0 ? std::string() : "Lost in whole pieces: " + text + " of the surface";
}

std::vector<std::string> in_words(const MapQuality& q) {
  std::vector<std::string> s;
  if (q.inside_out)
    s.emplace_back("The map is inside-out: what is counter-clockwise on the body is clockwise on the sphere");
  if (std::abs(std::abs(q.degree) - 1) > 1e-6)
    s.push_back(fmt::format(
        "The triangles cover the sphere {:.3g} times: this is not a map of a closed surface of genus 0", q.degree));
  if (q.flipped.empty() && q.flat.empty())
    s.push_back(fmt::format("None of the {} triangles is flipped{}", q.triangles,
                            std::abs(std::abs(q.degree) - 1) > 1e-6 ? "" : ": the map is one-to-one"));
  else
    s.push_back(
        fmt::format("{} of {} triangles are flipped and {} have no area on the sphere ({:.1e} of it): the map is "
                    "not one-to-one there",
                    q.flipped.size(), q.triangles, q.flat.size(), q.flipped_area));
  const auto& a = q.log_area_ratio;
  s.push_back(fmt::format("Areas change by 10^{:.2f} to 10^{:.2f}; for 5, 25, 50 and 95 % of the surface by at most "
                          "10^{:.2f}, 10^{:.2f}, 10^{:.2f} and 10^{:.2f}",
                          a[0], a[5], a[1], a[2], a[3], a[4]));
  s.push_back(
      fmt::format("Shapes are sheared by at most {:.3g} on half of the surface, {:.3g} on 95 %, {:.3g} on 99 %, "
                  "{:.3g} at worst (1: angles are kept)",
                  q.shear[0], q.shear[1], q.shear[2], q.shear[3]));
  s.push_back(fmt::format("The smallest triangle covers {:.1e} sr (face {}), the smallest height is {:.1e} (face {})",
                          q.smallest_area, q.smallest_area_face, q.smallest_height, q.smallest_height_face));
  const double degrees = q.cell * 180 / std::numbers::pi;
  if (q.unseen == 0)
    s.push_back(
        fmt::format("Every triangle is higher than a cell of the grid ({:.3g} degrees at lmax {})", degrees, q.lmax));
  else
    s.push_back(fmt::format("{} of {} triangles, {:.1f} % of the surface, are smaller than a cell of the grid ({:.3g} "
                            "degrees) and cannot be seen at lmax {}",
                            q.unseen, q.triangles, 100 * q.unseen_area, degrees, q.lmax));
  if (const std::string lost = part_sentence(q); !lost.empty()) s.push_back(lost);
  return s;
}

void require_fit(const ManifoldSurface& surface, const SphereMap& map, int lmax) {
  if (lmax < 1)
    throw Error(Fault::bad_argument, fmt::format("a map cannot be judged for lmax {}: give 1 or more", lmax));
  if (map.positions.size() != surface.vertices().size())
    throw Error(Fault::bad_argument,
                fmt::format("the map has {} vertices and the surface {}: it belongs to another mesh",
                            map.positions.size(), surface.vertices().size()));
  for (std::size_t v = 0; v < map.positions.size(); ++v)
    if (!map.positions[v].allFinite())
      throw Error(Fault::bad_argument, fmt::format("the map's position of vertex {} is not finite", v));
}

} // namespace

double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  return 2 * std::atan2(determinant(a, b, c), 1 + a.dot(b) + b.dot(c) + c.dot(a));
}

MapQuality judge(const ManifoldSurface& surface, const SphereMap& map, int lmax) {
  require_fit(surface, map, lmax);
  const auto& faces = surface.faces();
  const auto corner = [&](std::size_t f, std::size_t k) -> const Vec3& { return map.positions[faces[f][k]]; };

  MapQuality q;
  q.triangles = faces.size();
  q.lmax = lmax;
  q.cell = std::numbers::pi / (2 * lmax);
  q.smallest_area = q.smallest_height = std::numeric_limits<double>::infinity();

  std::vector<double> angle(faces.size());
  std::vector<bool> low(faces.size());
  std::vector<Weighted> ratio, sheared;
  ratio.reserve(faces.size());
  sheared.reserve(faces.size());
  double total = 0, low_area = 0;
  long double sum = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Vec3 &a = corner(f, 0), &b = corner(f, 1), &c = corner(f, 2);
    const Shape on_surface = shape(surface, faces[f]);
    const double area = on_surface.twice_area / 2, altitude = height(a, b, c);
    angle[f] = solid_angle(a, b, c);
    sum += angle[f];
    total += area;
    if (std::abs(angle[f]) < q.smallest_area) {
      q.smallest_area = std::abs(angle[f]);
      q.smallest_area_face = std::uint32_t(f);
    }
    if (altitude < q.smallest_height) {
      q.smallest_height = altitude;
      q.smallest_height_face = std::uint32_t(f);
    }
    low[f] = altitude < q.cell;
    if (low[f]) {
      ++q.unseen;
      low_area += area;
    }
    if (!(area > 0)) continue;
    ratio.push_back({std::abs(angle[f]) / area, area});
    sheared.push_back({shear(on_surface, shape(a, b, c)), area});
  }
  q.degree = double(sum / sphere);
  q.inside_out = q.degree < 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const int sign = orientation(corner(f, 0), corner(f, 1), corner(f, 2));
    if (sign == 0) {
      q.flat.push_back(std::uint32_t(f));
    } else if ((sign < 0) != q.inside_out) {
      q.flipped.push_back(std::uint32_t(f));
      q.flipped_area += std::abs(angle[f]) / sphere;
    }
  }
  for (Weighted& r : ratio) r.value = std::max(smallest_log_ratio, std::log10(r.value * (total / sphere)));
  q.log_area_ratio = quantiles<6>(std::move(ratio), {0, 0.05, 0.25, 0.5, 0.95, 1});
  q.shear = quantiles<4>(std::move(sheared), {0.5, 0.95, 0.99, 1});
  q.unseen_area = low_area / total;
  if (q.unseen > 0) q.parts = connected_parts(surface, low, total);
  q.sentences = in_words(q);
  return q;
}

} // namespace cowgpu
