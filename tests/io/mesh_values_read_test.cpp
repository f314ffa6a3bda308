#include "host/io/mesh_values_read.hpp"

#include "host/io/file.hpp"
#include "host/io/mesh_values_file.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/reader_checks.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

MeshValues sample(ValuePlace place) {
  const RawMesh mesh = icosphere(1);
  MeshValues values;
  values.title = "a ball";
  values.place = place;
  values.vertices = mesh.vertices;
  if (place != ValuePlace::points) values.faces = mesh.faces;
  values.places = mesh.vertices;
  if (place == ValuePlace::faces) values.places.assign(mesh.faces.size(), Vec3(1.0 / 3, 0, 0));
  values.length_unit = "km";
  ValueColumn g{"g", "m/s^2", "the force", 3, {}}, size{"g", "m/s^2", "its size", 1, {}};
  for (std::size_t i = 0; i < values.places.size(); ++i) {
    g.values.insert(g.values.end(), {double(i) / 3, 1, -1e-300});
    size.values.push_back(double(i) / 7);
  }
  values.columns = {g, size};
  values.notes = {"a note"};
  values.facts = {{"density", "1"}};
  return values;
}

struct Files {
  std::string table, about;
};

Files files(const MeshValues& values) {
  const TemporaryFolder folder;
  const std::string path = folder / "x.csv";
  write_mesh_values(path, values);
  return {read_file(path), read_file(path + ".json")};
}

Outcome outcome(const std::string& table, const std::string& about) {
  return outcome_of([&] { parse_mesh_values(table, about, "x.csv"); });
}

} // namespace

TEST_CASE("a table of values reads back bit for bit, with units and meanings", "[mesh-values][readers]") {
  for (const ValuePlace place : {ValuePlace::faces, ValuePlace::vertices, ValuePlace::points}) {
    const MeshValues values = sample(place);
    const Files written = files(values);
    MeshValues read = parse_mesh_values(written.table, written.about, "x.csv");
    CHECK((read.title == "a ball" && read.place == place && read.length_unit == "km"));
    CHECK((read.places == values.places && read.notes == values.notes && read.facts == values.facts));
    REQUIRE(read.columns.size() == 2);
    for (std::size_t c = 0; c < 2; ++c) {
      CHECK(read.columns[c].name == "g");
      CHECK(read.columns[c].meaning == values.columns[c].meaning);
      CHECK(read.columns[c].unit == "m/s^2");
      CHECK(read.columns[c].components == values.columns[c].components);
      CHECK(read.columns[c].values == values.columns[c].values);
    }
    const RawMesh mesh = icosphere(1), other = icosphere(2);
    if (place == ValuePlace::points) {
      CHECK(outcome_of([&] { put_on(read, mesh.vertices, mesh.faces); }).fault == "bad-argument");
      continue;
    }
    CHECK(outcome_of([&] {
            put_on(read, other.vertices, other.faces);
          }).says("name the mesh that they were computed on"));
    put_on(read, mesh.vertices, mesh.faces);
    check(read);
  }
}

TEST_CASE("tables of values that are none, or another's, are refused by name", "[mesh-values][readers]") {
  const auto [table, about] = files(sample(ValuePlace::faces));
  CHECK(outcome(table, about).fault == "none");
  CHECK(outcome(replaced(table, "id,x", "id,r"), about).fault == "file-format");
  CHECK(outcome(replaced(table, ",g\n", ",h\n"), about).says("its columns are not those of the table"));
  CHECK(outcome(table + "80,0,0,0,0,0,0,0\n", about).says("its rows"));
  CHECK(outcome(table + "80,0,0\n", about).fault == "file-syntax");
  CHECK(outcome(table, "{").fault == "file-syntax");
  CHECK(outcome(table, "[]").fault == "file-format");
  CHECK(outcome(table, replaced(about, "values.v1", "values.v2")).says("schema"));
  CHECK(outcome(table, replaced(about, "\"faces\"", "\"edges\"")).says("none of faces, vertices and points"));
  CHECK(outcome(table, replaced(about, "\"km\"", "5")).says("must be a text"));
  check_prefixes(table.substr(0, 400),
                 [&about = about](std::string_view bytes) { parse_mesh_values(bytes, about, "x"); });
  check_mutations(about, 2000,
                  [&table = table](std::string_view bytes) { parse_mesh_values(table, std::string(bytes), "x"); });
  check_mutations(table, 300, [&about = about](std::string_view bytes) { parse_mesh_values(bytes, about, "x"); });
  CHECK(outcome_of([] { read_mesh_values("/none/x.csv"); }).fault == "cannot-read");
}
