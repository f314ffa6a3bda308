#include "host/gpu/sample.hpp"

#include "host/error.hpp"

namespace cowgpu::gpu {

SphereSamples sample(engine::Gpu&, std::span<const Vec3>, std::span<const Face>, const SphereGrid&, Monitor&,
                     RunReport*) {
  throw Error(Fault::device_failed, "sampling on Vulkan is not there yet: take --device cpu");
}

MemoryNeed sample_memory(const engine::GpuFacts&, std::uint64_t, const SphereGrid&) {
  return {};
}

} // namespace cowgpu::gpu
