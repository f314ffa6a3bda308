#include "tests/support/compare_moments.hpp"

#include "engine/device.hpp"
#include "host/error.hpp"
#include "host/gpu/backend.hpp"
#include "host/mesh/geometry.hpp"
#include "host/plan/moments.hpp"
#include "host/reference/moments.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cstring>
#include <iostream>

namespace cowgpu::test {
namespace {

bool shares_device = false;
std::shared_ptr<engine::Gpu> shared_gpu;

std::shared_ptr<engine::Gpu> gpu_for(const GpuOptions& options) {
  if (!shares_device || options.device != GpuOptions().device) return gpu::open_gpu(options);
  if (!shared_gpu || shared_gpu->device().lost()) shared_gpu = gpu::open_gpu(options);
  return shared_gpu;
}

} // namespace

MomentProblem moment_problem(const RawMesh& mesh, int lmax, const Vec3& origin) {
  MomentProblem problem;
  problem.vertices = mesh.vertices;
  problem.faces = mesh.faces;
  problem.origin = origin;
  problem.reference_radius = mesh.faces.empty() ? 1 : brillouin_radius(mesh.vertices, mesh.faces, origin);
  problem.lmax = lmax;
  return problem;
}

std::unique_ptr<Backend> gpu_backend(GpuOptions options) {
  options.validation = true;
  try {
    return gpu::make_backend(gpu_for(options), options);
  } catch (const Error& error) {
    if (error.fault() != Fault::no_loader && error.fault() != Fault::no_device && error.fault() != Fault::no_fp64)
      throw;
    return {};
  }
}

void share_device(bool share) {
  shares_device = share;
  if (!share) shared_gpu.reset();
}

void skip_without_gpu() {
  std::cout << "SKIPPED: no Vulkan device" << std::endl;
}

Paths::Paths() : cpu_(make_cpu_backend()), gpu_(gpu_backend()) {}

Paths::~Paths() {
  if (gpu_) CHECK(gpu_->validation_messages() == std::vector<std::string>{});
}

void Paths::each(const std::function<void(Backend&)>& check) {
  check(*cpu_);
  if (gpu_) check(*gpu_);
}

void Paths::compare(const MomentProblem& problem, double figure, double tolerance) {
  const auto reference = reference::moments<long double>(problem, tolerance);
  each([&](Backend& backend) { compare_path(backend, problem, reference, figure); });
}

Multipoles moments(Backend& backend, const MomentProblem& problem, RunReport* report) {
  Monitor silent;
  return backend.moments(problem, silent, report);
}

void compare_path(Backend& backend, const MomentProblem& problem, std::span<const long double> reference,
                  double figure) {
  const Multipoles result = moments(backend, problem);
  REQUIRE(result.values.size() == Multipoles::count(problem.lmax));
  REQUIRE(result.lmax == problem.lmax);
  CHECK(result.origin == problem.origin);
  CHECK(result.reference_radius == problem.reference_radius);
  CHECK(result.density == problem.density);
  const BoundErrors errors = compare_by_bound(result, reference, plan::degree_bound(problem));
  check_at_most(errors.worst, figure,
                fmt::format("{}, {} faces, lmax {}, degree {}", backend.facts().type, problem.faces.size(),
                            problem.lmax, errors.worst_degree));
}

void check_close(const Multipoles& a, const Multipoles& b, const MomentProblem& problem, double figure) {
  const BoundErrors errors = compare_by_bound(a, b, plan::degree_bound(problem));
  check_at_most(errors.worst, figure, fmt::format("lmax {}, degree {}", problem.lmax, errors.worst_degree));
}

void check_at_most(double error, double figure, const std::string& what) {
  INFO(what << ": " << error << " against " << figure);
  CHECK(error <= figure);
}

bool same_bits(const Multipoles& a, const Multipoles& b) {
  return a.values.size() == b.values.size() &&
         std::memcmp(a.values.data(), b.values.data(), a.values.size() * sizeof(a.values[0])) == 0;
}

} // namespace cowgpu::test
