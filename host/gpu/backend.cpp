// The Vulkan path: the verbs of host/backend.hpp on engine/.
#include "host/gpu/backend.hpp"

#include "engine/kernels/peak.hpp"
#include "host/flush_denormals.hpp"
#include "host/gpu/closest.hpp"
#include "host/gpu/environment.hpp"
#include "host/gpu/errors.hpp"
#include "host/gpu/flow.hpp"
#include "host/gpu/moments.hpp"
#include "host/gpu/polyhedron.hpp"
#include "host/gpu/potential.hpp"
#include "host/gpu/render.hpp"
#include "host/gpu/sample.hpp"
#include "host/gpu/sphere_transform.hpp"

namespace cowgpu {
namespace {

DeviceFacts facts_of(const engine::GpuFacts& gpu) {
  DeviceFacts facts;
  facts.name = gpu.name;
  facts.type = gpu.type;
  facts.driver = gpu.driver;
  facts.api = gpu.api;
  facts.fp64 = gpu.fp64;
  facts.usable = gpu.usable;
  facts.subgroup = gpu.subgroup_size;
  facts.memory = gpu.memory;
  facts.largest_buffer = gpu.largest_range;
  facts.shared_memory = gpu.shared_memory;
  return facts;
}

class GpuBackend final : public Backend {
public:
  GpuBackend(std::shared_ptr<engine::Gpu> gpu, const GpuOptions& options)
      : gpu_(std::move(gpu)), facts_(facts_of(gpu_->facts())),
        shape_(engine::moments_shape(gpu_->facts(), gpu::shape_from(options))),
        transform_shape_(engine::sphere_transform_shape(gpu_->facts(), gpu::transform_shape_from(options))),
        iteration_budget_(options.iteration_budget), translations_(options.translations) {}

  const DeviceFacts& facts() const override { return facts_; }

  std::unique_ptr<PreparedMoments> moments(const MomentProblem& problem) const override {
    return gpu::moments(gpu_, shape_, problem);
  }

  std::unique_ptr<SphereTransform> sphere_transform(const SphereGrid& grid, int lmax) const override {
    return gpu::sphere_transform(gpu_, transform_shape_, grid, lmax);
  }

  std::unique_ptr<SphereSampler> sphere_sampler(const SphereGrid& grid) const override {
    return gpu::sphere_sampler(gpu_, grid);
  }

  std::unique_ptr<DistanceField> distance_field(std::span<const Vec3> vertices,
                                                std::span<const Face> faces) const override {
    return gpu::distance_field(gpu_, iteration_budget_, vertices, faces);
  }

  std::unique_ptr<DistanceFlow> distance_flow(std::span<const Vec3> vertices,
                                              std::span<const Face> faces) const override {
    return gpu::distance_flow(gpu_, iteration_budget_, vertices, faces);
  }

  std::unique_ptr<ExteriorPotential> exterior_potential(const PotentialProblem& problem) const override {
    return gpu::exterior_potential(gpu_, iteration_budget_, problem);
  }

  std::unique_ptr<PreparedPolyhedron> polyhedron(const PolyhedronProblem& problem) const override {
    return gpu::polyhedron(gpu_, {shape_, iteration_budget_, translations_}, problem);
  }

  Image render(const RenderScene& scene, Monitor& monitor) override {
    return gpu::watched(*gpu_, monitor, [&] { return gpu::render(*gpu_, iteration_budget_, scene, monitor); });
  }

  double measured_peak() override {
    return gpu::translated([&] { return engine::peak(gpu_->device()); });
  }

  std::vector<std::string> validation_messages() const override { return gpu_->validation_messages(); }

private:
  std::shared_ptr<engine::Gpu> gpu_;
  DeviceFacts facts_;
  engine::MomentsShape shape_;
  engine::SphereTransformShape transform_shape_;
  std::uint32_t iteration_budget_;
  bool translations_;
};

} // namespace

std::shared_ptr<engine::Gpu> gpu::open_gpu(const GpuOptions& options) {
  prepare_environment();
  const FlushDenormals flush; // the threads of a software device start now and inherit it
  return translated([&] { return std::make_shared<engine::Gpu>(options.device, options.validation); });
}

std::unique_ptr<Backend> gpu::make_backend(std::shared_ptr<engine::Gpu> gpu, const GpuOptions& options) {
  check(options);
  return translated([&] { return std::make_unique<GpuBackend>(std::move(gpu), options); });
}

std::unique_ptr<Backend> make_gpu_backend(const GpuOptions& options) {
  gpu::check(options); // before a device is opened: it needs none
  return gpu::make_backend(gpu::open_gpu(options), options);
}

std::vector<DeviceFacts> list_gpus(std::string* reason) {
  gpu::prepare_environment();
  std::vector<DeviceFacts> list;
  try {
    for (const engine::GpuFacts& gpu : engine::list_gpus()) list.push_back(facts_of(gpu));
    if (list.empty() && reason) *reason = "there is a Vulkan loader but no device";
  } catch (const engine::Error& error) {
    if (reason) *reason = error.what();
  }
  return list;
}

} // namespace cowgpu
