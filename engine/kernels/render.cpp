#include "engine/kernels/render.hpp"

#include "engine/host_buffer.hpp"
#include "engine/job.hpp"
#include "shaders/render.h"
#include "shaders/render.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu::engine {
namespace {

constexpr std::uint32_t width = 64; // rays a workgroup
constexpr std::uint64_t texel_bytes = 16;

static_assert(sizeof(RenderRay) == 56 && sizeof(RenderHit) == 32);
static_assert(render_nothing == RENDER_NOTHING && render_left == RENDER_LEFT);

// Rays that run in step take as long as the slowest of them; each step has a loop over a leaf.
std::uint32_t steps_within(std::uint32_t budget) {
  return budget / (1 + RENDER_LEAF);
}

} // namespace

std::uint64_t Render::device_bytes(std::uint64_t nodes, std::uint64_t triangles) {
  return texel_bytes * (RENDER_NODE_TEXELS * nodes + RENDER_TRIANGLE_TEXELS * triangles) +
         most_rays * (sizeof(RenderRay) + sizeof(RenderHit));
}

Render::Render(Device& device, const RenderInput& input)
    : device_(device), steps_(steps_within(input.iteration_budget)) {
  const std::uint64_t texels = std::max(input.triangles.size(), input.nodes.size()) / texel_bytes;
  if (texels > device.limits().maxTexelBufferElements || texels >> 31)
    throw Error(Failure::out_of_range, 0,
                fmt::format("a tree of {} texels is more than the device {} reads from a buffer, which is {}; use "
                            "--device cpu",
                            texels, device.name(), device.limits().maxTexelBufferElements));
  if (steps_ < 1)
    throw Error(Failure::out_of_range, 0,
                fmt::format("{} loop iterations an invocation leave no step for a ray", input.iteration_budget));
  kernel_ = &device.kernel({"render",
                            shaders::render,
                            RENDER_BINDINGS,
                            sizeof(shaders::RenderPush),
                            {width},
                            {BindingKind::texel_doubles, BindingKind::texel_doubles}});
  nodes_ = std::make_unique<Buffer>(device, input.nodes.size(), "the tree");
  triangles_ = std::make_unique<Buffer>(device, input.triangles.size(), "the triangles");
  nodes_->write(input.nodes);
  triangles_->write(input.triangles);
  rays_ = std::make_unique<HostBuffer>(device, most_rays * sizeof(RenderRay), "the rays");
  hits_ = std::make_unique<HostBuffer>(device, most_rays * sizeof(RenderHit), "the rays' hits");
}

Render::~Render() = default;

std::span<RenderRay> Render::rays() {
  return rays_->host<RenderRay>().first(most_rays);
}

std::span<const RenderHit> Render::cast(std::uint32_t count) {
  rays_->send();
  const shaders::RenderPush push = {count, steps_};
  const BufferRange ranges[RENDER_BINDINGS] = {
      {nodes_.get()}, {triangles_.get()}, {&rays_->buffer()}, {&hits_->buffer()}};
  Job job(device_);
  job.dispatch(*kernel_, ranges, std::as_bytes(std::span(&push, 1)), (count + width - 1) / width);
  job.run();
  hits_->receive();
  const std::span<const RenderHit> hits = hits_->host<RenderHit>().first(count);
  const auto cut = std::count_if(hits.begin(), hits.end(), [](const RenderHit& hit) { return hit.face == RENDER_CUT; });
  if (cut > 0)
    throw Error(Failure::cut_short, 0,
                fmt::format("the device {} ended a loop early: {} of {} rays were not followed to their end; the "
                            "picture would be wrong; use --device cpu and report this",
                            device_.name(), cut, count));
  return hits;
}

} // namespace cowgpu::engine
