#include "host/cpu/closest.hpp"

#include "host/parallel.hpp"
#include "host/plan/closest_call.hpp"
#include "host/plan/closest_kernel.hpp"

#include <algorithm>
#include <limits>
#include <optional>

namespace cowgpu::cpu {
namespace {

class CpuDistanceField final : public DistanceField {
public:
  CpuDistanceField(std::span<const Vec3> vertices, std::span<const Face> faces, unsigned threads)
      : vertices_(vertices), faces_(faces), threads_(threads ? threads : all_threads()) {}

  MemoryNeed memory(std::uint64_t queries) const override {
    return {plan::distance_field_bytes(vertices_.size(), faces_.size(), queries), 0};
  }

  void prepare() override {
    if (!tree_) tree_.emplace(vertices_, faces_);
  }

  ClosestPoints closest(std::span<const Vec3> queries, const ClosestOptions& options, Monitor& monitor,
                        ClosestReport* report) override {
    prepare();
    plan::ClosestCall call(*tree_, queries, options, threads_);
    call.each_part(0, queries.size(), monitor, [&](std::span<const Vec3> points, std::size_t, std::uint32_t* faces) {
      plan::WarmSlots warm;
      for (std::size_t first = 0; first < points.size(); first += plan::packet) {
        const std::size_t count = std::min(plan::packet, points.size() - first);
        const Vec3* p = points.data() + first;
        if (std::none_of(p, p + count, [&](const Vec3& q) { return tree_->is_far(q); }))
          plan::closest_packet(*tree_, p, count, warm, faces + first);
        else
          for (std::size_t i = 0; i < count; ++i)
            faces[first + i] = plan::closest_single(*tree_, p[i], std::numeric_limits<double>::infinity(), no_face);
      }
    });
    return call.finish(report);
  }

private:
  std::span<const Vec3> vertices_;
  std::span<const Face> faces_;
  unsigned threads_;
  std::optional<plan::ClosestTree> tree_;
};

} // namespace

std::unique_ptr<DistanceField> distance_field(std::span<const Vec3> vertices, std::span<const Face> faces,
                                              unsigned threads) {
  return std::make_unique<CpuDistanceField>(vertices, faces, threads);
}

} // namespace cowgpu::cpu
