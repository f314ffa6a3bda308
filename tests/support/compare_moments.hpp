// One call that runs every path of the stage `moments` and holds each against the reference.
#pragma once

#include "host/backend.hpp"
#include "host/mesh/raw_mesh.hpp"
#include "tests/support/bound_errors.hpp"

#include <functional>
#include <memory>
#include <span>
#include <string>

namespace cowgpu::test {

/// A problem about `origin` with the body's own radius there. `mesh` must outlive it.
MomentProblem moment_problem(const RawMesh& mesh, int lmax, const Vec3& origin = Vec3::Zero());

/// The Vulkan path with validation on, or null where there is no device. Made anew by each call, its device too but where
/// share_device() says otherwise.
std::unique_ptr<Backend> gpu_backend(GpuOptions options = {});
/// Whether the backends of this process are on one device, "auto" is; false closes it. Off at first.
void share_device(bool share);
/// Makes ctest list the test as skipped; the test returns then.
void skip_without_gpu();

/// The CPU path and, where there is a device, the Vulkan path with validation on. At the end of its life it asks that
/// validation had nothing to say.
class Paths {
public:
  Paths();
  ~Paths();
  Paths(const Paths&) = delete;
  Paths& operator=(const Paths&) = delete;

  void each(const std::function<void(Backend&)>& check);

  /// Errors against the reference in 80-bit arithmetic, as compare_by_bound() counts them, are at most `figure` on every path.
  /// `tolerance` is the reference's own.
  void compare(const MomentProblem& problem, double figure, double tolerance = 0);

private:
  std::unique_ptr<Backend> cpu_, gpu_;
};

/// Moments without anybody watching.
Multipoles moments(Backend& backend, const MomentProblem& problem, RunReport* report = nullptr);

/// What Paths::compare does, for one path and a reference at hand.
void compare_path(Backend& backend, const MomentProblem& problem, std::span<const long double> reference,
                  double figure);

/// `a` and `b` are at most `figure` apart, as compare_by_bound() counts it with the bound of `problem`.
void check_close(const Multipoles& a, const Multipoles& b, const MomentProblem& problem, double figure);

/// error <= figure, with the number in words: Catch prints what is below 1e-5 as 0.
void check_at_most(double error, double figure, const std::string& what);

/// The same bits, -0 and 0 told apart.
bool same_bits(const Multipoles& a, const Multipoles& b);

} // namespace cowgpu::test
