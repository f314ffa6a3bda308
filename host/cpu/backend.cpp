// The CPU path: the verbs of host/backend.hpp on this machine's cores.
#include "host/backend.hpp"

#include "host/bounds.hpp"
#include "host/cpu/closest.hpp"
#include "host/cpu/flow.hpp"
#include "host/cpu/moments.hpp"
#include "host/cpu/moments_kernel.hpp"
#include "host/cpu/peak.hpp"
#include "host/cpu/polyhedron.hpp"
#include "host/cpu/potential.hpp"
#include "host/cpu/render.hpp"
#include "host/cpu/sample.hpp"
#include "host/cpu/sphere_transform.hpp"
#include "host/parallel.hpp"

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
  std::unique_ptr<PreparedMoments> moments(const MomentProblem& problem) const override {
    return cpu::moments(problem, threads_);
  }
  std::unique_ptr<SphereTransform> sphere_transform(const SphereGrid& grid, int lmax) const override {
    return cpu::sphere_transform(grid, lmax, threads_);
  }
  std::unique_ptr<SphereSampler> sphere_sampler(const SphereGrid& grid) const override {
    return cpu::sphere_sampler(grid, threads_);
  }
  std::unique_ptr<DistanceField> distance_field(std::span<const Vec3> vertices,
                                                std::span<const Face> faces) const override {
    return cpu::distance_field(vertices, faces, threads_);
  }
  std::unique_ptr<DistanceFlow> distance_flow(std::span<const Vec3> vertices,
                                              std::span<const Face> faces) const override {
    return cpu::distance_flow(vertices, faces, threads_);
  }
  std::unique_ptr<ExteriorPotential> exterior_potential(const PotentialProblem& problem) const override {
    return cpu::exterior_potential(problem, threads_);
  }
  std::unique_ptr<PreparedPolyhedron> polyhedron(const PolyhedronProblem& problem) const override {
    return cpu::polyhedron(problem, threads_);
  }
  Image render(const RenderScene& scene, Monitor& monitor) override { return cpu::render(scene, threads_, monitor); }
  double measured_peak() override { return cpu::peak(threads_); }

private:
  unsigned threads_;
  DeviceFacts facts_;
};

} // namespace

std::unique_ptr<Backend> make_cpu_backend(unsigned threads) {
  require_range("the threads of the CPU path are", threads, 0U, most_threads);
  return std::make_unique<CpuBackend>(threads);
}

} // namespace cowgpu
