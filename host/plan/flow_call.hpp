// What a call of the verb `flow` does beside finding nearest faces, for both paths: the order of the starts, their runs, the
// results.
#pragma once

#include "host/flow.hpp"
#include "host/plan/flow_path.hpp"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu::plan {

/// Bytes of a flow and of one call of so many starts, their result included, streamlines not.
std::uint64_t distance_flow_bytes(std::uint64_t vertices, std::uint64_t faces, std::uint64_t starts);

class FlowCall {
public:
  /// Sorts the starts. Throws as DistanceFlow::flow does. All must outlive the call.
  FlowCall(const FlowSurface& surface, std::span<const Vec3> starts, std::span<const Vec3> normals,
           const FlowOptions& options, unsigned threads);

  /// The starts along the Morton curve.
  std::span<const std::uint32_t> order() const { return order_; }
  std::size_t size() const { return starts_.size(); }

  /// The results; fills the report but for passes and kernels.
  FlowPoints finish(FlowReport* report);

private:
  friend class FlowRun;
  FlowEnd backward(std::uint32_t start, std::uint32_t face);
  void set(std::uint32_t start, const FlowEnd& end);
  FlowTrace* trace(std::uint32_t start) { return traces_.empty() ? nullptr : &traces_[start]; }

  const FlowSurface& surface_;
  std::span<const Vec3> starts_, normals_;
  const FlowOptions options_;
  std::chrono::steady_clock::time_point begin_;
  std::vector<std::uint32_t> order_;
  FlowPoints points_;
  std::vector<FlowTrace> traces_;
  std::atomic<std::uint64_t> events_ = 0, steps_ = 0;
};

/// One start on its way. A path that does not come to its end runs again at a tighter tolerance.
class FlowRun {
public:
  /// The call outlives it.
  FlowRun(FlowCall& call, std::uint32_t start);

  /// As FlowPath has them.
  bool done() const { return path_.done(); }
  const Vec3& query() const { return path_.query(); }
  std::uint32_t warm() const { return path_.warm(); }

  /// Goes on to the next query or to the end, which it puts down in the call. Several threads may each have a run.
  void answer(std::uint32_t face);

  /// For whoever goes on elsewhere after the first answer: where from, at which tolerance; the corners it passes; its end,
  /// after which it is done or starts again. Until then it can go back to where it left, corners forgotten.
  const FlowPath& path() const { return path_; }
  bool tighter() const { return again_; }
  void pass(const Vec3& place, double time);
  void arrive(const FlowEnd& found);
  void go_back();

  /// Of the second way.
  static double tighter(double tolerance);

private:
  FlowCall* call_;
  std::uint32_t start_;
  bool again_ = false;
  std::size_t passed_ = 0; // corners
  FlowEnd first_;
  FlowPath path_;
};

} // namespace cowgpu::plan
