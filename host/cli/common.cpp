#include "host/cli/commands.hpp"

#include "host/error.hpp"
#include "host/io/mesh_source.hpp"
#include "host/io/shown.hpp"
#include "host/number.hpp"
#include "host/requests/meshes.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace cowgpu::cli {
void add_common_options(Command& command, Common& common) {
  command
      .add_option("--device", common.device,
                  "Where to compute: auto (the best Vulkan device, else the CPU), cpu, a number or a part of a name "
                  "from `cowgpu devices`")
      ->capture_default_str();
  add_run_options(command, common);
}

void add_run_options(Command& command, Common& common) {
  command.add_option("--threads", common.threads, "Threads of the CPU path (0: all)")
      ->check(in_range(0U, most_threads))
      ->capture_default_str();
  command.add_option("--progress", common.progress, "auto (a line on a terminal), none, or jsonl on stderr")
      ->check(one_of({"auto", "none", "jsonl"}))
      ->capture_default_str();
  command.add_flag("--quiet,-q", common.quiet, "Print errors only");
}

std::unique_ptr<Backend> open_backend(const Common& common, std::string* note) {
  if (common.device == "cpu") return make_cpu_backend(common.threads);
  GpuOptions options;
  options.device = common.device;
  if (common.device != "auto") return make_gpu_backend(options);
  try {
    return make_gpu_backend(options);
  } catch (const Error& error) {
    const bool nothing_there =
        error.fault() == Fault::no_loader || error.fault() == Fault::no_device || error.fault() == Fault::no_fp64;
    if (!nothing_there) throw;
    if (note) *note = fmt::format("the CPU path is used, because {}", error.what());
    return make_cpu_backend(common.threads);
  }
}

void add_grid_option(Command& command, std::string& grid, const char* what) {
  command.add_option("--grid", grid, what)->check(one_of({"gl", "cc", "dh", "dh1", "f1"}))->type_name("KIND");
}

void add_degree_option(Command& command, int& lmax, const char* what) {
  command.add_option("--lmax", lmax, what)->check(in_range(0, largest_grid_degree))->type_name("L");
}

void refuse_same_file(const std::string& input, const std::string& output) {
  std::error_code none;
  if (std::filesystem::equivalent(input, output, none))
    throw Error(Fault::bad_argument,
                fmt::format("{} is input and output at once; give the output another name", output));
}

void refuse_mesh_as_output(const std::string& mesh, const std::string& output) {
  if (const auto file = mesh_file(mesh)) refuse_same_file(*file, output);
}

std::optional<Vec3> parse_point(std::string_view text) {
  const auto numbers = read_numbers<3>(text);
  if (!numbers) return std::nullopt;
  return Vec3((*numbers)[0], (*numbers)[1], (*numbers)[2]);
}

OriginChoice parse_origin(const std::string& text) {
  if (text == "com") return {};
  if (text == "mesh") return {"mesh", Vec3::Zero()};
  if (const auto point = parse_point(text)) return {"given", *point};
  throw Error(Fault::bad_argument,
              fmt::format("--origin {}: it must be com, mesh or three numbers X,Y,Z in mesh coordinates", text));
}

void add_convention_options(Command& command, std::string& normalisation, std::string& phase, const char* of_what) {
  command
      .add_option(
          "--normalisation", normalisation,
          fmt::format("Normalisation {}: orthonormal, 4pi (geodesy), schmidt, unnormalised (to about degree 150)",
                      of_what))
      ->check(one_of({"orthonormal", "4pi", "schmidt", "unnormalised"}));
  command.add_option("--phase", phase, fmt::format("Phase {}: cs (Condon-Shortley) or none", of_what))
      ->check(one_of({"cs", "none"}));
}

std::string mesh_help() {
  std::string text = "A file (";
  for (const std::string& format : mesh_format_names()) text += format + ", ";
  text +=
      "recognised by its content; - is standard input), a name that `cowgpu meshes` lists, such as benchmark (a file "
      "called so is ./benchmark), or a built-in body:";
  for (const std::string& usage : builtin_usages()) text += " " + usage;
  return text;
}

} // namespace cowgpu::cli
