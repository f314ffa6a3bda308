#include "host/error.hpp"
#include "host/io/mesh_source.hpp"
#include "host/report/expansion_file.hpp"
#include "host/requests/convert.hpp"
#include "host/requests/diff.hpp"
#include "host/requests/expand.hpp"
#include "host/requests/paper_recipe.hpp"
#include "host/requests/reconstruct.hpp"
#include "host/requests/roundtrip.hpp"
#include "host/requests/spectrum.hpp"
#include "host/requests/transform.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

Monitor silent;

ExpandResult expand_ellipsoid(ExpansionChoice choice) {
  choice.flow.grid_degree = 128;
  ExpandRequest request;
  request.expansions = choice;
  return expand(request, make_body(ClosedSurface::from(load_mesh("builtin:ellipsoid:1,1,2@2")), {}, 1),
                *make_cpu_backend(), silent);
}

std::string written(const ExpandResult& result, const std::string& path) {
  AtomicFile file(path);
  write_expansion(result, coefficient_format(path), file, silent);
  file.commit();
  return path;
}

} // namespace

TEST_CASE("a call expands mass and surface, and another rebuilds order 7", "[requests][expand]") {
  const ExpandResult result = expand_ellipsoid(all_expansions(8));
  require_sound(result);
  CHECK(result.mass(0, 0).real() * std::sqrt(4 * std::numbers::pi) == Approx(result.body.mass()).epsilon(1e-14));
  REQUIRE(result.surfaces.size() == made_maps.size());
  const auto backend = make_cpu_backend();
  const SphereGrid grid = make_grid(GridKind::clenshaw_curtis, default_resolution(7));
  for (std::size_t i = 0; i < made_maps.size(); ++i) {
    const SurfaceResult& surface = result.surfaces[i];
    INFO(name(surface.of));
    CHECK(surface.of == made_maps[i]);
    CHECK(measure(surface.expansion, SurfaceFields::xyz, 7, *backend, silent).volume ==
          Approx(result.body.volume).epsilon(0.02));
    CHECK(reconstruct(surface.expansion, SurfaceFields::xyz, 7, grid, *backend, silent).faces.size() > 1000);
  }
}

TEST_CASE("an expansion that makes no sense is refused by the call too", "[requests][expand]") {
  ExpansionChoice paper;
  paper.mass = true;
  CHECK_THROWS_AS(take_paper_recipe(paper), Error); // it is about the harmonic map and the flow
  ExpansionChoice file = all_expansions(4);
  file.map_file = "map.ply";
  CHECK_THROWS_AS(expand_ellipsoid(file), Error);
  CHECK_THROWS_AS(expand_ellipsoid(all_expansions(-1)), Error);
}

TEST_CASE("bodies of several orders come one after the other", "[requests][reconstruct]") {
  ReconstructRequest request;
  request.source.input = "builtin:ellipsoid:1,1,2@2";
  request.source.lmax = 8;
  request.orders = {0, 7};
  request.resolution = 16;
  request.samples = 500;
  std::vector<int> visited;
  const ReconstructReport report =
      reconstruct(request, *make_cpu_backend(), silent, [&](const ReconstructReport&, int order, const auto& body) {
        CHECK(!body.faces.empty());
        visited.push_back(order);
        return "file";
      });
  CHECK(visited == std::vector{0, 7});
  REQUIRE(report.orders.size() == 2);
  CHECK(report.orders[1].output == "file");
  REQUIRE(report.orders[1].distance);
  CHECK(report.orders[1].measures.volume == Approx(report.body->volume).epsilon(0.02));
  request.orders = {99};
  CHECK_THROWS_AS(reconstruct(request, *make_cpu_backend(), silent), Error);
}

TEST_CASE("calls convert, compare and measure coefficients in files", "[requests][convert]") {
  const TemporaryFolder folder;
  ExpansionChoice mass;
  mass.mass = true;
  mass.lmax = 6;
  const ExpandResult result = expand_ellipsoid(mass);
  const std::string json = written(result, folder / "mass.json"), csv = written(result, folder / "mass.csv");

  DiffRequest same;
  same.first = json;
  same.second = csv;
  CHECK(diff(same).difference.worst() == 0);

  ConvertRequest request;
  request.input = json;
  request.format = CoefficientFormat::gfc;
  request.rotation = EulerAngles{0, std::numbers::pi, 0}; // which an ellipsoid does not mind
  const ConvertResult converted = convert(request, silent);
  CHECK(converted.input.kind == CoefficientKind::multipoles);
  CHECK(converted.output.kind == CoefficientKind::potential);
  CHECK(converted.output.convention == Convention{Normalisation::four_pi, Phase::none});
  CHECK(difference(converted.input, converted.output, {}).worst() < 1e-12);
  request.target.lmax = 7;
  CHECK_THROWS_AS(convert(request, silent), Error);

  const SpectrumResult power = spectrum({json, {}, false});
  REQUIRE(power.fields.size() == 1);
  for (int l = 0; l <= 6; ++l)
    CHECK(power.fields[0].power[std::size_t(l)] == Approx(std::pow(degree_norm(result.mass, l), 2)).epsilon(1e-14));
  CHECK_THROWS_AS(spectrum({json, {}, true}), Error);
}

TEST_CASE("calls synthesise and analyse fields", "[requests][transform]") {
  const auto backend = make_cpu_backend();
  SynthesiseRequest there;
  there.input.coefficients = random_coefficients(8, 2, 1);
  there.input.names = {"", ""};
  there.grid = GridKind::fejer;
  const SynthesiseResult fields = synthesise(there, *backend, silent);
  CHECK(fields.run.plan.lmax == 8);
  AnalyseRequest back;
  back.input = fields.grid;
  const AnalyseResult again = analyse(back, *backend, silent);
  CHECK(compare(there.input.coefficients, again.coefficients.coefficients).max < 1e-14);
  back.lmax = 9;
  CHECK_THROWS_AS(analyse(back, *backend, silent), Error);
  const RoundtripResult trip = roundtrip({16, 2, GridKind::gauss_legendre, 1, 1}, *backend, silent);
  CHECK(trip.passed());
}
