#include "engine/gpu.hpp"
#include "engine/kernels/translations.hpp"
#include "host/gpu/translation_program.hpp"
#include "host/plan/translations.hpp"
#include "tests/support/compare_moments.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <random>

using namespace cowgpu;
using namespace cowgpu::test;
using cowgpu::plan::densities;
using cowgpu::plan::harmonics;

namespace {

std::vector<double> noise(std::mt19937& random, std::size_t count) {
  std::normal_distribution<double> normal;
  std::vector<double> made(count);
  for (double& x : made) x = normal(random);
  return made;
}

// What comes of some pairs on the device, and on the host.
struct Moved {
  std::vector<double> device, host;
};

// Pairs with any source, in runs of one to four to one local expansion.
Moved move_all(engine::Translations& device, const plan::Translations& translations, int order, std::size_t count,
               std::mt19937& random) {
  constexpr std::size_t sources = 5;
  const std::size_t numbers = densities * harmonics(order), stride = densities * harmonics(translations.order());
  const std::vector<double> multipoles = noise(random, sources * numbers);
  std::vector<engine::TranslationPair> pairs;
  std::vector<engine::TranslationRun> runs;
  const std::vector<std::array<double, 3>> along = {{0, 0, 1.5}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}};
  for (std::size_t i = 0; i < count; ++i) {
    const std::vector<double> some = noise(random, 3);
    if (runs.empty() || runs.back().count == 1 + runs.size() % 4)
      runs.push_back({std::uint32_t(runs.size()), std::uint32_t(i), 0});
    ++runs.back().count;
    pairs.push_back({i % 7 < along.size() ? along[i % 7] : std::array<double, 3>{some[0], some[1], some[2]},
                     std::uint32_t(random() % sources)});
  }
  Moved moved;
  moved.device.resize(runs.size() * stride);
  moved.host.resize(runs.size() * stride);
  device.begin(runs.size());
  device.add(order, multipoles, pairs, runs);
  if (!runs.empty()) device.read(moved.device);
  plan::Translations::Room room(translations.order());
  for (const engine::TranslationRun& run : runs)
    for (std::uint32_t i = run.first; i < run.first + run.count; ++i) {
      const auto& [shift, source] = pairs[i];
      const plan::TranslationPair one{&multipoles[source * numbers], &moved.host[run.local * stride],
                                      Vec3(shift[0], shift[1], shift[2])};
      translations.add(plan::Translation::multipole_to_local, order, std::span(&one, 1), room);
    }
  return moved;
}

} // namespace

TEST_CASE("translations on a device are the host's, in any number of pairs", "[polyhedron_fast][vulkan]") {
  if (!gpu_backend()) return skip_without_gpu();
  engine::Gpu gpu("auto", true);
  std::mt19937 random(3);
  for (const int top : {2, 10, 28}) {
    const plan::Translations translations(top);
    const gpu::TranslationProgram program = gpu::translation_program(translations);
    engine::Translations device(gpu.device(), {program.matrix, program.orders, program.places});
    for (const int order : {0, 1, 2, 5, 10, 28})
      for (const std::size_t count : {0, 1, 7, 13, 1025}) {
        if (order > top || (order > 10 && count > 13)) continue;
        const Moved moved = move_all(device, translations, order, count, random);
        const std::size_t stride = densities * harmonics(top);
        double worst = 0;
        for (std::size_t first = 0; first < moved.host.size(); first += stride) {
          double largest = 0;
          for (std::size_t k = first; k < first + stride; ++k) largest = std::max(largest, std::abs(moved.host[k]));
          for (std::size_t k = first; k < first + stride; ++k)
            worst = std::max(worst, std::abs(moved.device[k] - moved.host[k]) / largest);
        }
        INFO("order " << order << " of " << top << ", pairs " << count);
        check_at_most(worst, 1e-13, "coefficients");
      }
  }
  CHECK(gpu.validation_messages() == std::vector<std::string>{});
}

TEST_CASE("a translation that the device cuts short is an error, not an answer", "[polyhedron_fast][vulkan]") {
  if (!gpu_backend()) return skip_without_gpu();
  engine::Gpu gpu("auto", true);
  // One product of more columns than software devices run iterations.
  engine::TranslationRecord product{engine::TranslationStep::multiply};
  product.columns = 65535;
  product.rows = {1, 1, 1, 1};
  const std::vector<double> matrix(4 * 65535);
  const std::vector<std::vector<engine::TranslationRecord>> orders = {{product, product}};
  engine::TranslationsInput input{matrix, orders, 2};
  CHECK_THROWS_AS(engine::Translations(gpu.device(), input), engine::Error);
  input.iteration_budget = 1U << 30;
  engine::Translations device(gpu.device(), input);
  device.begin(1);
  const std::vector<double> multipole(densities);
  const engine::TranslationPair pair{{0, 0, 1}, 0};
  const engine::TranslationRun run{0, 0, 1};
  try {
    device.add(0, multipole, {&pair, 1}, {&run, 1});
    CHECK(gpu.facts().type != "software");
  } catch (const engine::Error& error) {
    CHECK(error.failure() == engine::Failure::cut_short);
    CHECK_THAT(error.what(), Catch::Contains("ended a loop early"));
  }
}
