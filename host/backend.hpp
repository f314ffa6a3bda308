// The verbs of the engine. One interface, two implementations: host/cpu and host/gpu.
#pragma once

#include "host/device_facts.hpp"
#include "host/distance_field.hpp"
#include "host/flow.hpp"
#include "host/image.hpp"
#include "host/moments.hpp"
#include "host/monitor.hpp"
#include "host/polyhedron.hpp"
#include "host/potential.hpp"
#include "host/render.hpp"
#include "host/sphere_samples.hpp"
#include "host/sphere_transform.hpp"
#include "host/types.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace cowgpu {

/// An engine: the CPU, or one Vulkan device.
class Backend {
public:
  virtual ~Backend() = default;
  virtual const DeviceFacts& facts() const = 0;

  // What these return is cheap to make: it allocates, builds tables and opens pipelines when it is used, or by its prepare().
  // Its memory() tells before how much that will be. It keeps what it needs of the backend alive.

  /// The verb `moments`.
  virtual std::unique_ptr<PreparedMoments> moments(const MomentProblem& problem) const = 0;

  /// The verbs `analyse` and `synthesise` on a grid. Throws Error(bad_argument) unless 0 <= lmax <= grid.lmax.
  virtual std::unique_ptr<SphereTransform> sphere_transform(const SphereGrid& grid, int lmax) const = 0;

  /// The verb `sample` on a grid.
  virtual std::unique_ptr<SphereSampler> sphere_sampler(const SphereGrid& grid) const = 0;

  /// The verb `closest` on a triangle surface. Every path gives the same bits (host/gpu/closest.hpp).
  virtual std::unique_ptr<DistanceField> distance_field(std::span<const Vec3> vertices,
                                                        std::span<const Face> faces) const = 0;

  /// The verb `flow` off a closed triangle surface. Every path gives the same bits (host/gpu/flow.hpp).
  virtual std::unique_ptr<DistanceFlow> distance_flow(std::span<const Vec3> vertices,
                                                      std::span<const Face> faces) const = 0;

  /// The verb `potential`.
  virtual std::unique_ptr<ExteriorPotential> exterior_potential(const PotentialProblem& problem) const = 0;

  /// The verb `polyhedron`.
  virtual std::unique_ptr<PreparedPolyhedron> polyhedron(const PolyhedronProblem& problem) const = 0;

  /// The scene as a picture: smooth or flat shading, light from the upper left, the light of sky and ground where the
  /// surroundings let it through, edges with 16 samples a pixel. Every path and any number of threads give the same
  /// picture, bit by bit where the device's division of doubles is IEEE 754's (host/plan/render.hpp). Throws what
  /// check(scene) throws, too_large, device_failed, device_lost, interrupted.
  virtual Image render(const RenderScene& scene, Monitor& monitor) = 0;

  /// Measured multiply-add peak of double precision, in flops per second (a multiply-add counts two).
  virtual double measured_peak() = 0;

  /// What the validation layers said so far; always empty unless GpuOptions::validation.
  virtual std::vector<std::string> validation_messages() const { return {}; }
};

/// The CPU path on `threads` threads (0: all).
std::unique_ptr<Backend> make_cpu_backend(unsigned threads = 0);

/// Options of the Vulkan path.
struct GpuOptions {
  std::string device = "auto"; ///< "auto", an index of list_gpus(), or a part of a device's name
  bool validation = false;     ///< core and synchronisation validation; messages are counted
  // The layout of the kernels; 0 and false leave the choice to the kind of device (shaders/moments.comp).
  std::uint32_t levels = 0;                              ///< degrees a sweep advances; a power of two, 2 to 16
  std::uint32_t workgroups = 0;                          ///< partial sums; a power of two, at most 64
  bool rows_in_buffer = false;                           ///< recursion rows in device memory
  std::uint64_t state_budget = std::uint64_t(512) << 20; ///< bytes of recursion rows kept on the device at once
  std::uint32_t iteration_budget = 60000;                ///< loop iterations one invocation may run in a dispatch
  // The same for transforms (shaders/legendre.h, shaders/ring_fourier.h).
  std::uint32_t transform_steps = 0;   ///< steps k unrolled; 8, 16, ... 64
  std::uint32_t transform_rings = 0;   ///< pairs of rings worked on together; 1, 2, 4 or 8
  std::uint32_t transform_pairs = 0;   ///< pairs of rings a workgroup works on; a multiple of the last, at most 8192
  std::uint64_t transform_binding = 0; ///< bytes a binding spans at most
  std::uint32_t private_ring_points = 4096; ///< longest ring transformed without buffers between the passes
  bool translations = false; ///< those of the fast sum of polyhedra on software devices too, and not on the host
};

/// The Vulkan path. Throws Error(bad_argument, no_loader, no_device, no_fp64, device_failed).
std::unique_ptr<Backend> make_gpu_backend(const GpuOptions& options);

/// The Vulkan devices of this machine, best first: discrete, integrated, virtual, software. Empty where there is no
/// loader or no device; `reason` then says why.
std::vector<DeviceFacts> list_gpus(std::string* reason = nullptr);

} // namespace cowgpu
