// The CPU path for tests that put a fault into one of its verbs: derive, and override that verb.
#pragma once

#include "host/backend.hpp"
#include "host/image.hpp"
#include "host/render.hpp"

#include <memory>

namespace cowgpu::test {

class CpuWithAFault : public Backend {
public:
  const DeviceFacts& facts() const override { return cpu_->facts(); }
  std::unique_ptr<PreparedMoments> moments(const MomentProblem& problem) const override {
    return cpu_->moments(problem);
  }
  std::unique_ptr<SphereTransform> sphere_transform(const SphereGrid& grid, int lmax) const override {
    return cpu_->sphere_transform(grid, lmax);
  }
  std::unique_ptr<SphereSampler> sphere_sampler(const SphereGrid& grid) const override {
    return cpu_->sphere_sampler(grid);
  }
  std::unique_ptr<DistanceField> distance_field(std::span<const Vec3> vertices,
                                                std::span<const Face> faces) const override {
    return cpu_->distance_field(vertices, faces);
  }
  std::unique_ptr<DistanceFlow> distance_flow(std::span<const Vec3> vertices,
                                              std::span<const Face> faces) const override {
    return cpu_->distance_flow(vertices, faces);
  }
  std::unique_ptr<ExteriorPotential> exterior_potential(const PotentialProblem& problem) const override {
    return cpu_->exterior_potential(problem);
  }
  std::unique_ptr<PreparedPolyhedron> polyhedron(const PolyhedronProblem& problem) const override {
    return cpu_->polyhedron(problem);
  }
  Image render(const RenderScene& scene, Monitor& monitor) override { return cpu_->render(scene, monitor); }
  double measured_peak() override { return cpu_->measured_peak(); }

private:
  std::unique_ptr<Backend> cpu_ = make_cpu_backend();
};

} // namespace cowgpu::test
