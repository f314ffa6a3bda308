#include "bench/polyhedron_crossover.hpp"

#include "bench/report.hpp"
#include "host/backend.hpp"
#include "host/cpu/polyhedron_fast.hpp"
#include "host/mesh/builtin.hpp"
#include "host/plan/polyhedron.hpp"
#include "host/plan/polyhedron_pairs.hpp"
#include "host/plan/polyhedron_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

namespace cowgpu::bench {
namespace {

constexpr double most_work = 3e8; // faces times points of a direct sum

double core_seconds(const PreparedPolyhedron& prepared, const std::vector<Vec3>& points, RunReport* report = nullptr) {
  const double before = processor_seconds();
  prepared.at(points, silent_monitor(), report);
  return processor_seconds() - before;
}

// Spread over the surface.
std::vector<Vec3> some_centroids(const RawMesh& mesh, std::size_t count) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const Face& f = mesh.faces[i * 7919 % mesh.faces.size()];
    const double a = 1. / 3 + 0.1 * std::sin(double(i)), b = 1. / 3 + 0.1 * std::cos(double(i));
    points.push_back(a * mesh.vertices[f[0]] + b * mesh.vertices[f[1]] + (1 - a - b) * mesh.vertices[f[2]]);
  }
  return points;
}

// The most bytes that a worker's lists of pairs hold, as find_pairs() leaves them.
double list_bytes(const PolyhedronProblem& problem, const plan::PolyhedronSources& sources,
                  const std::vector<Vec3>& points) {
  const plan::FastSettings settings = plan::fast_settings(problem);
  const double unit = plan::polyhedron_unit(problem.vertices);
  const plan::PlaceTree targets(
      points.size(), [&](std::size_t i) { return Vec3(points[i] / unit); }, plan::largest_tree_leaf, 1);
  std::vector<Vec3> sorted;
  for (const std::uint32_t i : targets.order) sorted.push_back(points[i] / unit);
  const double volume = std::abs(sources.volume()), radius = std::cbrt(0.75 * std::numbers::inv_pi * volume);
  const plan::PairTolerance tolerance{settings.tau * volume / (radius * radius), radius, plan::largest_tree_leaf};
  plan::TaskPairs pairs;
  for (const std::uint32_t task : plan::point_tasks(targets, plan::task_points))
    plan::find_pairs(sources, targets, sorted, task, tolerance, pairs);
  std::size_t held = pairs.at_points.capacity() + pairs.near.capacity();
  for (const auto& of_order : pairs.to_locals) held += of_order.capacity();
  return double(held * sizeof(plan::CellPair) + pairs.bound.capacity() * sizeof(double));
}

} // namespace

int polyhedron_crossover(const CrossoverOptions& options) {
  fmt::print("{:<14} {:>8} {:>8} {:>7} {:>10} {:>10} {:>7} {:>6} {:>9} {:>9}\n", "body", "faces", "points", "within",
             "direct s", "fast s", "ratio", "taken", "a face", "a point");
  int wrong = 0;
  for (const char* body : {"sphere:1@2", "cow@0", "sphere:1@3", "cow@1", "sphere:1@4", "cow@2", "cow@3"}) {
    const RawMesh mesh = builtin_mesh(body);
    for (const std::size_t points : {16, 64, 256, 1024, 2048, 4096, 16384}) {
      if (double(points) * double(mesh.faces.size()) > most_work) continue;
      const std::vector<Vec3> places = some_centroids(mesh, points);
      PolyhedronProblem problem;
      problem.vertices = mesh.vertices;
      problem.faces = mesh.faces;
      problem.derivatives = options.tensor ? Derivatives::second : Derivatives::first;
      std::vector<double> direct;
      for (int run = 0; run < options.runs; ++run)
        direct.push_back(core_seconds(*make_cpu_backend(options.threads)->polyhedron(problem), places));
      const double face_point = median(direct) / double(points) / double(mesh.faces.size());
      problem.guarantee = options.guarantee;
      for (const double tolerance : {1e-6, 1e-9, 1e-12}) {
        problem.tolerance = tolerance;
        // The second call finds what does not depend on points.
        std::vector<double> fast, again;
        for (int run = 0; run < options.runs; ++run) {
          const auto prepared = cpu::fast_polyhedron(problem, options.threads);
          fast.push_back(core_seconds(*prepared, places));
          again.push_back(core_seconds(*prepared, places));
        }
        const double of_faces = std::max(0.0, median(fast) - median(again)), ratio = median(fast) / median(direct);
        const bool taken = plan::fast_sum_pays(problem, points);
        const bool far_off = taken ? ratio > 1.25 : ratio < 0.8;
        wrong += far_off;
        fmt::print("{:<14} {:>8} {:>8} {:>7.0e} {:>10.5f} {:>10.5f} {:>7.2f} {:>6} {:>9.0f} {:>9.0f}{}\n", body,
                   mesh.faces.size(), points, tolerance, median(direct), median(fast), ratio, taken ? "fast" : "direct",
                   of_faces / double(mesh.faces.size()) / face_point, median(again) / double(points) / face_point,
                   far_off ? "  *" : "");
        std::fflush(stdout);
      }
    }
  }
  fmt::print(
      "Seconds of cores, with set-up. a face, a point: what the fast sum takes for each, in times of one face at one\n"
      "point in the direct sum. *: the one that is not taken is a fifth faster; {} times.\n",
      wrong);
  return 0;
}

int polyhedron_lists(const RawMesh& mesh, bool guarantee) {
  PolyhedronProblem problem;
  problem.vertices = mesh.vertices;
  problem.faces = mesh.faces;
  problem.guarantee = guarantee;
  fmt::print("{:>8} {:>9} {:>9} {:>12} {:>14}\n", "within", "faces", "points", "bytes", "a task's point");
  for (const double tolerance : {1e-6, 1e-9, 1e-12}) {
    problem.tolerance = tolerance;
    const plan::Translations translations(plan::fast_settings(problem).order);
    const plan::PolyhedronSources sources(problem.vertices, problem.faces, plan::polyhedron_unit(problem.vertices),
                                          plan::largest_tree_leaf, translations, 1, silent_monitor());
    for (std::size_t points : {std::size_t(16), std::size_t(256), std::size_t(2048), std::size_t(8192),
                               std::size_t(65536), mesh.faces.size()}) {
      if (points > mesh.faces.size()) continue;
      const double bytes = list_bytes(problem, sources, some_centroids(mesh, points));
      fmt::print("{:>8.0e} {:>9} {:>9} {:>12.0f} {:>14.0f}\n", tolerance, mesh.faces.size(), points, bytes,
                 bytes / double(std::min<std::size_t>(points, plan::task_points)));
      std::fflush(stdout);
    }
  }
  return 0;
}

} // namespace cowgpu::bench
