// The CPU path: the verbs of host/backend.hpp on this machine's cores.
#include "host/backend.hpp"

#include "host/cpu/closest.hpp"
#include "host/cpu/flow.hpp"
#include "host/cpu/moments.hpp"
#include "host/cpu/moments_kernel.hpp"
#include "host/cpu/peak.hpp"
#include "host/cpu/potential.hpp"
#include "host/cpu/render.hpp"
#include "host/cpu/sample.hpp"
#include "host/cpu/sphere_transform.hpp"
#include "host/parallel.hpp"
#include "host/plan/closest_call.hpp"
#include "host/plan/flow_call.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>

namespace cowgpu {
namespace {

std::string processor_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.rfind("model name", 0) == 0)
      if (const auto colon = line.find(": "); colon != std::string::npos) return line.substr(colon + 2);
  return "processor";
}

class CpuBackend final : public Backend {
public:
  explicit CpuBackend(unsigned threads) : threads_(threads ? threads : all_threads()) {
    facts_.name = processor_name();
    facts_.type = "cpu";
    facts_.driver = cpu::simd_name();
    facts_.api = "native";
    facts_.subgroup = std::uint32_t(cpu::moments_lanes());
    facts_.memory = std::uint64_t(sysconf(_SC_PHYS_PAGES)) * std::uint64_t(sysconf(_SC_PAGE_SIZE));
    facts_.threads = threads_;
  }

  const DeviceFacts& facts() const override { return facts_; }
  Multipoles moments(const MomentProblem& problem, Monitor& monitor, RunReport* report) override {
    return cpu::moments(problem, threads_, monitor, report);
  }
  MemoryNeed moments_memory(const MomentProblem& problem) const override {
    return {cpu::moments_bytes(problem, threads_), 0};
  }
  std::unique_ptr<SphereTransform> sphere_transform(const SphereGrid& grid, int lmax) override {
    return cpu::sphere_transform(grid, lmax, threads_);
  }
  MemoryNeed sphere_transform_memory(const SphereGrid& grid, int lmax, int fields) const override {
    return cpu::sphere_transform_memory(grid, lmax, fields, threads_);
  }
  SphereSamples sample(std::span<const Vec3> positions, std::span<const Face> faces, const SphereGrid& grid,
                       Monitor& monitor, RunReport* report) override {
    return cpu::sample(positions, faces, grid, threads_, monitor, report);
  }
  MemoryNeed sample_memory(std::uint64_t faces, const SphereGrid& grid) const override {
    return {cpu::sample_bytes(faces, grid), 0};
  }
  std::unique_ptr<DistanceField> distance_field(std::span<const Vec3> vertices, std::span<const Face> faces) override {
    return cpu::distance_field(vertices, faces, threads_);
  }
  MemoryNeed distance_field_memory(std::uint64_t vertices, std::uint64_t faces, std::uint64_t queries) const override {
    return {plan::distance_field_bytes(vertices, faces, queries), 0};
  }
  std::unique_ptr<DistanceFlow> distance_flow(std::span<const Vec3> vertices, std::span<const Face> faces) override {
    return cpu::distance_flow(vertices, faces, threads_);
  }
  MemoryNeed distance_flow_memory(std::uint64_t vertices, std::uint64_t faces, std::uint64_t starts) const override {
    return {plan::distance_flow_bytes(vertices, faces, starts), 0};
  }
  PotentialField potential(const PotentialProblem& problem, Monitor& monitor, RunReport* report) override {
    return cpu::potential(problem, threads_, monitor, report);
  }
  MemoryNeed potential_memory(std::uint64_t points, int lmax, Derivatives derivatives) const override {
    return {cpu::potential_bytes(points, lmax, derivatives), 0};
  }
  Image render(const RenderScene& scene, Monitor& monitor) override { return cpu::render(scene, threads_, monitor); }
  double measured_peak() override { return cpu::peak(threads_); }

private:
  unsigned threads_;
  DeviceFacts facts_;
};

} // namespace

std::unique_ptr<Backend> make_cpu_backend(unsigned threads) {
  return std::make_unique<CpuBackend>(threads);
}

} // namespace cowgpu
