#include "host/cli/body_options.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/expansion_words.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/atomic_file.hpp"
#include "host/io/document_json.hpp"
#include "host/report/expansion_file.hpp"
#include "host/requests/expand.hpp"

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

FlowChoice flow_choice(const Options& options, const ExpansionChoice& choice) {
  if (options.flow_options && (choice.maps.empty() || choice.maps.back() != MapMethod::flow))
    throw Error(
        Fault::bad_argument,
        fmt::format(
            "--time, --sheets, --refinements and --flow-grid are about the flow, and --of {} does not ask for it; add "
            "--of flow",
            options.of));
  FlowChoice flow = choice.flow;
  const double time = parse_flow_time(options.time);
  const bool paper = options.recipe == "paper", sheets = options.sheets == "signed";
  if (options.refinements_given && !sheets && !paper)
    throw Error(Fault::bad_argument, "--refinements is about --sheets signed and --recipe paper; level sets take "
                                     "--flow-grid instead");
  if (options.grid_given && (sheets || paper))
    throw Error(Fault::bad_argument, "--flow-grid is about level sets; signed sheets and --recipe paper take "
                                     "--refinements instead");
  if (paper && (time > 0 || sheets))
    throw Error(Fault::bad_argument, "--recipe paper sets the time, 0.2, and how folds are met: leave --time and "
                                     "--sheets out");
  if (!paper) flow.time = time;
  if (sheets) flow.meaning = FlowMeaning::sheets;
  flow.refinements = options.refinements;
  flow.grid_degree = options.flow_grid;
  return flow;
}

Verify parse_verify(const std::string& text) {
  return text == "none" ? Verify::none : text == "full" ? Verify::full : Verify::sample;
}

bool ends_with(const std::string& text, std::string_view end) {
  return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

ExpandRequest request_of(const Options& options) {
  ExpandRequest request;
  request.expansions = parse_expansions(options.of, options.recipe, options.map_file, options.lmax);
  request.expansions.flow = flow_choice(options, request.expansions);
  request.estimate_aliasing = options.aliasing;
  request.cut_off = options.cut_off;
  request.verify = parse_verify(options.verify);
  request.seed = options.seed;
  return request;
}

void write_plan(const ExpandRequest& request, const Body& body, const Backend& backend) {
  const ExpandPlan plan = plan_expand(request, body, backend);
  const ExpansionChoice& choice = request.expansions;
  write_stdout(mesh_line(body.surface.mesh()) + "\n");
  for (const MapMethod map : choice.maps)
    write_stdout(fmt::format("plan: surface over the {} map to degree {}, {} coefficients of each of six fields\n",
                             name(map), choice.lmax, SphereCoefficients::count(choice.lmax)));
  if (choice.mass) {
    write_stdout(fmt::format("plan: mass multipoles to degree {}, {} coefficients, about the point ({:.9g}, {:.9g}, "
                             "{:.9g}) ({}), R = {:.9g}\n",
                             choice.lmax, Multipoles::count(choice.lmax), body.origin.x(), body.origin.y(),
                             body.origin.z(), body.origin_kind, body.brillouin_radius));
    write_stdout(
        fmt::format("work: {} pairs of triangles, {:.3g} of {:.3g} recursion entries after the cut-off {:.0e}\n",
                    plan.pairs, plan.elements, plan.full_elements, request.cut_off));
  }
  write_stdout(fmt::format("device: {}\n", device_line(backend.facts())));
  write_stdout(fmt::format(
      "memory: at most {} MiB on the host and {} MiB on the device, beside the mesh and the program; "
      "JSON of about {} MiB\n",
      (plan.memory.host >> 20) + 1, (plan.memory.device + (1 << 20) - 1) >> 20, (json_bytes(choice) >> 20) + 1));
}

// Opens the files before long work: a result that cannot be written should fail early.
std::vector<std::unique_ptr<AtomicFile>> open_outputs(const Options& options, const ExpansionChoice& choice) {
  for (const std::string& path : options.outputs) check_expansion_file(path, choice.mass, choice.maps.size());
  for (const std::string& path : options.outputs) {
    for (const std::string& input : input_files(options.body)) refuse_mesh_as_output(input, path);
    if (!options.map_file.empty()) refuse_same_file(options.map_file, path);
  }
  std::vector<std::unique_ptr<AtomicFile>> files;
  if (!options.dry_run)
    for (const std::string& path : options.outputs) files.push_back(std::make_unique<AtomicFile>(path));
  return files;
}

void write_result(const Options& options, const Common& common, const ExpandRequest& request,
                  const ExpandResult& result, std::span<const std::unique_ptr<AtomicFile>> files) {
  const std::uint64_t bytes = json_bytes(request.expansions);
  const bool writes_json = options.json || std::any_of(options.outputs.begin(), options.outputs.end(),
                                                       [](const std::string& o) { return ends_with(o, ".json"); });
  if (writes_json && bytes > large_json && !common.quiet)
    say(fmt::format("cowgpu: the JSON will have about {} MB; -o FILE.csv is smaller\n", bytes / 1000000));
  const ConsoleMonitor monitor(ProgressStyle::none);
  for (std::size_t i = 0; i < files.size(); ++i) {
    check_stop(monitor);
    write_expansion(result, coefficient_format(options.outputs[i]), *files[i], monitor);
    files[i]->commit();
    if (!common.quiet) say(fmt::format("cowgpu: wrote {}\n", options.outputs[i]));
  }
  if (options.json)
    write_json(document(result), write_stdout);
  else
    write_screen(result, write_stdout);
  flush_stdout();
}

void run(const Options& options, Common& common) {
  const auto start = Clock::now();
  const ExpandRequest request = request_of(options);
  const auto files = open_outputs(options, request.expansions);
  std::vector<std::string> notes;
  std::string note;
  // While the device opens, which mostly waits for its driver.
  auto opening = std::async(std::launch::async, [&] { return open_backend(common, &note); });
  ConsoleMonitor monitor(common.style());
  Body body = load_body(body_request(options.body), notes, monitor);
  if (!body.parts.empty() && !request.expansions.maps.empty())
    notes.push_back("the surface that is mapped and expanded is MESH's alone: parts have mass only");
  const double load_seconds = seconds_since(start);
  const auto backend = opening.get();
  const double device_seconds = seconds_since(start) - load_seconds;
  if (!note.empty()) {
    if (!common.quiet) say(fmt::format("cowgpu: {}\n", note));
    notes.push_back(note);
  }
  if (options.dry_run) return write_plan(request, body, *backend);
  ExpandResult result = expand(request, std::move(body), *backend, monitor, std::move(notes));
  monitor.clear();
  result.command = common.command;
  result.timings.load = load_seconds;
  result.timings.device = device_seconds;
  result.timings.total = seconds_since(start);
  write_result(options, common, request, result, files);
  require_sound(result);
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
          ->check(in_range(1, most_refinements))
          ->type_name("N")
          ->capture_default_str();
  Option* grid = command
                     ->add_option("--flow-grid", options->flow_grid,
                                  "flow: least degree of the grid on which the level set is met")
                     ->check(in_range(least_flow_grid, largest_grid_degree))
                     ->type_name("N")
                     ->capture_default_str();
  command->add_flag("--aliasing", options->aliasing,
                    "Estimate the aliasing of surface expansions, degree by degree (the paper's recipe always does)");
  command
      ->add_option("--cut-off", options->cut_off,
                   "Leave out, degree by degree, triangles that add up to less than this part of the degree's bound "
                   "(0: none)")
      ->check(in_range(0.0, largest_cut_off))
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
