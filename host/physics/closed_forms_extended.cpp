#include "host/physics/closed_forms.hpp"

#include "host/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

namespace cowgpu::physics {
namespace {

using Real = long double;

constexpr std::size_t extended_points_per_task = 4;

class ExtendedForms final : public ClosedForms {
public:
  ExtendedForms(const Body& body, unsigned threads)
      : surfaces_(body_surfaces(body)), threads_(threads ? threads : all_threads()) {
    for (const DenseSurface& part : surfaces_) {
      vertices_ += part.surface->vertices().size();
      faces_ += part.surface->faces().size();
    }
  }

  FieldError rounding(Real reach) const override {
    FieldError sum;
    for (const Piece& piece : pieces()) {
      const FieldError error = piece.polyhedron.rounding(reach);
      sum.value += std::fabs(piece.density) * error.value;
      sum.gradient += std::fabs(piece.density) * error.gradient;
      sum.hessian += std::fabs(piece.density) * error.hessian;
    }
    return sum;
  }

  void at(std::span<const Vec3> points, std::span<const std::uint32_t> which, const Put& put, Monitor& monitor,
          RunReport*) const override {
    const std::size_t count = which.size();
    const std::vector<Piece>& all = pieces();
    std::vector<Polyhedron::Scratch> scratch(threads_);
    std::atomic<std::size_t> done = 0;
    parallel_for(threads_, (count + extended_points_per_task - 1) / extended_points_per_task,
                 [&](std::size_t task, unsigned thread) {
                   const std::size_t end = std::min(count, (task + 1) * extended_points_per_task);
                   for (std::size_t k = task * extended_points_per_task; k < end; ++k) {
                     check_stop(monitor);
                     put(which[k], sum_at(all, points[which[k]], scratch[thread]), 0, thread);
                     const std::size_t now = ++done;
                     if (thread == 0) monitor.progress("exact potential", double(now) / double(count));
                   }
                 });
  }

  MemoryNeed memory(std::uint64_t) const override {
    // Halves of edges are sorted beside the edges, each about 200 bytes.
    return {vertices_ * 48 * (1 + threads_) + 64 * vertices_ + faces_ * (3 * 400 + 2 * 240 + 96), 0};
  }

private:
  struct Piece {
    Polyhedron polyhedron;
    Real density;
  };

  // Made when they are asked for, so that memory() tells before what they take.
  const std::vector<Piece>& pieces() const {
    std::call_once(made_, [&] {
      for (const DenseSurface& part : surfaces_)
        pieces_.push_back({Polyhedron(part.surface->vertices(), part.surface->faces()), part.density});
    });
    return pieces_;
  }

  static PolyhedronAt sum_at(const std::vector<Piece>& pieces, const Vec3& point, Polyhedron::Scratch& room) {
    PolyhedronAt sum;
    for (const Piece& piece : pieces) {
      const PolyhedronAt at = piece.polyhedron.at(point.cast<Real>(), room);
      sum.value += piece.density * at.value;
      sum.gradient += piece.density * at.gradient;
      sum.hessian += piece.density * at.hessian;
      sum.winding += piece.density * at.winding;
      sum.on_edge = sum.on_edge || at.on_edge;
    }
    return sum;
  }

  std::vector<DenseSurface> surfaces_;
  unsigned threads_;
  mutable std::once_flag made_;
  mutable std::vector<Piece> pieces_;
  std::uint64_t vertices_ = 0, faces_ = 0;
};

} // namespace

std::vector<DenseSurface> body_surfaces(const Body& body) {
  std::vector<DenseSurface> all = {{&body.surface, body.density, body.volume}};
  for (const Part& part : body.parts) all.push_back({&part.surface, part.density, part.volume});
  return all;
}

std::unique_ptr<const ClosedForms> extended_forms(const Body& body, unsigned threads) {
  return std::make_unique<ExtendedForms>(body, threads);
}

} // namespace cowgpu::physics
