// The program on devices that hang or are lost while their work runs on (tests/support/faulty_layer.cpp).
#include "host/backend.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/fields.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <iostream>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;

namespace {

// A folder with the layer's manifest alone, as the loader reads every .json there, and one with an old result.
struct FaultyDevice {
  TemporaryFolder layers, folder;
  ProgramOptions options;

  explicit FaultyDevice(const char* how) {
    write_text(layers / "layer.json",
               fmt::format(R"({{"file_format_version": "1.2.0", "layer": {{"name": "VK_LAYER_COWGPU_faulty",
                           "type": "GLOBAL", "library_path": "{}", "api_version": "1.3.0",
                           "implementation_version": "1", "description": "devices that hang or are lost"}}}})",
                           COWGPU_FAULTY_LAYER));
    write_text(folder / "out.json", "old");
    options.environment = {{"VK_LAYER_PATH", layers.path()},
                           {"VK_INSTANCE_LAYERS", "VK_LAYER_COWGPU_faulty"},
                           {"COWGPU_TEST_DEVICE", how}};
  }

  ProgramRun run(std::vector<std::string> words) const {
    words.insert(words.end(), {"-o", folder / "out.json"});
    const ProgramRun ran = run_program(words, options);
    CHECK(read_text(folder / "out.json") == "old");
    return ran;
  }
};

// Batches that go on for a while after the wait for them is given up.
const std::vector<std::vector<std::string>> commands = {
    {"expand", "builtin:sphere@6", "--lmax", "300"},
    {"expand", "builtin:sphere@4", "--lmax", "128", "--of", "harmonic"},
};

} // namespace

TEST_CASE("a device that hangs or is lost ends the program with 4 and a sentence, whatever still runs on it",
          "[fault][vulkan][cli]") {
  if (!gpu_backend()) {
    std::cout << "SKIPPED: no Vulkan device" << std::endl;
    return;
  }
  for (const char* how : {"hangs-at-once", "lost"}) {
    const FaultyDevice device(how);
    for (const auto& command : commands) {
      const ProgramRun run = device.run(command);
      INFO(how << ": " << run.err);
      CHECK(run.exit_code == 4);
      CHECK_THAT(run.err, Contains("[device-lost]") && Contains("--device cpu"));
      CHECK_THAT(run.err, Contains(how[0] == 'h' ? "hangs" : "VK_ERROR_DEVICE_LOST"));
    }
  }
}

TEST_CASE("an interrupt ends the program with 130 while a device hangs", "[fault][vulkan][cli]") {
  if (!gpu_backend()) {
    std::cout << "SKIPPED: no Vulkan device" << std::endl;
    return;
  }
  FaultyDevice device("hangs");
  device.options.interrupt_after = 1.5;
  const ProgramRun run = device.run(commands[0]);
  INFO(run.err);
  CHECK(run.exit_code == 130);
  CHECK_THAT(run.err, Contains("[interrupted]"));
}
