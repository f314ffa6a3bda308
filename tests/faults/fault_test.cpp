// What the Vulkan path says and leaves behind when calls fail under it.
#include "host/backend.hpp"
#include "host/error.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/vulkan_faults.hpp"

#include <catch2/catch.hpp>

#include <cstring>
#include <functional>
#include <iostream>
#include <optional>
#include <random>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;

namespace {

using Bits = std::vector<double>;

template <class T>
void append(Bits& bits, const std::vector<T>& values) {
  const std::size_t first = bits.size();
  bits.resize(first + (values.size() * sizeof(T) + 7) / 8);
  if (!values.empty()) std::memcpy(static_cast<void*>(&bits[first]), values.data(), values.size() * sizeof(T));
}

bool same(const Bits& a, const Bits& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

struct Verb {
  const char* name;
  std::function<Bits(Backend&)> run;
};

std::vector<Vec3> scattered(std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  std::vector<Vec3> points(count);
  for (Vec3& p : points) p = {uniform(random), uniform(random), uniform(random)};
  return points;
}

// Every stage of the Vulkan path, on little work.
std::vector<Verb> verbs() {
  const auto body = cowgpu::test::icosphere(2);
  std::vector<Vec3> unit = body.vertices;
  for (Vec3& v : unit) v.normalize();
  const auto moments = [body](Backend& backend) {
    MomentProblem problem;
    problem.vertices = body.vertices;
    problem.faces = body.faces;
    problem.reference_radius = 2;
    problem.lmax = 20;
    Monitor monitor;
    Bits bits;
    append(bits, backend.moments(problem)->run(monitor).values);
    return bits;
  };
  const auto transform = [](Backend& backend) {
    Monitor monitor;
    const auto t = backend.sphere_transform(make_grid(GridKind::gauss_legendre, 20), 20);
    SphereCoefficients a(20, 2);
    for (std::size_t i = 0; i < a.values.size(); ++i) a.values[i] = {1.0 / double(1 + i), 0};
    Bits bits(2 * t->grid().points());
    t->synthesise(2, a.values, bits, monitor);
    const Bits values = bits;
    t->analyse(2, values, a.values, monitor);
    append(bits, a.values);
    return bits;
  };
  const auto sample = [body, unit](Backend& backend) {
    Monitor monitor;
    const auto found =
        backend.sphere_sampler(make_grid(GridKind::gauss_legendre, 12))->sample(unit, body.faces, monitor);
    Bits bits;
    append(bits, found.faces);
    return bits;
  };
  const auto closest = [body](Backend& backend) {
    Monitor monitor;
    const auto field = backend.distance_field(body.vertices, body.faces);
    Bits bits;
    append(bits, field->closest(scattered(200), {}, monitor).distance);
    return bits;
  };
  const auto flow = [body](Backend& backend) {
    Monitor monitor;
    FlowOptions options;
    options.time = 0.3;
    const auto f = backend.distance_flow(body.vertices, body.faces);
    Bits bits;
    append(bits, f->flow(scattered(300), {}, options, monitor, nullptr).positions);
    return bits;
  };
  return {{"moments", moments}, {"transform", transform}, {"sample", sample}, {"closest", closest}, {"flow", flow}};
}

std::optional<Error> error_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error;
  }
  return {};
}

// Numbers 0 ... count - 1, all of them or some from end to end.
std::vector<int> places(int count, int most) {
  std::vector<int> some;
  for (int i = 0; i < std::min(count, most); ++i) some.push_back(count <= most ? i : i * (count - 1) / (most - 1));
  return some;
}

void skip() {
  std::cout << "SKIPPED: no Vulkan device" << std::endl;
}

} // namespace

TEST_CASE("whatever Vulkan call fails, the error names the device and the same backend goes on", "[fault][vulkan]") {
  if (!gpu_backend()) return skip();
  for (const Verb& verb : verbs()) {
    INFO(verb.name);
    auto backend = gpu_backend();
    VulkanFaults faults;
    const Bits expected = verb.run(*backend); // pipelines are made and kept
    faults.disarm();
    CHECK(same(verb.run(*backend), expected));
    for (const VulkanCall call : {VulkanCall::allocate, VulkanCall::buffer, VulkanCall::view, VulkanCall::map,
                                  VulkanCall::sets, VulkanCall::commands, VulkanCall::fence}) {
      faults.disarm();
      verb.run(*backend);
      const int count = faults.seen(call);
      INFO(name(call) << ", " << count << " calls");
      for (const int n : places(count, 8)) {
        INFO("failing the one of number " << n);
        faults.arm(call, n);
        const auto error = error_of([&] { verb.run(*backend); });
        REQUIRE(error);
        CHECK(error->fault() == Fault::device_failed);
        CHECK_THAT(error->what(), Contains(backend->facts().name) && Contains("--device cpu"));
        faults.disarm();
        CHECK(same(verb.run(*backend), expected));
      }
    }
    CHECK(backend->validation_messages() == std::vector<std::string>{});
    backend.reset();
    CHECK(faults.live_memory() == 0);
    CHECK(faults.live_buffers() == 0);
  }
}

TEST_CASE("a kernel that cannot be made is an error, and is made by the next call", "[fault][vulkan]") {
  if (!gpu_backend()) return skip();
  for (const Verb& verb : verbs()) {
    INFO(verb.name);
    const Bits expected = verb.run(*gpu_backend());
    auto backend = gpu_backend();
    VulkanFaults faults;
    // Each call gets as far as the next kernel.
    for (const VulkanCall call : {VulkanCall::module, VulkanCall::pipeline}) {
      faults.arm(call, 0);
      const auto error = error_of([&] { verb.run(*backend); });
      REQUIRE(error);
      CHECK(error->fault() == Fault::device_failed);
      CHECK_THAT(error->what(), Contains("make the kernel") && Contains(backend->facts().name));
    }
    faults.disarm();
    CHECK(same(verb.run(*backend), expected));
    CHECK(faults.seen(VulkanCall::pipeline) > 0);
    CHECK(backend->validation_messages() == std::vector<std::string>{});
    backend.reset();
    CHECK(faults.live_memory() == 0);
    CHECK(faults.live_buffers() == 0);
  }
}

TEST_CASE("a device that is lost or hangs is given up: this call and every later one say so", "[fault][vulkan]") {
  if (!gpu_backend()) return skip();
  for (const Verb& verb : verbs()) {
    INFO(verb.name);
    int submits = 0;
    {
      auto backend = gpu_backend();
      VulkanFaults faults;
      verb.run(*backend);
      submits = faults.seen(VulkanCall::submit);
    }
    REQUIRE(submits > 0);
    for (const VulkanCall call : {VulkanCall::submit, VulkanCall::wait, VulkanCall::hang})
      for (const int n : places(submits, 3)) {
        INFO(name(call) << " number " << n << " of " << submits);
        auto backend = gpu_backend();
        VulkanFaults faults;
        faults.arm(call, n, call == VulkanCall::hang ? for_ever : 1);
        const auto error = error_of([&] { verb.run(*backend); });
        REQUIRE(error);
        CHECK(error->fault() == Fault::device_lost);
        CHECK(exit_code(error->fault()) == 4);
        CHECK_THAT(error->what(), Contains(backend->facts().name) && Contains("--device cpu"));
        faults.disarm();
        const auto later = error_of([&] { verb.run(*backend); });
        REQUIRE(later);
        CHECK(later->fault() == Fault::device_lost);
        CHECK_THAT(later->what(), Contains("lost earlier"));
        CHECK(faults.seen(VulkanCall::submit) == 0);
        backend.reset();
        // Shaders that still run may use it all.
        CHECK(faults.live_memory() > 0);
        CHECK(faults.destroyed_since() == 0);
      }
  }
}

TEST_CASE("a batch that takes long is waited for: slices count, and a device hangs after three thousand of them",
          "[fault][vulkan]") {
  if (!gpu_backend()) return skip();
  for (const Verb& verb : verbs()) {
    INFO(verb.name);
    auto backend = gpu_backend();
    const Bits expected = verb.run(*backend);
    VulkanFaults faults;
    faults.arm(VulkanCall::hang, 0, 2999);
    CHECK(same(verb.run(*backend), expected));
    CHECK(faults.seen(VulkanCall::hang) > 2999);
    faults.arm(VulkanCall::hang, 0, 3000);
    const auto error = error_of([&] { verb.run(*backend); });
    REQUIRE(error);
    CHECK(error->fault() == Fault::device_lost);
    CHECK_THAT(error->what(), Contains("hangs") && Contains("300 s"));
  }
}

TEST_CASE("a wish to stop ends the wait for a device that hangs, and its memory is left", "[fault][vulkan]") {
  if (!gpu_backend()) return skip();
  auto backend = gpu_backend();
  VulkanFaults faults;
  struct Stopper : Monitor {
    const VulkanFaults& faults;
    explicit Stopper(const VulkanFaults& f) : faults(f) {}
    bool stopped() const override { return faults.seen(VulkanCall::hang) > 5; }
  } monitor(faults);
  const auto body = cowgpu::test::icosphere(2);
  MomentProblem problem;
  problem.vertices = body.vertices;
  problem.faces = body.faces;
  problem.reference_radius = 2;
  problem.lmax = 20;
  faults.arm(VulkanCall::hang, 0, for_ever);
  const auto error = error_of([&] { backend->moments(problem)->run(monitor); });
  REQUIRE(error);
  CHECK(error->fault() == Fault::interrupted);
  CHECK_THAT(error->what(), Contains("stopped") && Contains(backend->facts().name));
  CHECK(faults.seen(VulkanCall::hang) < 100);
  faults.disarm();
  backend.reset();
  CHECK(faults.live_memory() > 0);
  CHECK(faults.destroyed_since() == 0);
}
