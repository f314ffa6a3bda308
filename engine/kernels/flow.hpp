// The kernel flow: every point on its way from the answer to its query to its next query. The method stands in
// shaders/flow.comp, its interface in shaders/flow.h.
#pragma once

#include "engine/kernels/closest.hpp"

#include <cstdint>
#include <memory>
#include <span>

namespace cowgpu::engine {

/// The surface, as shaders/flow.h lays it out.
struct FlowInput {
  std::span<const double> frames;         ///< 22 numbers a face
  std::span<const std::uint32_t> face_of; ///< face of each of the search's triangles
  std::uint32_t iteration_budget = 60000; ///< loop iterations an invocation may run in one dispatch
};

/// What all points share; FlowPush of shaders/flow.h.
struct FlowNumbers {
  double time = 0, time_reached = 0, scale = 0;
  double tolerance[2] = {}, longest[2] = {}, rounds[2] = {};
};

/// What an invocation is to do: FlowEntry of shaders/flow.h.
enum class FlowWhat : std::uint32_t { find, depart, go_on, resume };
struct FlowTask {
  std::uint32_t place;
  FlowWhat what;
  std::uint32_t face; ///< the answer to the query; flow_no_face: among the candidates of the search's query `query`
  std::uint32_t query;
};
inline constexpr std::uint32_t flow_no_face = 0xffffffffU;

/// FlowPoint of shaders/flow.h, which says what is read and what is written.
enum class FlowAsks : std::uint32_t { lift, ray, restart, slide, last };
enum class FlowStatus : std::uint32_t { asks, busy, found, left, done, cut };
struct FlowPlace {
  static constexpr std::uint32_t inside = 1, tighter = 2, recorded = 4, on_sheet = 8; // marks
  double query[3], place[3], time, foot[3], normal[3], distance, radius;
  FlowAsks phase;
  FlowStatus status;
  std::uint32_t face, flags, marks, rounds, queries, events, steps, unused;
};

/// Points on their way off a surface on a device.
class Flow {
public:
  /// Throws Error(out_of_range) for a surface beyond the device's limits or with a budget that no turn fits in;
  /// Error(vulkan), Error(device_lost).
  Flow(Device& device, const FlowInput& input);
  ~Flow();
  Flow(const Flow&) = delete;
  Flow& operator=(const Flow&) = delete;

  /// Room for points; what they were is lost. Throws Error(vulkan), Error(device_lost).
  void reserve(std::uint32_t points);

  std::span<FlowPlace> places();
  std::span<FlowTask> tasks();

  /// Searches for the queries last put into `closest`, if there are any, and runs the first `tasks` of tasks(), the last
  /// `sheets` of them, which are marked on_sheet, by the kernel for those. Throws
  /// Error(cut_short) where the device ended a loop early, Error(vulkan), Error(device_lost).
  void pass(Closest& closest, bool search, const FlowNumbers& numbers, std::uint32_t tasks, std::uint32_t sheets);

  /// Device bytes of a surface, and of so many points.
  static std::uint64_t surface_bytes(std::uint64_t faces);
  static std::uint64_t batch_bytes(std::uint64_t points);

private:
  struct Batch;
  Device& device_;
  const Kernel *kernel_ = nullptr, *sheet_kernel_ = nullptr;
  std::uint32_t turns_ = 0, sheet_turns_ = 0;
  std::unique_ptr<Buffer> frames_, face_of_;
  std::unique_ptr<Batch> batch_;
};

} // namespace cowgpu::engine
