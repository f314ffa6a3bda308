#include "host/cli/body_options.hpp"
#include "host/cli/coefficient_outputs.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/expansion_words.hpp"
#include "host/requests/expand_flow.hpp"
#include "host/requests/expand_surfaces.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/atomic_file.hpp"
#include "host/plan/moments.hpp"
#include "host/report/json_parts.hpp"
#include "host/report/result.hpp"
#include "host/spectrum/translate.hpp"

#include <fmt/format.h>

#include <future>

namespace cowgpu::cli {
namespace {

struct Options {
  BodyOptions body;
  std::string of = "mass";
  std::string recipe = "default";
  std::string map_file;
  bool aliasing = false;
  std::string time = "auto", sheets = "level-set";
  int refinements = FlowChoice{}.refinements, flow_grid = FlowChoice{}.grid_degree;
  bool flow_options = false, refinements_given = false, grid_given = false;
  int lmax = 8;
  double cut_off = default_cut_off;
  std::string verify = "sample";
  std::uint64_t seed = 1;
  bool json = false;
  bool dry_run = false;
  std::vector<std::string> outputs;
};

constexpr std::uint64_t large_json = std::uint64_t(50) << 20;

class Stopwatch {
public:
  double lap() {
    const double seconds = seconds_since(last_);
    last_ = Clock::now();
    return seconds;
  }
  double total() const { return seconds_since(start_); }

private:
  Clock::time_point start_ = Clock::now(), last_ = start_;
};

FlowChoice flow_choice(const Options& options, const ExpansionChoice& choice) {
  if (options.flow_options && (choice.maps.empty() || choice.maps.back() != MapMethod::flow))
    throw Error(
        Fault::bad_argument,
        fmt::format(
            "--time, --sheets, --refinements and --flow-grid are about the flow, and --of {} does not ask for it; add "
            "--of flow",
            options.of));
  FlowChoice flow;
  flow.time = parse_flow_time(options.time);
  flow.sheets = options.sheets == "signed";
  flow.refinements = options.refinements;
  flow.grid_degree = options.flow_grid;
  if (options.refinements_given && !flow.sheets && !choice.paper)
    throw Error(Fault::bad_argument, "--refinements is about --sheets signed and --recipe paper; level sets take "
                                     "--flow-grid instead");
  if (options.grid_given && (flow.sheets || choice.paper))
    throw Error(Fault::bad_argument, "--flow-grid is about level sets; signed sheets and --recipe paper take "
                                     "--refinements instead");
  if (choice.paper && (flow.time > 0 || flow.sheets))
    throw Error(Fault::bad_argument, "--recipe paper sets the time, 0.2, and how folds are met: leave --time and "
                                     "--sheets out");
  return flow;
}

Verify parse_verify(const std::string& text) {
  return text == "none" ? Verify::none : text == "full" ? Verify::full : Verify::sample;
}

bool ends_with(const std::string& text, std::string_view end) {
  return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

std::uint64_t all_json_bytes(const ExpansionChoice& choice) {
  return (choice.mass ? json_bytes(choice.lmax) : 0) + choice.maps.size() * surface_json_bytes(choice.lmax);
}

// What the run needs at most: the result, and either the computation or its check.
MemoryNeed memory_need(const Options& options, const ExpansionChoice& choice, std::span<const MomentProblem> problems,
                       const Backend& backend) {
  MemoryNeed need = surfaces_memory(choice, problems.front().faces.size(), backend);
  if (!choice.mass) return need;
  const std::uint64_t result = 16 * Multipoles::count(options.lmax);
  if (need.host) need.host += result;
  for (const MomentProblem& problem : problems) { // one after the other, beside the sum of those before
    const MemoryNeed one = backend.moments_memory(problem);
    const std::uint64_t before = &problem == problems.data() ? 0 : result;
    const std::uint64_t check = result + one.host + verify_bytes(problem, parse_verify(options.verify));
    need.host = std::max({need.host, one.host + before, check});
    need.device = std::max(need.device, one.device);
  }
  return need;
}

void write_mass_plan(const Options& options, const Body& body, std::span<const MomentProblem> problems,
                     const Backend& backend) {
  std::uint64_t pairs = 0;
  double elements = 0, full = 0;
  for (const MomentProblem& problem : problems) {
    const plan::Moments plan = plan::moments(problem, int(backend.facts().subgroup));
    pairs += plan.pair_count;
    elements += plan.elements;
    full += plan.full_elements;
  }
  write_stdout(
      fmt::format("plan: mass multipoles to degree {}, {} coefficients, about the point ({:.9g}, {:.9g}, {:.9g}) "
                  "({}), R = {:.9g}\n",
                  options.lmax, Multipoles::count(options.lmax), body.origin.x(), body.origin.y(), body.origin.z(),
                  body.origin_kind, body.brillouin_radius));
  write_stdout(fmt::format("work: {} pairs of triangles, {:.3g} of {:.3g} recursion entries after the cut-off {:.0e}\n",
                           pairs, elements, full, options.cut_off));
}

void write_plan(const Options& options, const ExpansionChoice& choice, const Body& body,
                std::span<const MomentProblem> problems, const Backend& backend) {
  const MemoryNeed need = memory_need(options, choice, problems, backend);
  write_stdout(mesh_line(body.surface.mesh()) + "\n");
  for (const MapMethod map : choice.maps)
    write_stdout(fmt::format("plan: surface over the {} map to degree {}, {} coefficients of each of six fields\n",
                             name(map), options.lmax, SphereCoefficients::count(options.lmax)));
  if (choice.mass) write_mass_plan(options, body, problems, backend);
  write_stdout(fmt::format("device: {}\n", device_line(backend.facts())));
  write_stdout(
      fmt::format("memory: at most {} MiB on the host and {} MiB on the device, beside the mesh and the program; "
                  "JSON of about {} MiB\n",
                  (need.host >> 20) + 1, (need.device + (1 << 20) - 1) >> 20, (all_json_bytes(choice) >> 20) + 1));
}

ExpandResult compute(const Options& options, const ExpansionChoice& choice, const Common& common, Body body,
                     std::unique_ptr<Backend> backend, std::vector<std::string> notes, Timings timings,
                     Stopwatch& watch) {
  ConsoleMonitor monitor(common.style());
  const std::vector<MomentProblem> problems = mass_problems(body, options.lmax, options.cut_off);
  RunReport run;
  Multipoles mass;
  Accuracy accuracy;
  accuracy.how = Verify::none;
  // First, because maps are what may not be possible.
  std::vector<SurfaceResult> surfaces = expand_surfaces(choice, options.aliasing, body, *backend, monitor);
  timings.surfaces = watch.lap();
  if (choice.mass) {
    std::vector<std::vector<double>> norms;
    mass = mass_moments(problems, *backend, monitor, &run, &norms);
    for (const MomentProblem& problem : problems)
      if (near_problem(problem)) {
        notes.push_back(
            "the origin is more than 16 radii away from the body or a part of it, whose moments are computed "
            "about the middle of its box and moved to the origin");
        break;
      }
    timings.moments = watch.lap();
    accuracy = verify_all(problems, mass, norms, *backend, parse_verify(options.verify), options.seed, monitor);
    if (accuracy.how != Verify::none)
      accuracy.agreements.push_back(compare_with_tensors(body, mass, accuracy.estimate.error));
    timings.verify = watch.lap();
  }
  const Tensors second = tensors(body);
  timings.total = watch.total();
  ExpandResult result{common.command,   utc_now(),   std::move(body),    backend->facts(), options.cut_off,
                      std::move(mass),  second,      std::move(run),     timings,          std::move(accuracy),
                      std::move(notes), choice.mass, std::move(surfaces)};
  return result;
}

void run(const Options& options, Common& common) {
  Stopwatch watch;
  ExpansionChoice choice = parse_expansions(options.of, options.recipe, options.map_file, options.lmax);
  for (const std::string& path : options.outputs) check_expansion_output(path, choice.mass, choice.maps.size());
  choice.flow = flow_choice(options, choice);
  // Before long work: a result that cannot be written should fail now.
  std::vector<std::unique_ptr<AtomicFile>> files;
  for (const std::string& path : options.outputs) {
    for (const std::string& input : input_files(options.body)) refuse_mesh_as_output(input, path);
    if (!options.map_file.empty()) refuse_same_file(options.map_file, path);
  }
  if (!options.dry_run)
    for (const std::string& path : options.outputs) files.push_back(std::make_unique<AtomicFile>(path));

  std::vector<std::string> notes;
  std::string note;
  // While the device opens, which mostly waits for its driver.
  auto opening = std::async(std::launch::async, [&] { return open_backend(common, &note); });
  Body body = load_body(options.body, notes);
  if (!body.parts.empty() && !choice.maps.empty())
    notes.push_back("the surface that is mapped and expanded is MESH's alone: parts have mass only");
  Timings timings;
  timings.load = watch.lap();
  auto backend = opening.get();
  timings.device = watch.lap();
  if (!note.empty()) {
    if (!common.quiet) say(fmt::format("cowgpu: {}\n", note));
    notes.push_back(note);
  }
  const std::vector<MomentProblem> problems = mass_problems(body, options.lmax, options.cut_off);
  check_memory(memory_need(options, choice, problems, *backend), *backend,
               "lower --lmax or take a mesh with fewer triangles");
  if (options.dry_run) {
    write_plan(options, choice, body, problems, *backend);
    return;
  }
  const ExpandResult result =
      compute(options, choice, common, std::move(body), std::move(backend), std::move(notes), timings, watch);

  const bool writes_json = options.json || std::any_of(options.outputs.begin(), options.outputs.end(),
                                                       [](const std::string& o) { return ends_with(o, ".json"); });
  if (writes_json && all_json_bytes(choice) > large_json && !common.quiet)
    say(fmt::format("cowgpu: the JSON will have about {} MB; -o FILE.csv is smaller\n",
                    all_json_bytes(choice) / 1000000));
  for (std::size_t i = 0; i < files.size(); ++i) {
    check_stop(ConsoleMonitor(ProgressStyle::none));
    write_expansion(result, coefficient_format(options.outputs[i]), *files[i]);
    files[i]->commit();
    if (!common.quiet) say(fmt::format("cowgpu: wrote {}\n", options.outputs[i]));
  }
  if (options.json)
    write_json(result, write_stdout);
  else
    write_screen(result, write_stdout);
  flush_stdout();
  check_surfaces(result.surfaces);
  if (result.accuracy.how != Verify::none && !result.accuracy.passed()) {
    flush_stdout();
    const Agreement& worst = *result.accuracy.worst();
    throw Error(
        Fault::check_failed,
        fmt::format(
            "{} against {} is off by {:.1e} times what rounding explains (degree {}; {:.0f} are allowed): do not "
            "trust these numbers; try --device cpu and `cowgpu validate`",
            worst.path, worst.against, worst.errors.ratio, worst.errors.degree, Accuracy::bound));
  }
}

} // namespace

void add_expand(Command& app, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command =
      app.add_subcommand("expand", "Multipole moments of a closed mesh, and its surface over maps to the sphere");
  add_body_options(*command, options->body);
  command->add_option("--lmax", options->lmax, "Largest degree, 0 to 4096")
      ->check(in_range(0, largest_degree))
      ->capture_default_str();
  command
      ->add_option(
          "--of", options->of,
          "What to expand, separated by commas: mass, and the surface over the maps harmonic, stretch, smooth and "
          "the distance's flow; or all")
      ->capture_default_str();
  command
      ->add_option("--recipe", options->recipe,
                   "Settings of the harmonic map and the flow: default, or paper (as Higher multipoles of the cow has "
                   "them, about the mesh's origin)")
      ->check(one_of({"default", "paper"}))
      ->capture_default_str();
  command
      ->add_option(
          "--map", options->map_file,
          "Take the map of --of from FILE.ply, which `cowgpu map MESH -o FILE.ply` wrote, instead of making it")
      ->check([](const std::string& path) { return std::string(path.empty() ? "the name is empty" : ""); })
      ->type_name("FILE");
  Option* time = command
                     ->add_option("--time", options->time,
                                  "flow: T, how far the body is inflated, in the body's length unit; auto: the least "
                                  "for which it is star-shaped about the origin")
                     ->type_name("auto|T")
                     ->capture_default_str();
  Option* sheets =
      command
          ->add_option("--sheets", options->sheets,
                       "flow: level-set (from a direction back to the surface), or signed (all sheets of the flowed "
                       "surface over it, each with its sign: any T, extrapolated over refinements of the mesh)")
          ->check(one_of({"level-set", "signed"}))
          ->capture_default_str();
  Option* refinements =
      command
          ->add_option(
              "--refinements", options->refinements,
              "flow: of the mesh, for signed sheets and the paper's recipe; each takes four times as long. On the "
              "benchmark at T = 0.2 coefficients to degree 8 are then known to 4e-3 from 3, to 1e-3 from 4")
          ->check(in_range(1, 5))
          ->type_name("N")
          ->capture_default_str();
  Option* grid = command
                     ->add_option("--flow-grid", options->flow_grid,
                                  "flow: least degree of the grid on which the level set is met")
                     ->check(in_range(64, largest_grid_degree))
                     ->type_name("N")
                     ->capture_default_str();
  command->add_flag("--aliasing", options->aliasing,
                    "Estimate the aliasing of surface expansions, degree by degree (the paper's recipe always does)");
  command
      ->add_option("--cut-off", options->cut_off,
                   "Leave out, degree by degree, triangles that add up to less than this part of the degree's bound "
                   "(0: none)")
      ->check(in_range(0.0, 1e-3))
      ->capture_default_str();
  command
      ->add_option(
          "--verify", options->verify,
          "Compute again by a second recursion, and estimate the error of each degree: sample (128 triangles), full "
          "(all), none")
      ->check(one_of({"sample", "full", "none"}))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed of the sample")->capture_default_str();
  command->add_flag("--json", options->json, "The result as JSON on stdout (data/schemas/cowgpu.result.v1.json)");
  command
      ->add_option(
          "-o,--output", options->outputs,
          "Write FILE.json or FILE.csv (all of it), or one expansion as FILE.gfc (ICGEM), FILE.sh (SHTOOLS) or "
          "FILE.nc (netCDF); can be repeated")
      ->type_name("FILE")
      ->allow_extra_args(false);
  command->add_flag("--dry-run", options->dry_run, "Print the plan and the memory it needs, and stop");
  add_common_options(*command, common);
  command->callback([options, &common, time, sheets, refinements, grid] {
    options->flow_options = time->count() + sheets->count() + refinements->count() + grid->count() > 0;
    options->refinements_given = refinements->count() > 0;
    options->grid_given = grid->count() > 0;
    run(*options, common);
  });
}

} // namespace cowgpu::cli
