#include "host/cli/commands.hpp"
#include "host/io/document_json.hpp"

#include <fmt/format.h>

namespace cowgpu::cli {
namespace {

struct Options {
  bool json = false;
};

std::string mebibytes(std::uint64_t bytes) {
  return fmt::format("{} MiB", bytes >> 20);
}

void run(const Options& options) {
  std::string reason;
  const std::vector<DeviceFacts> gpus = list_gpus(&reason);
  const DeviceFacts cpu = make_cpu_backend()->facts();
  if (options.json) {
    List list;
    for (std::size_t i = 0; i < gpus.size(); ++i) {
      const DeviceFacts& d = gpus[i];
      list.push_back(Object{{"index", i},
                            {"name", d.name},
                            {"type", d.type},
                            {"driver", d.driver},
                            {"api", d.api},
                            {"usable", d.usable},
                            {"fp64", d.fp64},
                            {"subgroup_size", d.subgroup},
                            {"memory", d.memory},
                            {"largest_buffer", d.largest_buffer},
                            {"shared_memory", d.shared_memory}});
    }
    write_json(
        {{"vulkan", list},
         {"reason", reason},
         {"cpu", Object{{"name", cpu.name}, {"simd", cpu.driver}, {"threads", cpu.threads}, {"memory", cpu.memory}}}},
        write_stdout);
    return;
  }
  for (std::size_t i = 0; i < gpus.size(); ++i) {
    const DeviceFacts& d = gpus[i];
    write_stdout(fmt::format("{}: {}\n", i, d.name));
    write_stdout(fmt::format("   {} device, {}, {}\n", d.type, d.api, d.driver));
    write_stdout(fmt::format(
        "   double precision {}, subgroups of {}, memory {}, buffers to {}, shared memory {} KiB\n",
        d.fp64 ? "yes" : "no", d.subgroup, mebibytes(d.memory), mebibytes(d.largest_buffer), d.shared_memory >> 10));
    if (!d.usable)
      write_stdout("   not usable: cowgpu needs double precision, subgroup shuffles and a compute queue\n");
  }
  if (gpus.empty()) write_stdout(fmt::format("no Vulkan device: {}\n", reason));
  write_stdout(fmt::format("cpu: {}\n   {} thread{}, {}, memory {}\n", cpu.name, cpu.threads,
                           cpu.threads == 1 ? "" : "s", cpu.driver, mebibytes(cpu.memory)));
}

} // namespace

void add_devices(Command& app, Common&) {
  const auto options = std::make_shared<Options>();
  Command* command = app.add_subcommand("devices", "List the Vulkan devices and the CPU, and what each can do");
  command->add_flag("--json", options->json, "As JSON");
  command->callback([options] { run(*options); });
}

} // namespace cowgpu::cli
