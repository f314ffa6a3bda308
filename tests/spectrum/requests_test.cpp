#include "host/error.hpp"
#include "host/io/coefficient_file.hpp"
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
#include "host/spectrum/convert.hpp"
#include "tests/support/refusals.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <fstream>
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
  const SphereCoefficients given = random_coefficients(8, 2, 1);
  there.input = set_of(given, {});
  there.grid = GridKind::fejer;
  const SynthesiseResult fields = synthesise(there, *backend, silent);
  CHECK(fields.run.plan.lmax == 8);
  AnalyseRequest back;
  back.input = fields.grid;
  const AnalyseResult again = analyse(back, *backend, silent);
  CHECK(compare(given, field_coefficients(again.coefficients, "analysed")).max < 1e-14);
  back.lmax = 9;
  CHECK_THROWS_AS(analyse(back, *backend, silent), Error);
  const RoundtripResult trip = roundtrip({16, 2, GridKind::gauss_legendre, 1, 1}, *backend, silent);
  CHECK(trip.passed());
}

TEST_CASE("expansions, transforms and conversions beyond the bounds of the command line are refused", "[requests]") {
  const auto expansion = [](auto&& set) {
    return [set] {
      ExpandRequest request;
      request.expansions.mass = true;
      request.expansions.maps = {MapMethod::flow};
      set(request);
      expand(request, make_body(ClosedSurface::from(load_mesh("builtin:tetrahedron")), {}, 1), *make_cpu_backend(1),
             silent);
    };
  };
  refuses(expansion([](ExpandRequest& r) { r.cut_off = 0.01; }), "the cut-off is 0.01: 0 to 0.001");
  refuses(expansion([](ExpandRequest& r) { r.expansions.lmax = 4097; }), "the degree is 4097: 0 to 4096");
  refuses(expansion([](ExpandRequest& r) { r.verify = Verify(17); }), "the check of the moments is number 17");
  refuses(expansion([](ExpandRequest& r) { r.expansions.flow.grid_degree = 63; }), "is 63: 64 to 8192");
  refuses(expansion([](ExpandRequest& r) { r.expansions.flow.refinements = 6; }), "are 6: 1 to 5");
  refuses(expansion([](ExpandRequest& r) { r.expansions.flow.meaning = FlowMeaning(17); }), "the meaning of the flow");
  const auto trip = [](auto&& set) {
    return [set] {
      RoundtripRequest request;
      request.lmax = 4;
      set(request);
      roundtrip(request, *make_cpu_backend(1), silent);
    };
  };
  refuses(trip([](RoundtripRequest& r) { r.fields = 65; }), "the fields are 65: 1 to 64");
  refuses(trip([](RoundtripRequest& r) { r.runs = 0; }), "the timed runs are 0: 1 to 1000");
  refuses(trip([](RoundtripRequest& r) { r.grid = GridKind(17); }), "the grid is of no known kind");
  const auto rebuilt = [](auto&& set) {
    return [set] {
      ReconstructRequest request;
      request.source.input = "builtin:tetrahedron";
      set(request);
      check_reconstruct(request);
    };
  };
  refuses(rebuilt([](ReconstructRequest& r) { r.fields = SurfaceFields(17); }), "the fields are number 17");
  refuses(rebuilt([](ReconstructRequest& r) { r.samples = 0; }), "the samples are 0: 1 to 100000000");
  refuses(rebuilt([](ReconstructRequest& r) { r.resolution = 8193; }), "the resolution is 8193");
  refuses(rebuilt([](ReconstructRequest& r) { r.source.lmax = 4097; }), "the degree is 4097");
  const auto conversion = [](auto&& set) {
    return [set] {
      ConvertRequest request;
      request.input = "nothing.json";
      set(request);
      convert(request, silent);
    };
  };
  refuses(conversion([](ConvertRequest& r) { r.target.normalisation = Normalisation(17); }),
          "the normalisation is number");
  refuses(conversion([](ConvertRequest& r) { r.input_phase = Phase(-2); }), "the phase is number -2");
  refuses(conversion([](ConvertRequest& r) { r.format = CoefficientFormat(17); }), "the format is number 17");
  DiffRequest difference;
  difference.tolerance = -1;
  refuses([&] { diff(difference); }, "the tolerance is -1");
}

TEST_CASE("a radius beside a stated unit of length says its own unit", "[requests][convert]") {
  // The Moon's lowest degrees in the layout of the Planetary Data System, in km.
  const TemporaryFolder folder;
  const std::string table = folder / "moon.tab";
  std::ofstream(table) << " 0.1738E+04, 0.4902800222E+04, 0.1E-03, 2, 2, 1, 0.0, 0.0\n"
                          " 1, 0, 0.0, 0.0, 1e-12, 1e-12\n 1, 1, 0.0, 0.0, 1e-12, 1e-12\n"
                          " 2, 0, -9.088e-05, 0.0, 1e-12, 1e-12\n 2, 1, -2e-10, 1.4e-09, 1e-12, 1e-12\n"
                          " 2, 2, 3.467e-05, -1.4e-09, 1e-12, 1e-12\n";
  ConvertRequest request;
  request.input = table;
  request.metres = 1000;
  request.brillouin_radius = Measure{1748, false, {}};
  refuses([&] { convert(request, silent); }, "--brillouin-radius 1748: with --length-unit it needs a unit of its own");
  request.brillouin_radius = Measure{1748e3, true, "km"};
  CHECK(*convert(request, silent).output.brillouin_radius == 1748e3);
  request.reference_radius = Measure{2, false, {}};
  refuses([&] { convert(request, silent); }, "--reference-radius 2: with --length-unit");
  request.reference_radius = Measure{2000, true, "km"};
  CHECK(*convert(request, silent).output.reference_radius == 2000);
}
