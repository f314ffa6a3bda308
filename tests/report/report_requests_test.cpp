// What draws, reports, times and reproduces, called from C++.
#include "host/requests/bench.hpp"
#include "host/requests/figure.hpp"
#include "host/requests/paper_recipe.hpp"
#include "host/requests/render.hpp"
#include "host/requests/report.hpp"
#include "host/requests/reproduce.hpp"

#include "host/error.hpp"
#include "host/io/mesh_source.hpp"
#include "host/paper/printed.hpp"
#include "host/report/expansion_file.hpp"
#include "host/requests/expand.hpp"
#include "tests/support/refusals.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <fstream>

using namespace cowgpu;
using namespace cowgpu::test;

TEST_CASE("a body is rendered by a call, as its mesh and at an order", "[requests][render]") {
  const auto backend = make_cpu_backend();
  RenderRequest request;
  request.source.input = "builtin:ellipsoid:1,1,2@2";
  request.source.lmax = 4;
  request.resolution = 8;
  request.panels = {30, 20, 0, false};
  request.orders = {2, std::nullopt};
  const RenderResult result = render(request, *backend, silent_monitor());
  CHECK(result.image.width == 60);
  CHECK(result.image.height == 20);
  CHECK(result.triangles > load_mesh(request.source.input).faces.size());
  request.orders = {9};
  CHECK_THROWS_AS(check_render(request), Error); // beyond the resolution
}

TEST_CASE("figures are made by a call, of one map and of all that can be made", "[requests][figure]") {
  const auto backend = make_cpu_backend();
  FigureRequest request;
  request.kind = FigureKind::definition;
  request.format = plot::PictureFormat::svg;
  request.mesh = load_mesh("builtin:ellipsoid:1,1,2@2");
  request.expansions.lmax = 8;
  request.expansions.maps = {MapMethod::stretch};
  const TemporaryFolder folder;
  AtomicFile file(folder / "definition.svg");
  FigureResult result = make_figure(request, *backend, silent_monitor());
  result.page.write(file);
  file.commit();
  CHECK(result.left_out.empty());
  request.expansions.maps.push_back(MapMethod::smooth);
  CHECK_THROWS_AS(make_figure(request, *backend, silent_monitor()), Error);
  CHECK(can_be_svg(FigureKind::spectra));
  CHECK_FALSE(can_be_svg(FigureKind::orders));
}

TEST_CASE("a result becomes a page by a call", "[requests][report]") {
  const TemporaryFolder folder;
  const std::string path = folder / "cow.json";
  const auto backend = make_cpu_backend();
  const RawMesh mesh = load_mesh("builtin:ellipsoid:1,1,2@2");
  ExpandRequest expansion;
  expansion.expansions.maps = {MapMethod::stretch};
  expansion.expansions.lmax = 4;
  AtomicFile file(path);
  write_expansion(expand(expansion, make_body(ClosedSurface::from(mesh), {}, 1), *backend, silent_monitor()),
                  coefficient_format(path), file, silent_monitor());
  file.commit();
  ReportRequest request;
  request.result = path;
  request.mesh = mesh;
  request.order = 2;
  const auto report = make_report(request, *backend, silent_monitor());
  CHECK(report->warning.empty());
  REQUIRE(report->document.surfaces.size() == 1);
  CHECK(report->document.surfaces[0].distances[0].size() == 3); // orders 0, 1, 2
  CHECK(page_data(report->document).find("stretch") != std::string::npos);
  request.order = 5;
  CHECK_THROWS_AS(make_report(request, *backend, silent_monitor()), Error);
}

TEST_CASE("moments are timed by a call", "[requests][bench]") {
  BenchRequest request;
  request.mesh = load_mesh("builtin:tetrahedron");
  request.lmax = {1, 2};
  request.runs = 1;
  const BenchResult result = bench_moments(request, nullptr, silent_monitor());
  REQUIRE(result.paths.size() == 2);
  REQUIRE(result.rows.size() == 4);
  CHECK(result.rows[3].lmax == 2);
  CHECK(result.rows[3].path == 1);
}

TEST_CASE("the paper is reproduced by a call, with any program that runs its stages", "[requests][reproduce]") {
  const TemporaryFolder folder;
  ReproduceRequest request;
  request.folder = folder / "out";
  request.mesh = "benchmark";
  request.mesh_sha256 = benchmark_sha256;
  request.only = {"tensors"};
  request.page = false;
  request.run = [](const auto& arguments, const auto& where, const auto& output, const auto&, const auto& waiting) {
    CHECK(arguments.front() == "tensors");
    std::ofstream(where / output) << R"({"paper": [{"quantity": "volume", "ours": 0.054, "paper": 0.054, "why": ""}]})";
    waiting();
    return 0;
  };
  std::size_t told = 0;
  request.done = [&](const reproduce::Ran& ran, std::size_t, std::size_t) { told += ran.exit_code == 0; };
  const reproduce::Reproduction all = reproduce_paper(request, silent_monitor());
  CHECK(told == 1);
  CHECK(all.rows.size() == 116);
  CHECK(reproduce::tally(all.rows).agrees == 1);
  CHECK(std::filesystem::exists(request.folder / "reproduce.md"));
  request.only = {"milk"};
  CHECK_THROWS_AS(reproduce_paper(request, silent_monitor()), Error);
}

TEST_CASE("the paper's recipes are requests", "[requests][paper]") {
  const RadiateRequest radiation = paper_radiation();
  CHECK(radiation.body.mesh == "benchmark");
  CHECK(*radiation.body.length_unit == 2.39);
  CHECK(radiation.omega == 1);
  ExpansionChoice choice;
  choice.maps = {MapMethod::harmonic, MapMethod::stretch};
  take_paper_recipe(choice);
  CHECK(choice.harmonic.disk_scale == 10);
  CHECK(choice.reading.closest_point);
  CHECK(choice.flow.time == paper::flow_time);
}

TEST_CASE("each printed number has a name of its own, and those about errata name one", "[paper]") {
  CHECK(paper::number("tensors", "quadrupole yz") == 3.9e-7);
  CHECK(paper::beside("radiation", "mass in kg", 730).why == "of the volume 0.054");
  CHECK_THROWS_AS(paper::number("tensors", "milk"), std::out_of_range);
  for (const paper::Printed& p : paper::printed()) {
    INFO(p.table << ": " << p.item);
    CHECK(&paper::printed(p.table, p.item) == &p);
    CHECK((p.erratum >= 0 && p.erratum <= 18));
  }
}

TEST_CASE("figures and timings beyond the bounds of the command line are refused by the calls", "[requests]") {
  const auto backend = make_cpu_backend(1);
  const auto figure = [&](auto&& set) {
    return [&, set] {
      FigureRequest request;
      request.mesh = load_mesh("builtin:tetrahedron");
      request.expansions.maps = {MapMethod::stretch};
      request.expansions.lmax = 8;
      set(request);
      make_figure(std::move(request), *backend, silent_monitor());
    };
  };
  refuses(figure([](FigureRequest& r) { r.kind = FigureKind(17); }),
          "the figure is number 17 of its kind: there are 0 to 6");
  refuses(figure([](FigureRequest& r) { r.format = plot::PictureFormat(17); }), "the format is number 17");
  refuses(figure([](FigureRequest& r) { r.expansions.lmax = 7; }), "the degree is 7: 8 to 4096");
  refuses(figure([](FigureRequest& r) { r.streamlines = 0; }), "the streamlines are 0: 1 to 100000");
  const auto timing = [](auto&& set) {
    return [set] {
      BenchRequest request;
      request.mesh = load_mesh("builtin:tetrahedron");
      set(request);
      bench_moments(std::move(request), nullptr, silent_monitor());
    };
  };
  refuses(timing([](BenchRequest& r) { r.lmax = {4, 4097}; }), "the degree is 4097");
  refuses(timing([](BenchRequest& r) { r.cut_off = -1; }), "the cut-off is -1");
  refuses(timing([](BenchRequest& r) { r.runs = 0; }), "the timed runs are 0");
  RenderRequest render;
  render.fields = SurfaceFields(17);
  refuses([&] { check_render(render); }, "the fields are number 17");
}
