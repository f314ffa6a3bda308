#include "host/cpu/closest.hpp"

#include "host/cpu/closest_call.hpp"
#include "host/cpu/closest_kernel.hpp"
#include "host/orientation.hpp"
#include "host/parallel.hpp"

#include <algorithm>
#include <cmath>

namespace cowgpu::cpu {
namespace {

class CpuDistanceField final : public DistanceField {
public:
  CpuDistanceField(std::span<const Vec3> vertices, std::span<const Face> faces, unsigned threads)
      : tree_(vertices, faces), threads_(threads ? threads : all_threads()) {}

  ClosestPoints closest(std::span<const Vec3> queries, const ClosestOptions& options, Monitor& monitor,
                        ClosestReport* report) override {
    ClosestCall call(tree_, queries, options, threads_);
    call.each_part(0, queries.size(), monitor, [&](std::span<const Vec3> points, std::size_t, std::uint32_t* faces) {
      WarmSlots warm;
      for (std::size_t first = 0; first < points.size(); first += packet) {
        const std::size_t count = std::min(packet, points.size() - first);
        const Vec3* p = points.data() + first;
        if (std::none_of(p, p + count, [&](const Vec3& q) { return tree_.is_far(q); }))
          closest_packet(tree_, p, count, warm, faces + first);
        else
          for (std::size_t i = 0; i < count; ++i)
            faces[first + i] = closest_single(tree_, p[i], std::numeric_limits<double>::infinity(), no_face);
      }
    });
    return call.finish(report);
  }

private:
  plan::ClosestTree tree_;
  unsigned threads_;
};

} // namespace

std::unique_ptr<DistanceField> distance_field(std::span<const Vec3> vertices, std::span<const Face> faces,
                                              unsigned threads) {
  return std::make_unique<CpuDistanceField>(vertices, faces, threads);
}

std::uint64_t distance_field_bytes(std::uint64_t vertices, std::uint64_t faces, std::uint64_t queries) {
  constexpr std::uint64_t one = 2 * sizeof(double) + 2 * sizeof(Vec3) + sizeof(SurfaceFeature) + 8;
  return plan::ClosestTree::bytes(faces, vertices) + queries * (one + 20);
}

std::optional<SurfacePoint> closest_point(const plan::ClosestTree& tree, const Vec3& query, double below,
                                          std::uint32_t warm_face) {
  // The search counts by squares, whose rounding must not decide.
  const double wider = below + 1e-15 * (tree.size + query.cwiseAbs().maxCoeff());
  const std::uint32_t face =
      closest_single(tree, query, wider, warm_face == no_face ? no_face : tree.slot_of_face[warm_face]);
  if (face == no_face) return std::nullopt;
  const SurfacePoint found = tree.on_face(face, query);
  if (!(found.distance < below)) return std::nullopt;
  return found;
}

int winding_number(const plan::ClosestTree& tree, const Vec3& query) {
  if ((query.array() < tree.low.array()).any() || (query.array() > tree.high.array()).any()) return 0;
  const bool up = query.z() > tree.centre.z();
  int winding = 0;
  thread_local std::vector<std::uint32_t> column;
  column.clear();
  column_faces(tree, query, up, column);
  for (const std::uint32_t face : column) {
    const Face& f = tree.faces[face];
    const Vec3 &a = tree.vertices[f[0]], &b = tree.vertices[f[1]], &c = tree.vertices[f[2]];
    winding += vertical_crossing(a, b, c, query, up);
  }
  return winding;
}

} // namespace cowgpu::cpu
