// A process that is suspended while a device works for it.
#include "engine/device.hpp"
#include "engine/gpu.hpp"
#include "engine/kernels/moments.hpp"

#include <catch2/catch.hpp>

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <iostream>
#include <memory>
#include <thread>
#include <vector>

using namespace cowgpu::engine;

namespace {

std::unique_ptr<Gpu> open_gpu() {
  try {
    return std::make_unique<Gpu>("auto");
  } catch (const Error&) {
    return nullptr;
  }
}

constexpr const char* child_test = "child: a device that is given up after three seconds works until input ends";

bool input_ended() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  char byte = 0;
  return poll(&input, 1, 0) > 0 && read(STDIN_FILENO, &byte, 1) <= 0;
}

} // namespace

TEST_CASE(child_test, "[.child]") {
  const auto gpu = open_gpu();
  REQUIRE(gpu);
  Patience patience;
  patience.slices = 30;
  gpu->device().set_patience(patience);
  MomentsShape shape = moments_shape(gpu->facts());
  shape.iteration_budget = 4000; // short batches, on a busy machine too
  constexpr int lmax = 60;
  constexpr std::size_t groups = 4000;
  const std::vector<double> pairs(std::size_t(16) * shape.lanes * groups, 0.25);
  const std::vector<std::uint32_t> last(groups, lmax);
  std::vector<double> first;
  do {
    std::vector<double> sums((lmax + 1) * (lmax + 2));
    moments(gpu->device(), shape, {lmax, 1, 0, pairs, last}, sums, [](double) { return true; });
    if (first.empty()) {
      first = sums;
      std::cout << "at work" << std::endl;
    }
    CHECK(sums == first);
  } while (!input_ended());
}

TEST_CASE("a process that is suspended for longer than a device is waited for goes on where it was",
          "[fault][vulkan]") {
  if (!open_gpu()) {
    std::cout << "SKIPPED: no Vulkan device" << std::endl;
    return;
  }
  int input[2], output[2];
  REQUIRE((pipe(input) == 0 && pipe(output) == 0));
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    dup2(input[0], STDIN_FILENO);
    dup2(output[1], STDOUT_FILENO);
    for (const int end : {input[0], input[1], output[0], output[1]}) close(end);
    execl("/proc/self/exe", "cowgpu_tests", child_test, static_cast<char*>(nullptr));
    _exit(127);
  }
  close(input[0]);
  close(output[1]);
  std::string said;
  for (char byte = 0; said.find("at work") == std::string::npos; said += byte) REQUIRE(read(output[0], &byte, 1) == 1);
  kill(child, SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(3500));
  kill(child, SIGCONT);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  close(input[1]);
  std::string rest(65536, '\0');
  for (ssize_t got = 1; got > 0;) got = read(output[0], rest.data(), rest.size());
  close(output[0]);
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
}
