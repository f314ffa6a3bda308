#include "host/flow/cell_means.hpp"

#include "host/error.hpp"
#include "host/spectrum/surface_fields.hpp"
#include "host/sphere_directions.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

namespace cowgpu {
namespace {

constexpr double jump_angle = 0.05, jump_length = 0.02; // radians, diagonals
constexpr std::size_t parts_at_a_time = 1 << 14;        // parts cut at a time
constexpr std::size_t least_finer = 1 << 17;
constexpr int side = 4, most_depth = 10;
constexpr std::size_t children = side * side;
constexpr std::size_t pieces_at_once = 1 << 18;

using Values = std::array<double, 6>;

bool is_angle(std::size_t field) {
  return field == 1 || field == 2;
}

struct Angles {
  double theta, phi;
};

Angles angles_of(const Vec3& direction) {
  return {std::atan2(std::hypot(direction.x(), direction.y()), direction.z()),
          std::atan2(direction.y(), direction.x())};
}

/// A piece of a face's edge. Moved by the level along the face's normal it lies on the level set, unless something else of the
/// surface is as near: then its own points are the feet that are seen there.
struct Piece {
  Vec3 from, to, lift;
  Vec3 middle() const { return (from + to) / 2; }
};

/// A point of the surface that is seen in a cell at the place (across, along), from 0 to 1 either way, were it the foot there.
struct Foot {
  std::size_t cell;
  double across, along;
  Values values;
};

/// A part of a cell: one of 4^depth rows and columns.
struct CellPart {
  std::uint32_t cell;
  std::uint32_t row = 0, column = 0;
  std::size_t first_piece = 0, last_piece = 0; ///< those seen in it: of `pieces_`
  Values values{};
  double urgency = 0; ///< solid angle times the largest difference in thresholds
  double missed_length = 0, missed_angle = 0;
};

// Hammersley's points, by number: of a square's 4 x 4 parts and its 16 strips either way each has one in it.
struct PlaceInPart {
  double across, along;
  std::size_t part; ///< row * side + column
};

constexpr std::array<PlaceInPart, children> places_in_part = [] {
  std::array<PlaceInPart, children> places{};
  for (std::size_t i = 0; i < children; ++i) {
    places[i] = {(double(i / side) + 0.5) / side, (double(i % side) + 0.5) / side, i};
  }
  return places;
}();

/// The children of a part, [row][column].
struct Block {
  std::array<Values, children> values{}, low{}, high{}; ///< and the range of these and the neighbours' in the block
  /// Largest difference from a neighbour or of a seen piece beyond that range, in thresholds; and the latter in lengths, angles.
  std::array<double, children> off{}, out_length{}, out_angle{};
  std::vector<std::pair<std::size_t, Piece>> pieces; ///< child and piece: those beyond
};

class CellMeans {
public:
  CellMeans(const LevelSet& set, const SphereGrid& grid, bool signed_dphi, const Eigen::Matrix3d& turn,
            Monitor& monitor, CellMeansReport& found)
      : set_(set), grid_(grid), signed_dphi_(signed_dphi), turn_(turn), turned_(!turn.isIdentity(0)), monitor_(monitor),
        found_(found), length_(std::size_t(grid.ring_length)), rings_(std::size_t(grid.rings)), n_(grid.points()),
        step_(2 * std::numbers::pi / double(grid.ring_length)) {
    edges_ = {1};
    for (const double weight : grid.weights) edges_.push_back(edges_.back() - weight);
    edges_.back() = -1;
  }

  std::vector<double> run(std::span<const Vec3> vertices, std::span<const Face> faces,
                          std::span<const double> positions, const CellMeansOptions& options) {
    values_ = turned_ ? turned_fields(positions)
                      : surface_fields(std::vector<double>(positions.begin(), positions.end()), grid_, set_.origin,
                                       signed_dphi_);
    found_.points = n_;
    double sum = 0;
    for (std::size_t p = 0; p < n_; ++p) sum += grid_.weights[p / length_] * std::abs(values_[p]);
    const double mean = sum / (2 * double(length_));
    moved_ = jump_length * std::min((set_.box.max - set_.box.min).norm(), 10 * mean);
    mark_by_neighbours();
    find_pieces(vertices, faces);
    std::vector<CellPart> parts = cells_as_parts();
    found_.cells = parts.size();
    if (options.parts == 1) return std::move(values_);
    mend_border();
    const auto whole = double(parts.size());
    std::size_t left = std::max(least_finer, std::size_t(options.finer * double(n_))) / children;
    for (int depth = 0; !parts.empty(); ++depth) {
      std::vector<CellPart> next;
      std::vector<Piece> next_pieces;
      for (std::size_t begin = 0; begin < parts.size(); begin += parts_at_a_time) {
        monitor_.progress("averaging over jumps", std::min(1.0, double(begin) / whole));
        cut(std::span(parts).subspan(begin, std::min(parts_at_a_time, parts.size() - begin)), depth, next, next_pieces);
      }
      found_.depth = depth + 1;
      const std::size_t taken = depth + 1 < most_depth ? std::min(left, next.size()) : 0;
      const auto middle = next.begin() + std::ptrdiff_t(taken);
      if (taken < next.size())
        std::nth_element(next.begin(), middle, next.end(), [](const CellPart& a, const CellPart& b) {
          return a.urgency != b.urgency ? a.urgency > b.urgency
                                        : std::tie(a.cell, a.row, a.column) < std::tie(b.cell, b.row, b.column);
        });
      for (auto part = middle; part != next.end(); ++part) miss(*part);
      next.resize(taken);
      left -= taken;
      parts = std::move(next);
      pieces_ = std::move(next_pieces);
    }
    return std::move(values_);
  }

private:
  Values at(std::size_t p) const {
    Values v;
    for (std::size_t f = 0; f < 6; ++f) v[f] = values_[f * n_ + p];
    return v;
  }

  // In thresholds.
  double difference(const Values& a, const Values& b) const {
    double most = 0;
    for (std::size_t f = 0; f < 6; ++f)
      most = std::max(most, std::abs(a[f] - b[f]) / (is_angle(f) ? jump_angle : moved_));
    return most;
  }

  std::vector<double> turned_fields(std::span<const double> positions) const {
    const SphereDirections directions(grid_);
    std::vector<double> values(6 * n_);
    for (std::size_t p = 0; p < n_; ++p) {
      const Angles at = angles_of(turn_ * directions(int(p / length_), int(p % length_)));
      const Values of_point = surface_field_values({positions[p], positions[n_ + p], positions[2 * n_ + p]},
                                                   set_.origin, at.theta, at.phi, signed_dphi_);
      for (std::size_t f = 0; f < 6; ++f) values[f * n_ + p] = of_point[f];
    }
    return values;
  }

  template <class F>
  void for_neighbours(const F& f) const {
    for (std::size_t p = 0; p < n_; ++p) {
      const std::size_t ring = p / length_;
      f(p, ring * length_ + (p + 1) % length_);
      if (ring + 1 < rings_) f(p, p + length_);
    }
  }

  void mark_by_neighbours() {
    marked_.resize(n_);
    for_neighbours([&](std::size_t a, std::size_t b) {
      if (difference(at(a), at(b)) > 1) marked_[a] = marked_[b] = true;
    });
  }

  // Where values at the middles of cells give way to means, the middles' sum is off by the first term of Euler and Maclaurin:
  // a 24th of the step across the border. All round the sphere these terms cancel; along a border they do not.
  void mend_border() {
    std::vector<double> changes;
    std::vector<std::size_t> changed;
    for_neighbours([&](std::size_t a, std::size_t b) {
      if (marked_[a] == marked_[b]) return;
      const std::size_t inner = marked_[a] ? a : b, outer = marked_[a] ? b : a;
      for (std::size_t f = 0; f < 6; ++f) {
        changed.push_back(f * n_ + outer);
        changes.push_back((values_[f * n_ + inner] - values_[f * n_ + outer]) / 24);
      }
    });
    for (std::size_t i = 0; i < changed.size(); ++i) values_[changed[i]] += changes[i];
  }

  // Edges cut into pieces about as long as a cell is wide. Those seen in marked cells are kept; and those whose middle is
  // unlike the cell that it is seen in, if it is seen: the cell is marked.
  void find_pieces(std::span<const Vec3> vertices, std::span<const Face> faces) {
    std::vector<std::pair<std::size_t, Piece>> kept;
    std::vector<Piece> doubtful;
    const auto confirm = [&] {
      const std::vector<bool> seen = are_seen(doubtful);
      for (std::size_t i = 0; i < doubtful.size(); ++i) {
        if (!seen[i]) continue;
        const std::size_t cell = foot_of(doubtful[i]).cell;
        marked_[cell] = true;
        kept.emplace_back(cell, doubtful[i]);
      }
      doubtful.clear();
    };
    for (const Face& face : faces) {
      const Vec3 &a = vertices[face[0]], &b = vertices[face[1]], &c = vertices[face[2]];
      const Vec3 normal = (b - a).cross(c - a).normalized();
      if (!normal.allFinite()) continue;
      for (std::size_t k = 0; k < 3; ++k)
        cut_edge(vertices[face[k]], vertices[face[(k + 1) % 3]], set_.level * normal, [&](const Piece& piece) {
          const Foot foot = foot_of(piece);
          if (marked_[foot.cell])
            kept.emplace_back(foot.cell, piece);
          else if (difference(foot.values, at(foot.cell)) > 1)
            doubtful.push_back(piece);
        });
      if (doubtful.size() >= pieces_at_once) confirm();
    }
    confirm();
    std::stable_sort(kept.begin(), kept.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [cell, piece] : kept) {
      cells_of_pieces_.push_back(cell);
      pieces_.push_back(piece);
    }
  }

  // Into pieces of equal angles, by the law of sines.
  template <class F>
  void cut_edge(const Vec3& from, const Vec3& to, const Vec3& lift, const F& f) const {
    const Vec3 u = from + lift - set_.origin, v = to + lift - set_.origin;
    const double angle = std::atan2(u.cross(v).norm(), u.dot(v));
    const int count = std::max(1, int(std::ceil(angle * double(rings_) / std::numbers::pi)));
    Vec3 last = from;
    for (int i = 1; i <= count; ++i) {
      const double before = u.norm() * std::sin(angle * i / count),
                   after = v.norm() * std::sin(angle * (count - i) / count);
      const bool end = i == count || !(before + after > 0);
      const Vec3 next = end ? to : Vec3(from + before / (before + after) * (to - from));
      f(Piece{last, next, lift});
      if (end) return;
      last = next;
    }
  }

  Foot foot_of(const Piece& piece) const {
    const Vec3 point = piece.middle(), direction = (point + piece.lift - set_.origin).normalized(),
               on_grid = turn_.transpose() * direction;
    // The edges fall from 1 to -1.
    const auto below = std::upper_bound(edges_.begin() + 1, edges_.end() - 1, on_grid.z(), std::greater<>());
    const auto ring = std::size_t(below - edges_.begin()) - 1;
    const double columns = std::atan2(on_grid.y(), on_grid.x()) / step_ - grid_.shift + 0.5;
    const double column = std::floor(columns);
    Foot foot;
    foot.cell = ring * length_ + std::size_t(column + double(length_)) % length_;
    foot.across = std::clamp((edges_[ring] - on_grid.z()) / (edges_[ring] - edges_[ring + 1]), 0.0, 1.0);
    foot.along = columns - column;
    const Angles angles = angles_of(direction);
    foot.values = surface_field_values(point, set_.origin, angles.theta, angles.phi, signed_dphi_);
    return foot;
  }

  // Whether the pieces' middles are feet of the level set.
  std::vector<bool> are_seen(const std::vector<Piece>& pieces) {
    check_stop(monitor_);
    std::vector<Vec3> places;
    for (const Piece& piece : pieces) places.push_back(piece.middle() + piece.lift);
    const double size = std::max(set_.box.min.cwiseAbs().maxCoeff(), set_.box.max.cwiseAbs().maxCoeff());
    const double rounding = 1e-15 * std::max(size, (set_.box.max - set_.box.min).norm()) + 1e-9 * set_.level;
    const ClosestPoints closest = set_.field.closest(places, {.with_sign = false}, monitor_);
    std::vector<bool> seen;
    for (const double distance : closest.distance) seen.push_back(distance >= set_.level - rounding);
    return seen;
  }

  std::vector<CellPart> cells_as_parts() const {
    std::vector<CellPart> parts;
    std::size_t piece = 0;
    for (std::size_t p = 0; p < n_; ++p) {
      if (!marked_[p]) continue;
      CellPart part;
      part.cell = std::uint32_t(p);
      part.first_piece = piece;
      while (piece < pieces_.size() && cells_of_pieces_[piece] == p) ++piece;
      part.last_piece = piece;
      part.values = at(p);
      parts.push_back(part);
    }
    return parts;
  }

  double solid_angle(std::uint32_t cell, int depth) const {
    return grid_.weights[cell / length_] * step_ * std::pow(double(children), -depth);
  }

  void miss(const CellPart& part) {
    found_.missed_length += part.missed_length;
    found_.missed_angle += part.missed_angle;
  }

  Vec3 direction_of(const CellPart& part, int depth, double across, double along) const {
    const double parts = std::pow(double(side), depth);
    const std::size_t ring = part.cell / length_;
    const double down = (part.row + across) / parts, right = (part.column + along) / parts - 0.5;
    const double z = std::clamp(edges_[ring] + down * (edges_[ring + 1] - edges_[ring]), -1.0, 1.0);
    const double s = std::sqrt((1 - z) * (1 + z)), phi = grid_.phi(int(part.cell % length_)) + right * step_;
    return turn_ * Vec3(s * std::cos(phi), s * std::sin(phi), z);
  }

  // Cuts parts of a depth; those of the next depth that are to be cut again are added to `next`, with their pieces.
  void cut(std::span<const CellPart> parts, int depth, std::vector<CellPart>& next, std::vector<Piece>& next_pieces) {
    std::vector<Vec3> directions;
    directions.reserve(parts.size() * children);
    for (const CellPart& part : parts)
      for (const PlaceInPart& place : places_in_part)
        directions.push_back(direction_of(part, depth, place.across, place.along));
    LevelSetReport met;
    const LevelSetPoints ends = level_set_points(set_, directions, monitor_, &met);
    for (const std::uint32_t at : ends.unsettled)
      found_.unsettled_angle += solid_angle(parts[at / children].cell, depth + 1);
    const double share = std::pow(double(children), -depth);
    std::vector<Block> blocks(parts.size());
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const CellPart& part = parts[k];
      Values mean{};
      for (std::size_t i = 0; i < children; ++i) {
        const std::size_t at = k * children + i;
        const Angles angles = angles_of(directions[at]);
        const Values of_part =
            surface_field_values(ends.points[at], set_.origin, angles.theta, angles.phi, signed_dphi_);
        blocks[k].values[places_in_part[i].part] = of_part;
        for (std::size_t f = 0; f < 6; ++f) mean[f] += of_part[f] / children;
      }
      for (std::size_t f = 0; f < 6; ++f)
        values_[f * n_ + part.cell] =
            depth == 0 ? mean[f] : values_[f * n_ + part.cell] + share * (mean[f] - part.values[f]);
      compare_neighbours(blocks[k]);
    }
    find_spikes(parts, depth, blocks);
    for (std::size_t k = 0; k < parts.size(); ++k) judge(parts[k], depth + 1, blocks[k], next, next_pieces);
  }

  void compare_neighbours(Block& block) const {
    block.low = block.high = block.values;
    const auto compare = [&](std::size_t a, std::size_t b) {
      const double d = difference(block.values[a], block.values[b]);
      for (const auto& [one, other] : {std::pair(a, b), std::pair(b, a)}) {
        block.off[one] = std::max(block.off[one], d);
        for (std::size_t f = 0; f < 6; ++f) {
          block.low[one][f] = std::min(block.low[one][f], block.values[other][f]);
          block.high[one][f] = std::max(block.high[one][f], block.values[other][f]);
        }
      }
    };
    for (std::size_t i = 0; i < children; ++i) {
      if (i % side + 1 < side) compare(i, i + 1);
      if (i + side < children) compare(i, i + side);
    }
  }

  // The pieces of each part cut in four, and how far those that are seen stick out of the values about them.
  void find_spikes(std::span<const CellPart> parts, int depth, std::vector<Block>& blocks) {
    struct Found {
      std::size_t block, part;
      double off, length, angle;
    };
    const double per_side = std::pow(double(side), depth + 1);
    std::vector<Piece> pieces;
    std::vector<Found> found;
    for (std::size_t k = 0; k < parts.size(); ++k)
      for (std::size_t p = parts[k].first_piece; p < parts[k].last_piece; ++p)
        for (int quarter = 0; quarter < side; ++quarter) {
          const Vec3 step = (pieces_[p].to - pieces_[p].from) / side;
          const Piece piece{pieces_[p].from + quarter * step, pieces_[p].from + (quarter + 1) * step, pieces_[p].lift};
          const Foot foot = foot_of(piece);
          if (foot.cell != parts[k].cell) continue; // the piece reaches into the next cell
          const auto within = [&](double share, std::uint32_t first) {
            return std::size_t(std::clamp(int(std::floor(share * per_side - double(side) * first)), 0, side - 1));
          };
          const std::size_t part = within(foot.across, parts[k].row) * side + within(foot.along, parts[k].column);
          const Block& block = blocks[k];
          double off = 0, length = 0, angle = 0;
          for (std::size_t f = 0; f < 6; ++f) {
            const double out = std::max(foot.values[f] - block.high[part][f], block.low[part][f] - foot.values[f]);
            off = std::max(off, out / (is_angle(f) ? jump_angle : moved_));
            (is_angle(f) ? angle : length) = std::max(is_angle(f) ? angle : length, out);
          }
          if (!(off > 1)) continue;
          pieces.push_back(piece);
          found.push_back({k, part, off, length, angle});
        }
    const std::vector<bool> seen = are_seen(pieces);
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (!seen[i]) continue;
      Block& block = blocks[found[i].block];
      block.off[found[i].part] = std::max(block.off[found[i].part], found[i].off);
      block.out_length[found[i].part] = std::max(block.out_length[found[i].part], found[i].length);
      block.out_angle[found[i].part] = std::max(block.out_angle[found[i].part], found[i].angle);
      block.pieces.emplace_back(found[i].part, pieces[i]);
    }
  }

  void judge(const CellPart& parent, int depth, Block& block, std::vector<CellPart>& next,
             std::vector<Piece>& next_pieces) const {
    std::stable_sort(block.pieces.begin(), block.pieces.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    auto piece = block.pieces.begin();
    const double solid = solid_angle(parent.cell, depth);
    for (std::size_t i = 0; i < children; ++i) {
      if (!(block.off[i] > 1)) continue;
      CellPart part;
      part.cell = parent.cell;
      part.row = parent.row * side + std::uint32_t(i / side);
      part.column = parent.column * side + std::uint32_t(i % side);
      part.values = block.values[i];
      part.first_piece = next_pieces.size();
      while (piece != block.pieces.end() && piece->first < i) ++piece;
      for (; piece != block.pieces.end() && piece->first == i; ++piece) next_pieces.push_back(piece->second);
      part.last_piece = next_pieces.size();
      part.urgency = solid * block.off[i];
      part.missed_length = solid * block.out_length[i];
      part.missed_angle = solid * block.out_angle[i];
      next.push_back(part);
    }
  }

  const LevelSet& set_;
  const SphereGrid& grid_;
  const bool signed_dphi_;
  const Eigen::Matrix3d turn_;
  const bool turned_;
  Monitor& monitor_;
  CellMeansReport& found_;
  const std::size_t length_, rings_, n_;
  const double step_;
  double moved_ = 0;          ///< length that counts as a jump
  std::vector<double> edges_; ///< cosines of the cells' edges in colatitude
  std::vector<double> values_;
  std::vector<bool> marked_;                 ///< cells whose value becomes a mean
  std::vector<Piece> pieces_;                ///< by the parts that are cut next
  std::vector<std::size_t> cells_of_pieces_; ///< as long as these are cells
};

} // namespace

std::vector<double> cell_mean_fields(const LevelSet& set, std::span<const Vec3> vertices, std::span<const Face> faces,
                                     const SphereGrid& grid, std::span<const double> positions, bool signed_dphi,
                                     const CellMeansOptions& options, Monitor& monitor, CellMeansReport* report,
                                     const Eigen::Matrix3d& turn) {
  if (positions.size() != 3 * grid.points() || (options.parts != 1 && options.parts != side))
    throw Error(
        Fault::bad_argument,
        fmt::format("cell means take 3 numbers for each of {} points and 1 or {} parts a side, not {} numbers and "
                    "{} parts",
                    grid.points(), side, positions.size(), options.parts));
  CellMeansReport found;
  auto values = CellMeans(set, grid, signed_dphi, turn, monitor, found).run(vertices, faces, positions, options);
  if (report) *report = found;
  return values;
}

} // namespace cowgpu
