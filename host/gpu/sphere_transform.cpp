#include "host/gpu/sphere_transform.hpp"

#include "host/error.hpp"

namespace cowgpu::gpu {

std::unique_ptr<SphereTransform> sphere_transform(engine::Gpu&, const SphereGrid&, int) {
  throw Error(Fault::device_failed, "transforms on Vulkan are not there yet: take --device cpu");
}

MemoryNeed sphere_transform_memory(const engine::GpuFacts&, const SphereGrid&, int, int) {
  return {};
}

} // namespace cowgpu::gpu
