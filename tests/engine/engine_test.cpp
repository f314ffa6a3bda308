// The engine: devices, buffers, the limit of loops, and that validation is really on.
#include "engine/buffer.hpp"
#include "engine/device.hpp"
#include "engine/gpu.hpp"
#include "engine/job.hpp"
#include "engine/kernels/loop_limit.hpp"
#include "engine/kernels/moments.hpp"
#include "engine/kernels/peak.hpp"
#include "host/backend.hpp"
#include "tests/support/compare_moments.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstring>
#include <random>

using namespace cowgpu;
using namespace cowgpu::engine;

namespace {

/// The first device, validated, or null.
std::unique_ptr<Gpu> open_gpu() {
  try {
    return std::make_unique<Gpu>("auto", true);
  } catch (const engine::Error& error) {
    if (error.failure() == Failure::vulkan) throw;
    return {};
  }
}

/// A device that no machine has.
PhysicalDevice made_up(const std::string& name, bool fp64 = true) {
  PhysicalDevice device;
  std::snprintf(device.properties.deviceName, sizeof device.properties.deviceName, "%s", name.c_str());
  device.fp64 = fp64;
  device.subgroup_arithmetic = true;
  device.queue_family = 0;
  return device;
}

struct Caught {
  bool thrown = false;
  Failure failure = Failure::stopped;
  std::string text;
  bool says(const std::string& words) const { return text.find(words) != std::string::npos; }
};

template <class Work>
Caught caught(const Work& work) {
  try {
    work();
  } catch (const engine::Error& error) {
    return {true, error.failure(), error.what()};
  }
  return {};
}

std::vector<std::byte> random_bytes(std::size_t count) {
  std::mt19937 random(1);
  std::vector<std::byte> bytes(count);
  for (std::byte& b : bytes) b = std::byte(random() & 255U);
  return bytes;
}

/// Whole and partial writes and reads, and clearing. Brackets keep Catch from writing megabytes out.
void check_round_trip(Device& device, std::size_t size) {
  Buffer buffer(device, size, "a test");
  CHECK(buffer.size() >= size);
  CHECK(buffer.size() % 16 == 0);
  std::vector<std::byte> expected = random_bytes(size), found(size);
  buffer.write(expected);
  buffer.read(found);
  CHECK((found == expected));
  for (const std::size_t offset : {std::size_t(0), std::size_t(4), size / 3 / 4 * 4, size - 8}) {
    const auto part = random_bytes(std::min<std::size_t>(size - offset, 4000));
    buffer.write(part, offset);
    std::copy(part.begin(), part.end(), expected.begin() + std::ptrdiff_t(offset));
    std::vector<std::byte> back(part.size());
    buffer.read(back, offset);
    CHECK((back == part));
  }
  buffer.write({});
  buffer.read(found);
  CHECK((found == expected));
  buffer.clear();
  buffer.read(found);
  CHECK((found == std::vector<std::byte>(size)));
}

} // namespace

TEST_CASE("a loop runs as often as the iteration budget asks for", "[engine]") {
  const auto gpu = open_gpu();
  if (!gpu) return test::skip_without_gpu();
  CHECK(loop_iterations(gpu->device(), 60000) == 60000);
  // llvmpipe of Mesa 22.3.6 runs 65535 of these, and says nothing.
  const std::uint32_t ran = loop_iterations(gpu->device(), 70000);
  INFO(ran);
  CHECK((ran == 70000 || ran == 65535));
  CHECK(MomentsShape{}.iteration_budget < ran);
  CHECK(GpuOptions{}.iteration_budget < ran);
  CHECK(gpu->validation_messages().empty());
}

TEST_CASE("a device is chosen by index, by a part of its name, or as the first that can compute", "[engine]") {
  const std::vector<PhysicalDevice> devices = {made_up("Small Card", false), made_up("Big Card 9000"),
                                               made_up("llvmpipe")};
  CHECK(&choose_device(devices, "auto") == &devices[1]);
  CHECK(&choose_device(devices, "1") == &devices[1]);
  CHECK(&choose_device(devices, "2") == &devices[2]);
  CHECK(&choose_device(devices, "big") == &devices[1]);
  CHECK(&choose_device(devices, "LLVM") == &devices[2]);
  CHECK(&choose_device(devices, "card 9") == &devices[1]);
}

TEST_CASE("an unknown device is an error that lists those there are", "[engine]") {
  const std::vector<PhysicalDevice> devices = {made_up("Small Card", false), made_up("Big Card 9000")};
  for (const char* wanted : {"2", "99999999999999999999999", "-1", "", "other", "9000x"}) {
    const Caught error = caught([&] { choose_device(devices, wanted); });
    INFO(wanted);
    CHECK(error.thrown);
    CHECK(error.failure == Failure::no_device);
    CHECK(error.says("0: Small Card"));
    CHECK(error.says("1: Big Card 9000"));
  }
  const Caught weak = caught([&] { choose_device(devices, "0"); });
  CHECK((weak.thrown && weak.failure == Failure::no_fp64 && weak.says("Small Card")));
  const Caught only_weak = caught([&] { choose_device({devices[0]}, "auto"); });
  CHECK((only_weak.thrown && only_weak.failure == Failure::no_fp64));
  const Caught nothing = caught([&] { choose_device({}, "auto"); });
  CHECK((nothing.thrown && nothing.failure == Failure::no_device));
}

TEST_CASE("every device of this machine can be opened by its index and by its name", "[engine]") {
  if (!open_gpu()) return test::skip_without_gpu();
  const auto list = engine::list_gpus();
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!list[i].usable) continue;
    CHECK(Gpu(std::to_string(i)).facts().name == list[i].name);
    CHECK(Gpu(list[i].name).facts().name == list[i].name);
    CHECK(list[i].subgroup_size >= 1);
    CHECK(list[i].memory > 0);
    CHECK(list[i].largest_range >= std::uint64_t(1) << 27);
    CHECK_FALSE(list[i].driver.empty());
  }
  const Caught error = caught([] { Gpu("no such device"); });
  CHECK((error.thrown && error.failure == Failure::no_device && error.says(list[0].name)));
}

TEST_CASE("devices with and without validation live side by side", "[engine]") {
  auto validated = open_gpu();
  if (!validated) return test::skip_without_gpu();
  auto plain = std::make_unique<Gpu>("auto", false);
  check_round_trip(validated->device(), 1000);
  check_round_trip(plain->device(), 1000);
  CHECK_FALSE(engine::list_gpus().empty());
  CHECK(loop_iterations(validated->device(), 100) == 100);
  plain.reset();
  CHECK(loop_iterations(validated->device(), 100) == 100);
  CHECK(validated->validation_messages().empty());
  plain = std::make_unique<Gpu>("auto", false);
  validated.reset();
  CHECK(loop_iterations(plain->device(), 100) == 100);
}

TEST_CASE("buffers give back what was written", "[engine]") {
  const auto gpu = open_gpu();
  if (!gpu) return test::skip_without_gpu();
  for (const std::size_t size : {8U, 16U, 20U, 4096U, 100000U}) check_round_trip(gpu->device(), size);
  CHECK(gpu->validation_messages().empty());
}

TEST_CASE("buffers that are not mapped are staged, in parts where they are large", "[engine]") {
  if (!open_gpu()) return test::skip_without_gpu();
  const auto instance = Instance::create(true);
  const auto devices = instance->devices();
  PhysicalDevice physical = choose_device(devices, "auto");
  // Memory that is not cached for the host does not count as shared with it.
  for (std::uint32_t t = 0; t < physical.memory.memoryTypeCount; ++t)
    physical.memory.memoryTypes[t].propertyFlags &= ~VkMemoryPropertyFlags(VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
  {
    Device device(instance, physical);
    for (const std::size_t size : {8U, 100000U, (16U << 20) + 4U, 40U << 20}) check_round_trip(device, size);
  }
  CHECK(instance->log().messages == std::vector<std::string>{});
}

TEST_CASE("a buffer beyond the largest allocation is refused before it is tried", "[engine]") {
  if (!open_gpu()) return test::skip_without_gpu();
  const auto instance = Instance::create(true);
  const auto devices = instance->devices();
  PhysicalDevice physical = choose_device(devices, "auto");
  REQUIRE(physical.largest_allocation > 0);
  {
    Device device(instance, physical);
    const Caught error = caught([&] { Buffer(device, device.physical().largest_allocation + 1, "too much"); });
    CHECK((error.thrown && error.failure == Failure::out_of_range && error.says("too much") &&
           error.says(device.name())));
  }
  physical.largest_allocation = 1 << 20;
  {
    Device device(instance, physical);
    CHECK_FALSE(caught([&] { Buffer(device, 1 << 20, "just enough"); }).thrown);
    CHECK(caught([&] { Buffer(device, (1 << 20) + 1, "too much"); }).failure == Failure::out_of_range);
  }
  CHECK(instance->log().messages == std::vector<std::string>{});
}

TEST_CASE("wrong arguments to a kernel are errors, not undefined behaviour", "[engine]") {
  const auto gpu = open_gpu();
  if (!gpu) return test::skip_without_gpu();
  Device& device = gpu->device();
  const MomentsShape shape = moments_shape(gpu->facts());
  std::vector<double> sums(6);
  const std::vector<double> pairs(std::size_t(16) * shape.lanes * 2);
  const std::vector<std::uint32_t> last = {1};
  MomentsShape wrong = shape;
  wrong.lanes = shape.lanes * 2;
  CHECK(caught([&] {
          engine::moments(device, wrong, {1, 1, 0, pairs, last}, sums, [](double) { return true; });
        }).failure == Failure::out_of_range);
  const Caught stopped = caught([&] {
    engine::moments(device, shape, {1, 1, 0, pairs, last}, sums, [](double) { return false; });
  });
  CHECK((stopped.thrown && stopped.failure == Failure::stopped));
  CHECK_FALSE(caught([&] {
                engine::moments(device, shape, {1, 1, 0, pairs, last}, sums, [](double) { return true; });
              }).thrown);
  CHECK(gpu->validation_messages().empty());
}

TEST_CASE("the measured peak is positive and profiled", "[engine]") {
  const auto gpu = open_gpu();
  if (!gpu) return test::skip_without_gpu();
  CHECK(peak(gpu->device()) > 1e8);
  const auto profile = gpu->take_profile();
  REQUIRE(profile.size() == 1);
  CHECK(profile[0].kernel == "peak");
  CHECK(profile[0].dispatches == 8);
  CHECK(profile[0].seconds > 0);
  CHECK(gpu->take_profile().empty());
  CHECK(make_cpu_backend()->measured_peak() > 1e8);
  CHECK(gpu->validation_messages().empty());
}

TEST_CASE("validation hears of a wrong call and of a missing barrier", "[engine]") {
  if (!open_gpu()) return test::skip_without_gpu();
  const auto instance = Instance::create(true);
  const auto devices = instance->devices();
  Device device(instance, choose_device(devices, "auto"));
  const auto said = [&](const std::string& words) {
    const auto& messages = instance->log().messages;
    return std::any_of(messages.begin(), messages.end(),
                       [&](const std::string& m) { return m.find(words) != std::string::npos; });
  };
  REQUIRE(instance->log().messages.empty());

  VkBufferCreateInfo nothing{};
  nothing.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  nothing.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  VkBuffer handle = VK_NULL_HANDLE; // of size 0
  if (vkCreateBuffer(device.handle(), &nothing, nullptr, &handle) == VK_SUCCESS)
    vkDestroyBuffer(device.handle(), handle, nullptr);
  CHECK(said("VUID-VkBufferCreateInfo-size-00912"));
  CHECK_FALSE(said("SYNC-HAZARD"));

  Buffer buffer(device, 256, "a test");
  VkCommandBufferAllocateInfo allocate{};
  allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
  allocate.commandPool = device.command_pool();
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  REQUIRE(vkAllocateCommandBuffers(device.handle(), &allocate, &commands) == VK_SUCCESS);
  VkCommandBufferBeginInfo begin{};
  begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  REQUIRE(vkBeginCommandBuffer(commands, &begin) == VK_SUCCESS);
  vkCmdFillBuffer(commands, buffer.handle(), 0, VK_WHOLE_SIZE, 1);
  vkCmdFillBuffer(commands, buffer.handle(), 0, VK_WHOLE_SIZE, 2);
  vkEndCommandBuffer(commands);
  vkFreeCommandBuffers(device.handle(), device.command_pool(), 1, &commands);
  CHECK(said("SYNC-HAZARD-WRITE-AFTER-WRITE"));
}
