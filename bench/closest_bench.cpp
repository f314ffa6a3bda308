// Verifies the verb `closest`, then times it against CGAL's and Embree's closest points in the same run. How to read the
// output stands in bench/closest.md.
#include "bench/embree_points.hpp"
#include "bench/report.hpp"
#include "host/backend.hpp"
#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/geometry/morton.hpp"
#include "host/io/mesh_source.hpp"
#include "host/mesh/closed_surface.hpp"
#include "host/parallel.hpp"
#include "host/plan/closest_query.hpp"
#include "host/reference/closest.hpp"
#include "tests/support/cgal_distance.hpp"

#include "bench/command_line.hpp"
#include <Eigen/Geometry>
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <memory>
#include <random>

namespace cowgpu::bench {
namespace {

constexpr std::size_t verified = 2000; // queries held against the reference
constexpr double enlargement = 1.1, deviation = 0.02;

struct Options {
  std::string mesh = "benchmark", instruction_set;
  std::size_t queries = 1000000;
  int runs = 7;
  unsigned threads = 0;
  bool json = false;
};

// One way to find the points: fills distances and returns.
struct Way {
  std::string name, key;
  std::function<void(const std::vector<Vec3>&, std::vector<double>&)> run;
  double tolerance;      // of the diagonal, against ours
  bool in_order = false; // is given sorted queries, sorting not counted
  std::vector<double> wall, processor;
};

class Bench : Report {
public:
  explicit Bench(const Options& options)
      : Report(options.json), options_(options), threads_(options.threads ? options.threads : all_threads()),
        mesh_(load(options.mesh)), backend_(make_cpu_backend(threads_)) {}

  int run() {
    const DeviceFacts& facts = backend_->facts();
    const std::string date = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
    auto start = Clock::now();
    field_ = backend_->distance_field(mesh_.vertices, mesh_.faces);
    const double ours = seconds_since(start);
    open_gpu();
    start = Clock::now();
    cgal_ = std::make_unique<test::CgalTree>(mesh_.vertices, mesh_.faces);
    const double cgal = seconds_since(start);
    start = Clock::now();
    embree_ = std::make_unique<EmbreePoints>(mesh_.vertices, mesh_.faces);
    const double embree = seconds_since(start);
    tree_ = std::make_unique<plan::ClosestTree>(mesh_.vertices, mesh_.faces);
    document_ = {{"benchmark", "closest"},
                 {"date", date},
                 {"mesh", mesh_.name},
                 {"faces", mesh_.faces.size()},
                 {"queries", options_.queries},
                 {"runs", options_.runs},
                 {"device", facts.name},
                 {"driver", facts.driver},
                 {"vulkan_device", gpu_name_},
                 {"threads", threads_},
                 {"build_seconds", {{"ours", ours}, {"cgal_with_side", cgal}, {"embree", embree}}}};
    say("Benchmark of closest points, {}\n{}; {}; {} threads\n{}, {} triangles; trees built in {:.1f} ms (ours), "
        "{:.1f} "
        "(CGAL, with the tree for sides), {:.1f} (Embree)\n",
        date, facts.name, facts.driver, threads_, mesh_.name, mesh_.faces.size(), 1e3 * ours, 1e3 * cgal, 1e3 * embree);
    if (gpu_field_) say("Vulkan device: {}\n", gpu_name_);
    say("{} queries; medians of {} calls; the ways take turns\n", options_.queries, options_.runs);
    compare("uniform", "uniform in the bounding box enlarged by 1.1", uniform());
    compare("near", "on the surface, moved by a Gaussian of 2 % of the diagonal", near());
    return finish();
  }

private:
  // Where there is a Vulkan device it takes part.
  void open_gpu() {
    try {
      const auto backend = make_gpu_backend({});
      gpu_name_ = backend->facts().name;
      gpu_field_ = backend->distance_field(mesh_.vertices, mesh_.faces);
    } catch (const Error& error) {
      say("no Vulkan device: {}\n", error.what());
    }
  }

  static RawMesh load(const std::string& name) { return ClosedSurface::from(load_mesh(name)).mesh(); }

  std::vector<Vec3> uniform() const {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(-0.5, 0.5);
    std::vector<Vec3> queries(options_.queries);
    for (Vec3& q : queries)
      for (int c = 0; c < 3; ++c) q[c] = tree_->centre[c] + enlargement * (tree_->high - tree_->low)[c] * unit(random);
    return queries;
  }

  std::vector<Vec3> near() const {
    std::vector<double> area; // sums
    for (const Face& f : mesh_.faces) {
      const Vec3& a = mesh_.vertices[f[0]];
      area.push_back((area.empty() ? 0 : area.back()) +
                     (mesh_.vertices[f[1]] - a).cross(mesh_.vertices[f[2]] - a).norm());
    }
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> unit(0, 1);
    std::normal_distribution<double> normal(0, deviation * diagonal());
    std::vector<Vec3> queries(options_.queries);
    for (Vec3& q : queries) {
      const auto at = std::upper_bound(area.begin(), area.end() - 1, unit(random) * area.back()) - area.begin();
      const Face& f = mesh_.faces[std::size_t(at)];
      double u = unit(random), v = unit(random);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      q = (1 - u - v) * mesh_.vertices[f[0]] + u * mesh_.vertices[f[1]] + v * mesh_.vertices[f[2]];
      for (int c = 0; c < 3; ++c) q[c] += normal(random);
    }
    return queries;
  }

  double diagonal() const { return (tree_->high - tree_->low).norm(); }

  // One query at a time, `step` its answer's distance; state is one thread's.
  template <class State, class Step>
  void one_by_one(const std::vector<Vec3>& queries, std::vector<double>& distances, const Step& step) const {
    constexpr std::size_t together = 4096;
    parallel_for(threads_, (queries.size() + together - 1) / together, [&](std::size_t task, unsigned) {
      State state{};
      for (std::size_t i = task * together; i < std::min(queries.size(), (task + 1) * together); ++i)
        distances[i] = step(queries[i], state);
    });
  }

  std::vector<Way> ways() {
    const auto field_of = [this](DistanceField& field, bool with_sign) {
      return [this, &field, with_sign](const std::vector<Vec3>& queries, std::vector<double>& distances) {
        Monitor silent;
        distances = field.closest(queries, {with_sign}, silent, &report_).distance;
      };
    };
    const auto field = [&](bool with_sign) { return field_of(*field_, with_sign); };
    struct Warm {
      std::uint32_t face = no_face;
    };
    const auto warm = [this](const std::vector<Vec3>& queries, std::vector<double>& distances) {
      one_by_one<Warm>(queries, distances, [this](const Vec3& q, Warm& last) {
        const auto found = plan::closest_point(*tree_, q, std::numeric_limits<double>::infinity(), last.face);
        last.face = found->face;
        return found->distance;
      });
    };
    const auto cold = [this](const std::vector<Vec3>& queries, std::vector<double>& distances) {
      one_by_one<Warm>(queries, distances,
                       [this](const Vec3& q, Warm&) { return plan::closest_point(*tree_, q)->distance; });
    };
    const auto cgal = [this](const std::vector<Vec3>& queries, std::vector<double>& distances) {
      one_by_one<Warm>(queries, distances, [this](const Vec3& q, Warm&) { return (cgal_->closest(q) - q).norm(); });
    };
    const auto embree = [this](const std::vector<Vec3>& queries, std::vector<double>& distances) {
      one_by_one<Warm>(queries, distances,
                       [this](const Vec3& q, Warm&) { return (embree_->closest(q).point - q).norm(); });
    };
    std::vector<Way> all = {{"ours, unsigned", "unsigned", field(false), 0, false, {}, {}},
                            {"ours, signed", "signed", field(true), 0, false, {}, {}},
                            {"ours, one at a time, from the last, in order", "single_warm", warm, 0, true, {}, {}},
                            {"ours, one at a time", "single_cold", cold, 0, false, {}, {}},
                            {"CGAL AABB tree (double)", "cgal", cgal, 1e-14, false, {}, {}},
                            {"CGAL AABB tree (double), in order", "cgal_in_order", cgal, 1e-14, true, {}, {}},
                            {"Embree point query (float)", "embree", embree, 1e-5, false, {}, {}},
                            {"Embree point query (float), in order", "embree_in_order", embree, 1e-5, true, {}, {}}};
    if (gpu_field_) {
      all.push_back({"ours on Vulkan, unsigned", "vulkan_unsigned", field_of(*gpu_field_, false), 0, false, {}, {}});
      all.push_back({"ours on Vulkan, signed", "vulkan_signed", field_of(*gpu_field_, true), 0, false, {}, {}});
    }
    return all;
  }

  void verify(const std::vector<Vec3>& queries) {
    Monitor silent;
    const ClosestPoints found = field_->closest(queries, {}, silent);
    double distance = 0, point = 0;
    std::size_t signs = 0;
    const std::size_t step = std::max<std::size_t>(1, queries.size() / verified);
    for (std::size_t i = 0; i < queries.size(); i += step) {
      const Vec3& q = queries[i];
      const auto truth = reference::closest<long double>(mesh_.vertices, mesh_.faces, q);
      const long double winding = reference::winding_number<long double>(mesh_.vertices, mesh_.faces, q);
      const double d = double(std::sqrt(truth.distance2));
      distance = std::max(distance, std::abs(std::abs(found.distance[i]) - d));
      point = std::max(point, std::abs((found.point[i] - q).norm() - d));
      signs += found.winding[i] != int(std::lround(winding));
    }
    check("distance against long double, of the diagonal", distance / diagonal(), 1e-15);
    check("distance of the point, of the diagonal", point / diagonal(), 1e-15);
    check("wrong winding numbers", double(signs), 0);
  }

  void compare(const std::string& key, const std::string& title, const std::vector<Vec3>& queries) {
    say("\n{}\n", title);
    verify(queries);
    const auto order = morton_order(queries, tree_->low, tree_->high, threads_);
    std::vector<Vec3> sorted(queries.size());
    for (std::size_t i = 0; i < order.size(); ++i) sorted[i] = queries[order[i]];
    std::vector<Way> all = ways();
    std::vector<double> first, found(queries.size());
    for (Way& way : all) { // warms up
      way.run(way.in_order ? sorted : queries, found);
      if (first.empty()) first = found;
      double apart = 0;
      for (std::size_t i = 0; i < found.size(); ++i)
        apart = std::max(apart, std::abs(std::abs(found[i]) - first[way.in_order ? order[i] : i]));
      check(way.name + ": from ours", apart / diagonal(), way.tolerance);
    }
    for (int run = 0; run < options_.runs; ++run)
      for (Way& way : all) {
        const auto start = Clock::now();
        const std::clock_t before = std::clock();
        way.run(way.in_order ? sorted : queries, found);
        way.wall.push_back(seconds_since(start));
        way.processor.push_back(double(std::clock() - before) / CLOCKS_PER_SEC);
      }
    const auto n = double(queries.size());
    say("  {:<46} {:>12} {:>18} {:>10}\n", "thousand queries a second", "wall clock", "by processor time", "over CGAL");
    for (const Way& way : all) {
      const double rate = n / median(way.wall), by_processor = threads_ * n / median(way.processor);
      const double over = median_ratio(all[4].processor, way.processor);
      say("  {:<46} {:>12.0f} {:>18.0f} {:>10.2f}\n", way.name, rate / 1e3, by_processor / 1e3, over);
      document_["rates"][key][way.key] = {
          {"queries_per_second", rate}, {"by_processor_time", by_processor}, {"over_cgal", over}};
    }
    Monitor silent;
    ClosestReport report;
    (void)field_->closest(queries, {}, silent, &report);
    say("  {:.1f} % of the queries took a ray for their sign; sorting took {:.0f} ms\n", 100 * double(report.rays) / n,
        1e3 * report.sort_seconds);
    document_["rates"][key]["rays"] = report.rays;
  }

  Options options_;
  unsigned threads_;
  RawMesh mesh_;
  std::unique_ptr<Backend> backend_;
  std::unique_ptr<DistanceField> field_, gpu_field_;
  std::string gpu_name_;
  std::unique_ptr<plan::ClosestTree> tree_;
  std::unique_ptr<test::CgalTree> cgal_;
  std::unique_ptr<EmbreePoints> embree_;
  ClosestReport report_;
};

} // namespace
} // namespace cowgpu::bench

int main(int argc, char** argv) {
  using namespace cowgpu;
  bench::Options options;
  cli::CommandLine app("closest_bench", "Verifies and times closest points against CGAL's and Embree's.");
  app.add_option("mesh", options.mesh, "a closed mesh: OFF, benchmark or builtin:...")->capture_default_str();
  app.add_option("--queries", options.queries, "of each kind")->check(cli::positive_number())->capture_default_str();
  app.add_option("--runs", options.runs, "calls of each way")->check(cli::positive_number())->capture_default_str();
  app.add_option("--threads", options.threads, "0: all");
  app.add_option("--instruction-set", options.instruction_set, "the widest to use: AVX3, AVX2, SSE4, SSSE3")
      ->check(cli::one_of({"AVX3", "AVX2", "SSE4", "SSSE3"}));
  app.add_flag("--json", options.json, "a JSON document in place of the text");
  if (const auto end = bench::read_command_line(app, argc, argv)) return *end;
  try {
    bench::use_instruction_set(options.instruction_set);
    return bench::Bench(options).run();
  } catch (const Error& error) {
    fmt::print(stderr, "closest_bench: {}\n", error.what());
    return exit_code(error.fault());
  } catch (const std::exception& error) {
    fmt::print(stderr, "closest_bench: {}\n", error.what());
    return 5;
  }
}
