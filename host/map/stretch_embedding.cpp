#include "host/map/stretch_embedding.hpp"

#include "host/error.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

namespace cowgpu {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double pi = std::numbers::pi;

// All vertices are relaxed each time their number has grown by this factor: more often while they are few, because where
// limbs go is decided then, and at little cost.
constexpr double growth = 1.3;
std::size_t sweeps_on_growth(std::size_t count) {
  return std::clamp<std::size_t>(10000 / count, 4, 100);
}

// A point on a ray from the centre of a star, by halving the distance until the triangles are the right way round.
struct Best {
  double energy = infinity;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();

  void look(const Star& star, const std::function<Eigen::Vector2d(double)>& ray) {
    int feasible = 0;
    double t = 1;
    for (int halvings = 0; halvings < 60 && feasible < 4; ++halvings, t /= 2) {
      const Eigen::Vector2d p = ray(t);
      const double e = star.energy(p[0], p[1]);
      if (e < infinity) ++feasible;
      if (e < energy) {
        energy = e;
        at = p;
      }
    }
  }
};

} // namespace

StretchEmbedding::StretchEmbedding(std::span<const Vec3> points, std::vector<std::vector<std::uint32_t>> rings,
                                   double lambda)
    : points_(points), rings_(std::move(rings)), lambda_(lambda), positions_(points.size(), Vec3::Zero()) {}

void StretchEmbedding::set_star(std::uint32_t v, const Vec3& centre) {
  const auto ring = rings_.of(v);
  const std::size_t count = ring.size();
  ring_positions_.resize(count);
  weights_.resize(count);
  const Vec3& p = points_[v];
  const Vec3* to = &points_[ring[count - 1]];
  double spoke = (*to - p).squaredNorm();
  for (std::size_t i = 0, previous = count - 1; i < count; previous = i++) {
    const Vec3* next = &points_[ring[i]];
    const double next_spoke = (*next - p).squaredNorm();
    weights_[previous] = stretch_weights((*next - *to).squaredNorm(), next_spoke, spoke, lambda_);
    ring_positions_[i] = positions_[ring[i]];
    to = next;
    spoke = next_spoke;
  }
  star_.set(centre, ring_positions_, weights_);
}

double StretchEmbedding::relax(std::uint32_t v, int steps) {
  double moved = 0;
  for (int i = 0; i < steps; ++i) {
    set_star(v, positions_[v]);
    Eigen::Vector2d to;
    if (!star_.newton_step(to)) break;
    positions_[v] = star_.position(to[0], to[1]);
    moved = std::max(moved, to.norm() / star_.nearest());
  }
  return moved;
}

double StretchEmbedding::sweep() {
  double moved = 0;
  for (const std::uint32_t v : present_) moved = std::max(moved, relax(v, 1));
  return moved;
}

void StretchEmbedding::place_tetrahedron() {
  for (std::uint32_t v = 0; v < rings_.size(); ++v)
    if (!rings_.of(v).empty()) present_.push_back(v);
  const double s = 1 / std::sqrt(3.0);
  const auto ring = rings_.of(present_[0]); // counter-clockwise seen from outside
  positions_[present_[0]] = {s, s, s};
  positions_[ring[0]] = {-s, -s, s};
  positions_[ring[1]] = {s, -s, -s};
  positions_[ring[2]] = {-s, s, -s};
  for (int i = 0; i < 20; ++i) sweep();
}

void StretchEmbedding::insert(Collapse&& step) {
  const std::uint32_t v = step.vertex, u = step.ring[0];
  rings_.undo(std::move(step));
  const auto ring = rings_.of(v); // starts at u
  const std::size_t count = ring.size();
  const Vec3 centre = positions_[u];
  set_star(v, centre);
  Best best;
  for (std::size_t i = 1; i + 1 < count; ++i) {
    const Vec3 centroid = (centre + positions_[ring[i]] + positions_[ring[i + 1]]) / 3;
    best.look(star_, [&](double t) -> Eigen::Vector2d { return star_.coordinates(centre + t * (centroid - centre)); });
  }
  // A small step from u is free of flips if it lies on the inner side of both edges of the ring that meet there; those
  // directions are an interval of angles from the first edge, `fan` being the angle between the two.
  const auto angle_of = [&](std::size_t i) {
    const Eigen::Vector2d d = star_.direction(positions_[ring[i]]);
    return std::atan2(d[1], d[0]);
  };
  const double first = angle_of(1);
  double fan = 0, reach = infinity;
  for (std::size_t i = 1; i < count; ++i) {
    reach = std::min(reach, (positions_[ring[i]] - centre).norm());
    if (i == 1) continue;
    double turn = angle_of(i) - angle_of(i - 1);
    if (turn <= 0) turn += 2 * pi;
    fan += turn;
  }
  const double low = std::max(0.0, fan - pi), high = std::min(fan, pi);
  for (const double fraction : {0.5, 0.25, 0.75}) {
    const double angle = first + low + fraction * (high - low);
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    best.look(star_, [&](double t) -> Eigen::Vector2d { return t * reach * direction; });
  }
  if (!(best.energy < infinity))
    throw Error(
        Fault::map_failed,
        fmt::format("no place on the sphere was found for a vertex with {} neighbours, after {} others had theirs: "
                    "the surface is too thin somewhere for double precision. Remesh it with better triangles",
                    count, present_.size()));
  positions_[v] = star_.position(best.at[0], best.at[1]);
  present_.push_back(v);
}

void StretchEmbedding::build(Monitor& monitor) {
  monitor.progress("simplifying the surface", 0);
  std::vector<Collapse> steps = collapse_to_tetrahedron(rings_, points_);
  place_tetrahedron();
  const double total = double(steps.size()) + 4;
  double next_sweeps = growth * 4;
  std::vector<std::uint32_t> neighbours;
  while (!steps.empty()) {
    const std::uint32_t v = steps.back().vertex;
    insert(std::move(steps.back()));
    steps.pop_back();
    relax(v, 4);
    const auto ring = rings_.of(v);
    neighbours.assign(ring.begin(), ring.end());
    std::sort(neighbours.begin(), neighbours.end()); // a reflected body has the same order so
    for (const std::uint32_t u : neighbours) relax(u, 1);
    const double count = double(present_.size());
    if (present_.size() % 256 == 0) {
      check_stop(monitor);
      monitor.progress("growing the map", count / total);
    }
    if (count < next_sweeps) continue;
    for (std::size_t i = 0; i < sweeps_on_growth(present_.size()); ++i) {
      check_stop(monitor);
      sweep();
    }
    next_sweeps = growth * count;
  }
}

} // namespace cowgpu
