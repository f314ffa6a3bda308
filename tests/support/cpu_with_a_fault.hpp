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
  Multipoles moments(const MomentProblem& problem, Monitor& monitor, RunReport* report) override {
    return cpu_->moments(problem, monitor, report);
  }
  MemoryNeed moments_memory(const MomentProblem& problem) const override { return cpu_->moments_memory(problem); }
  std::unique_ptr<SphereTransform> sphere_transform(const SphereGrid& grid, int lmax) override {
    return cpu_->sphere_transform(grid, lmax);
  }
  MemoryNeed sphere_transform_memory(const SphereGrid& grid, int lmax, int fields) const override {
    return cpu_->sphere_transform_memory(grid, lmax, fields);
  }
  SphereSamples sample(std::span<const Vec3> positions, std::span<const Face> faces, const SphereGrid& grid,
                       Monitor& monitor, RunReport* report) override {
    return cpu_->sample(positions, faces, grid, monitor, report);
  }
  MemoryNeed sample_memory(std::uint64_t faces, const SphereGrid& grid) const override {
    return cpu_->sample_memory(faces, grid);
  }
  std::unique_ptr<DistanceField> distance_field(std::span<const Vec3> vertices, std::span<const Face> faces) override {
    return cpu_->distance_field(vertices, faces);
  }
  MemoryNeed distance_field_memory(std::uint64_t vertices, std::uint64_t faces, std::uint64_t queries) const override {
    return cpu_->distance_field_memory(vertices, faces, queries);
  }
  std::unique_ptr<DistanceFlow> distance_flow(std::span<const Vec3> vertices, std::span<const Face> faces) override {
    return cpu_->distance_flow(vertices, faces);
  }
  MemoryNeed distance_flow_memory(std::uint64_t vertices, std::uint64_t faces, std::uint64_t starts) const override {
    return cpu_->distance_flow_memory(vertices, faces, starts);
  }
  PotentialField potential(const PotentialProblem& problem, Monitor& monitor, RunReport* report) override {
    return cpu_->potential(problem, monitor, report);
  }
  MemoryNeed potential_memory(std::uint64_t points, int lmax, Derivatives derivatives) const override {
    return cpu_->potential_memory(points, lmax, derivatives);
  }
  Image render(const RenderScene& scene, Monitor& monitor) override { return cpu_->render(scene, monitor); }
  double measured_peak() override { return cpu_->measured_peak(); }

private:
  std::unique_ptr<Backend> cpu_ = make_cpu_backend();
};

} // namespace cowgpu::test
