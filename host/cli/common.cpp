#include "host/cli/commands.hpp"

#include "host/error.hpp"
#include "host/mesh/builtin.hpp"

#include <fmt/format.h>

namespace cowgpu::cli {

void add_common_options(CLI::App& command, Common& common) {
  command
      .add_option("--device", common.device,
                  "Where to compute: auto (the best Vulkan device, else the CPU), cpu, a number or a part of a name "
                  "from `cowgpu devices`")
      ->capture_default_str();
  command.add_option("--threads", common.threads, "Threads of the CPU path (0: all)")
      ->check(CLI::Range(0U, 4096U))
      ->capture_default_str();
  command.add_option("--progress", common.progress, "auto (a line on a terminal), none, or jsonl on stderr")
      ->check(CLI::IsMember({"auto", "none", "jsonl"}))
      ->capture_default_str();
  command.add_flag("--quiet,-q", common.quiet, "No talk on stderr");
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

std::string mesh_help() {
  std::string text = "An OFF file, `benchmark` (libigl's cow.off), or a built-in body:";
  for (const auto& body : builtin_bodies()) text += fmt::format(" builtin:{}", body.usage);
  return text;
}

} // namespace cowgpu::cli
