#include "host/map/stretch_repeats.hpp"

#include "host/error.hpp"
#include "host/map/laplacian.hpp"
#include "host/parallel.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <random>

namespace cowgpu {
namespace {

struct Copy {
  RawMesh mesh;
  std::vector<std::uint32_t> to; // vertex v became to[v]
  Eigen::Matrix3d rotation;
};

Copy relabelled(const RawMesh& mesh, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
  Copy copy{mesh, std::vector<std::uint32_t>(mesh.vertices.size()),
            Eigen::Quaterniond(w, x, y, z).normalized().matrix()};
  std::iota(copy.to.begin(), copy.to.end(), 0U);
  std::shuffle(copy.to.begin(), copy.to.end(), random);
  for (std::size_t v = 0; v < copy.to.size(); ++v) copy.mesh.vertices[copy.to[v]] = copy.rotation * mesh.vertices[v];
  for (Face& face : copy.mesh.faces) {
    for (std::uint32_t& corner : face) corner = copy.to[corner];
    std::rotate(face.begin(), face.begin() + random() % 3, face.end());
  }
  std::shuffle(copy.mesh.faces.begin(), copy.mesh.faces.end(), random);
  return copy;
}

// Of a copy: it may be asked to stop, and says nothing.
class Quiet final : public Monitor {
public:
  explicit Quiet(const Monitor& outer) : outer_(outer) {}
  bool stopped() const override { return outer_.stopped(); }

private:
  const Monitor& outer_;
};

} // namespace

std::vector<StretchRepeat> repeat_stretch_map(const ManifoldSurface& surface, const SphereMap& map,
                                              const StretchOptions& options, unsigned count, unsigned threads,
                                              Monitor& monitor) {
  const double energy = measure_stretch(surface, map, options.lambda).energy;
  const auto areas = vertex_areas(surface);
  std::vector<StretchRepeat> repeats(count);
  std::atomic<unsigned> done{0};
  parallel_for(threads, count, [&](std::size_t task, unsigned thread) {
    check_stop(monitor);
    if (thread == 0) monitor.progress("mapping relabelled copies", double(done) / count);
    StretchRepeat& repeat = repeats[task];
    repeat.seed = std::uint32_t(task) + 1;
    Copy copy = relabelled(surface.closed().mesh(), repeat.seed);
    const auto other = ManifoldSurface::from(ClosedSurface::from(std::move(copy.mesh)));
    Quiet quiet(monitor);
    const SphereMap again = stretch_map(other, options, quiet);
    repeat.energy = measure_stretch(other, again, options.lambda).energy;
    repeat.reached = std::abs(repeat.energy - energy) <= same_minimum * energy;
    double sum = 0;
    for (std::size_t v = 0; v < copy.to.size(); ++v) {
      const double distance = (copy.rotation.transpose() * again.positions[copy.to[v]] - map.positions[v]).norm();
      repeat.largest = std::max(repeat.largest, distance);
      sum += areas[v] * distance * distance;
    }
    repeat.rms = std::sqrt(sum);
    ++done;
  });
  return repeats;
}

} // namespace cowgpu
