// Values on bodies in files, read back by readers that share no code with the writers.
#include "host/io/mesh_values_file.hpp"

#include "host/colour_scale.hpp"
#include "host/error.hpp"
#include "host/io/file.hpp"
#include "host/io/mesh_format.hpp"
#include "host/io/netcdf.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/reader_checks.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <Eigen/Geometry>

#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <sstream>

using namespace cowgpu;
using namespace cowgpu::test;
using nlohmann::json;

namespace {

/// Numbers that no short text or float holds, on an icosphere away from the origin.
MeshValues sample(ValuePlace place, int level = 1) {
  const RawMesh mesh = icosphere(level);
  MeshValues values;
  values.title = "a \"body\" <of> ours & more";
  values.place = place;
  values.vertices = mesh.vertices;
  for (Vec3& v : values.vertices) v += Vec3(0.1, -0.2, 1.0 / 3);
  if (place != ValuePlace::points) values.faces = mesh.faces;
  values.places = values.vertices;
  if (place == ValuePlace::faces) {
    values.places.clear();
    for (const Face& f : values.faces)
      values.places.push_back((values.vertices[f[0]] + values.vertices[f[1]] + values.vertices[f[2]]) / 3);
  }
  values.length_unit = "m";
  ValueColumn potential{"potential", "m^2/s^2", "the potential, positive", 1, {}}, g{"g", "m/s^2", "the force", 3, {}},
      size{"g", "m/s^2", "its size", 1, {}}, slope{"slope", "deg", "angle < 90 & more", 1, {}};
  for (std::size_t i = 0; i < values.places.size(); ++i) {
    const Vec3& p = values.places[i];
    potential.values.push_back(1 / (1 + p.norm()));
    for (int c = 0; c < 3; ++c) g.values.push_back(-p[c] / 7);
    size.values.push_back(p.norm() / 7);
    slope.values.push_back(30 + 30 * p.x() * p.y());
  }
  values.columns = {potential, g, size, slope};
  values.notes = {"potentials are positive", "two\nlines"};
  values.facts = {{"density", "2670 kg/m^3"}};
  return values;
}

struct Written {
  std::string bytes, beside;
};

Written written(const MeshValues& values, const std::string& suffix, const std::string& colour = "") {
  const TemporaryFolder folder;
  const std::string path = folder / ("x" + suffix);
  write_mesh_values(path, values, colour);
  Written found{read_file(path), {}};
  if (suffix == ".csv") found.beside = read_file(path + ".json");
  return found;
}

template <class T>
T at(const std::string& bytes, std::size_t offset) {
  T value;
  REQUIRE(offset + sizeof(T) <= bytes.size());
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

std::string attribute_of(const std::string& element, const std::string& name) {
  const std::size_t from = element.find(" " + name + "=\"");
  if (from == std::string::npos) return "";
  const std::size_t begin = from + name.size() + 3;
  return element.substr(begin, element.find('"', begin) - begin);
}

struct VtpArray {
  std::string section, element, unit;
  std::string bytes;
};

/// The arrays of a VTP file by section and name.
std::map<std::string, VtpArray> vtp_arrays(const std::string& file) {
  const std::size_t appended = file.find("<AppendedData"), start = file.find('_', appended) + 1;
  REQUIRE(appended != std::string::npos);
  const std::string head = file.substr(0, appended);
  std::map<std::string, VtpArray> arrays;
  std::string section;
  std::size_t end = 0;
  for (std::size_t from = head.find('<'); from != std::string::npos; from = head.find('<', from + 1)) {
    const std::string element = head.substr(from, head.find('>', from) - from);
    for (const char* known : {"PointData", "CellData", "Points", "Verts", "Polys", "FieldData"})
      if (element.starts_with("<" + std::string(known)) && !std::isalnum(element[1 + std::strlen(known)]))
        section = known;
    if (!element.starts_with("<DataArray")) continue;
    VtpArray array{section, element, {}, {}};
    CHECK(attribute_of(element, "format") == "appended");
    const std::size_t offset = std::stoull(attribute_of(element, "offset"));
    CHECK(offset == end); // no gaps, no overlaps
    const auto length = at<std::uint64_t>(file, start + offset);
    array.bytes = file.substr(start + offset + 8, length);
    end = offset + 8 + length;
    if (!element.ends_with("/")) {
      const std::size_t key = head.find("UNITS_LABEL", from), text = head.find('>', key) + 1;
      array.unit = head.substr(text, head.find('<', text) - text);
    }
    arrays[section + "/" + attribute_of(element, "Name")] = array;
  }
  CHECK(file.substr(start + end) == "\n  </AppendedData>\n</VTKFile>\n");
  return arrays;
}

std::vector<double> doubles(const std::string& bytes) {
  std::vector<double> values(bytes.size() / 8);
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), 8 * values.size());
  return values;
}

std::vector<double> flat(const std::vector<Vec3>& points) {
  std::vector<double> values;
  for (const Vec3& p : points) values.insert(values.end(), {p.x(), p.y(), p.z()});
  return values;
}

std::vector<double> component(const ValueColumn& column, std::size_t c) {
  std::vector<double> values;
  for (std::size_t i = c; i < column.values.size(); i += std::size_t(column.components))
    values.push_back(column.values[i]);
  return values;
}

const ValuePlace all_places[] = {ValuePlace::faces, ValuePlace::vertices, ValuePlace::points};

} // namespace

TEST_CASE("a VTP file has the mesh and every number, in blocks that follow each other", "[mesh-values]") {
  for (const ValuePlace place : all_places) {
    INFO(name_of(place));
    const MeshValues values = sample(place);
    const std::string file = written(values, ".vtp").bytes;
    auto arrays = vtp_arrays(file);
    const std::string here = place == ValuePlace::faces ? "CellData/" : "PointData/";
    CHECK(doubles(arrays.at("Points/Points").bytes) == flat(values.vertices));
    CHECK(arrays.at("Points/Points").unit == "m");
    CHECK(doubles(arrays.at(here + "potential").bytes) == values.columns[0].values);
    CHECK(doubles(arrays.at(here + "g_vector").bytes) == values.columns[1].values);
    CHECK(attribute_of(arrays.at(here + "g_vector").element, "NumberOfComponents") == "3");
    CHECK(doubles(arrays.at(here + "g").bytes) == values.columns[2].values);
    CHECK(arrays.at(here + "slope").unit == "deg");
    CHECK(arrays.count(here + "place") == (place == ValuePlace::faces));
    const std::string& corners = arrays.at("Polys/connectivity").bytes;
    REQUIRE(corners.size() == 12 * values.faces.size());
    if (!corners.empty()) CHECK(std::memcmp(corners.data(), values.faces.data(), corners.size()) == 0);
    for (std::size_t f = 0; f < values.faces.size(); ++f)
      CHECK(at<std::int32_t>(arrays.at("Polys/offsets").bytes, 4 * f) == std::int32_t(3 * f + 3));
    const std::size_t dots = arrays.at("Verts/offsets").bytes.size() / 4;
    CHECK(dots == (place == ValuePlace::points ? values.vertices.size() : 0));
    CHECK(file.find("header_type=\"UInt64\"") != std::string::npos);
    CHECK(file.find("Scalars=\"slope\"") != std::string::npos);
  }
  MeshValues above = sample(ValuePlace::vertices);
  for (Vec3& p : above.places) p *= 1.5;
  CHECK(doubles(vtp_arrays(written(above, ".vtp").bytes).at("PointData/place").bytes) == flat(above.places));
}

TEST_CASE("a PLY file has every number as it was, and colours", "[mesh-values]") {
  for (const ValuePlace place : all_places) {
    INFO(name_of(place));
    const MeshValues values = sample(place);
    const std::string file = written(values, ".ply", "potential").bytes;
    const std::size_t head = file.find("end_header\n") + 11;
    const std::string names =
        "property double potential\nproperty double g_x\nproperty double g_y\nproperty double g_z\n"
        "property double g\nproperty double slope\nproperty uchar red\nproperty uchar green\n"
        "property uchar blue\n";
    const std::string xyz = "property double x\nproperty double y\nproperty double z\n",
                      list = "property list uchar int vertex_indices\n";
    const bool of_faces = place == ValuePlace::faces;
    const std::string wanted =
        fmt::format("element vertex {}\n{}element face {}\n{}end_header\n", values.vertices.size(),
                    xyz + (of_faces ? "" : names), values.faces.size(), list + (of_faces ? names : ""));
    REQUIRE(file.substr(0, head).ends_with(wanted));
    CHECK(file.find("comment slope: deg; angle < 90 & more\n") != std::string::npos);
    CHECK(file.find("comment note: two lines\n") != std::string::npos);
    const std::size_t value_bytes = 6 * 8 + 3, vertex_bytes = 24 + (of_faces ? 0 : value_bytes);
    const std::size_t face_bytes = 13 + (of_faces ? value_bytes : 0);
    const std::size_t faces = head + vertex_bytes * values.vertices.size();
    REQUIRE(file.size() == faces + face_bytes * values.faces.size());
    const auto check_values = [&](std::size_t i, std::size_t from) {
      const double numbers[] = {values.columns[0].values[i],         values.columns[1].values[3 * i],
                                values.columns[1].values[3 * i + 1], values.columns[1].values[3 * i + 2],
                                values.columns[2].values[i],         values.columns[3].values[i]};
      for (std::size_t k = 0; k < 6; ++k) CHECK(at<double>(file, from + 8 * k) == numbers[k]);
    };
    for (std::size_t v = 0; v < values.vertices.size(); ++v) {
      for (std::size_t c = 0; c < 3; ++c)
        CHECK(at<double>(file, head + vertex_bytes * v + 8 * c) == values.vertices[v][int(c)]);
      if (!of_faces) check_values(v, head + vertex_bytes * v + 24);
    }
    for (std::size_t f = 0; f < values.faces.size(); ++f) {
      CHECK(int(file[faces + face_bytes * f]) == 3);
      for (std::size_t k = 0; k < 3; ++k)
        CHECK(at<std::uint32_t>(file, faces + face_bytes * f + 1 + 4 * k) == values.faces[f][k]);
      if (of_faces) check_values(f, faces + face_bytes * f + 13);
    }
    // The least and the greatest potential have the ends of viridis, which are known: #440154 and #fde725.
    const auto& potentials = values.columns[0].values;
    const std::size_t least = std::size_t(std::min_element(potentials.begin(), potentials.end()) - potentials.begin()),
                      most = std::size_t(std::max_element(potentials.begin(), potentials.end()) - potentials.begin());
    const auto colour = [&](std::size_t i) {
      return file.substr(of_faces ? faces + face_bytes * i + 13 + 48 : head + vertex_bytes * i + 24 + 48, 3);
    };
    CHECK(colour(least) == "\x44\x01\x54");
    CHECK(colour(most) == "\xfd\xe7\x25");
    // The program's own reader of meshes takes it too.
    if (place != ValuePlace::points) CHECK(parse_mesh(file, "x.ply").faces == values.faces);
  }
}

TEST_CASE("a GLB file shows each face or vertex in its colour", "[mesh-values]") {
  for (const ValuePlace place : {ValuePlace::faces, ValuePlace::vertices}) {
    INFO(name_of(place));
    const MeshValues values = sample(place);
    const std::string file = written(values, ".glb").bytes;
    REQUIRE(file.substr(0, 4) == "glTF");
    CHECK(at<std::uint32_t>(file, 8) == file.size());
    const auto json_bytes = at<std::uint32_t>(file, 12);
    const json document = json::parse(file.substr(20, json_bytes));
    const std::string buffer = file.substr(20 + json_bytes + 8);
    const json& primitive = document["meshes"][0]["primitives"][0];
    const auto accessor = [&](const json& id) { return document["accessors"][id.get<std::size_t>()]; };
    const auto bytes = [&](const json& a) {
      return buffer.substr(
          document["bufferViews"][a["bufferView"].get<std::size_t>()].value("byteOffset", std::size_t{0}));
    };
    const json colours = accessor(primitive["attributes"]["COLOR_0"]),
               positions = accessor(primitive["attributes"]["POSITION"]),
               normals = accessor(primitive["attributes"]["NORMAL"]),
               slopes = accessor(primitive["attributes"]["_SLOPE"]);
    const std::size_t shown = place == ValuePlace::faces ? 3 * values.faces.size() : values.vertices.size();
    for (const json& a : {colours, positions, normals, slopes}) CHECK(a["count"] == shown);
    CHECK((colours["type"] == "VEC4" && colours["componentType"] == 5123 && colours["normalized"] == true));
    const std::string p = bytes(positions), n = bytes(normals), c = bytes(colours), s = bytes(slopes);
    const auto range = colour_range(values.columns[3].values);
    for (std::size_t i = 0; i < shown; ++i) {
      const std::size_t of = place == ValuePlace::faces ? i / 3 : i;
      const Vec3& vertex = values.vertices[place == ValuePlace::faces ? values.faces[of][i % 3] : i];
      for (std::size_t k = 0; k < 3; ++k) CHECK(at<float>(p, 12 * i + 4 * k) == float(vertex[int(k)]));
      CHECK(at<float>(s, 4 * i) == float(values.columns[3].values[of]));
      const auto srgb = viridis_colour(range.place(values.columns[3].values[of]));
      for (std::size_t k = 0; k < 3; ++k)
        CHECK(at<std::uint16_t>(c, 8 * i + 2 * k) / 65535.0 ==
              Approx(std::pow((srgb[k] + 0.055) / 1.055, 2.4)).margin(2e-3));
      CHECK(at<std::uint16_t>(c, 8 * i + 6) == 65535);
    }
    if (place == ValuePlace::faces)
      for (std::size_t f = 0; f < values.faces.size(); ++f) {
        const auto& corner = values.faces[f];
        const Vec3 normal = (values.vertices[corner[1]] - values.vertices[corner[0]])
                                .cross(values.vertices[corner[2]] - values.vertices[corner[0]])
                                .normalized();
        for (std::size_t k = 0; k < 9; ++k)
          CHECK(at<float>(n, 36 * f + 4 * k) == Approx(normal[int(k % 3)]).margin(1e-6));
      }
    CHECK(document["materials"][0]["pbrMetallicRoughness"].value("baseColorFactor", json{1, 1, 1, 1}) ==
          json{1, 1, 1, 1});
    CHECK(document["asset"]["extras"]["colours"].get<std::string>().starts_with("colours: slope from "));
  }
}

TEST_CASE("a CSV file begins with the names alone, and says in JSON beside it what they are", "[mesh-values]") {
  for (const ValuePlace place : all_places) {
    const MeshValues values = sample(place);
    const Written file = written(values, ".csv");
    std::istringstream lines(file.bytes);
    std::string line;
    std::getline(lines, line);
    CHECK(line == "id,x,y,z,potential,g_x,g_y,g_z,g,slope");
    std::size_t row = 0;
    for (; std::getline(lines, line); ++row) {
      std::vector<double> numbers;
      std::istringstream words(line);
      for (std::string word; std::getline(words, word, ',');) numbers.push_back(std::strtod(word.c_str(), nullptr));
      const Vec3& p = values.places[row];
      const auto& g = values.columns[1].values;
      CHECK(numbers == std::vector<double>{double(row), p.x(), p.y(), p.z(), values.columns[0].values[row], g[3 * row],
                                           g[3 * row + 1], g[3 * row + 2], values.columns[2].values[row],
                                           values.columns[3].values[row]});
    }
    CHECK(row == values.places.size());
    CHECK(file.bytes.find('#') == std::string::npos);
    const json about = json::parse(file.beside);
    CHECK(about["schema"] == "cowgpu.values.v1");
    CHECK(about["table"] == "x.csv");
    CHECK(about["place"] == name_of(place));
    CHECK(about["rows"] == row);
    REQUIRE(about["columns"].size() == 10);
    CHECK(about["columns"][9] == json({{"name", "slope"}, {"unit", "deg"}, {"meaning", "angle < 90 & more"}}));
    CHECK(about["columns"][6]["name"] == "g_y");
    CHECK(about["facts"]["density"] == "2670 kg/m^3");
    CHECK(about["notes"].size() == 2);
  }
}

TEST_CASE("a netCDF file has units, names and the mesh", "[mesh-values]") {
  for (const ValuePlace place : all_places) {
    const MeshValues values = sample(place);
    const NetcdfFile file = parse_netcdf(written(values, ".nc").bytes, "x.nc");
    const auto numbers = [&](const std::string& name) {
      const NetcdfVariable* variable = file.variable(name);
      REQUIRE(variable != nullptr);
      return variable->values;
    };
    CHECK(numbers("slope") == values.columns[3].values);
    CHECK(numbers("g") == values.columns[2].values);
    for (std::size_t c = 0; c < 3; ++c)
      CHECK(numbers(fmt::format("g_{}", "xyz"[c])) == component(values.columns[1], c));
    const auto& slope = file.variable("slope")->attributes;
    CHECK(attribute(slope, "units")->text == "deg");
    CHECK(attribute(slope, "long_name")->text == "angle < 90 & more");
    for (std::size_t i = 0; i < values.places.size(); ++i) CHECK(numbers("y")[i] == values.places[i].y());
    CHECK((file.variable("face_nodes") != nullptr) == (place != ValuePlace::points));
    if (place == ValuePlace::points) continue;
    CHECK(attribute(slope, "location")->text == (place == ValuePlace::faces ? "face" : "node"));
    const auto corners = numbers("face_nodes");
    for (std::size_t k = 0; k < corners.size(); ++k) CHECK(corners[k] == values.faces[k / 3][k % 3]);
    CHECK(numbers("mesh_z").back() == values.vertices.back().z());
  }
}

TEST_CASE("values that are none are none in files too, and grey", "[mesh-values]") {
  MeshValues values = sample(ValuePlace::vertices);
  values.columns[3].values[5] = std::numeric_limits<double>::quiet_NaN();
  CHECK(std::isnan(doubles(vtp_arrays(written(values, ".vtp").bytes).at("PointData/slope").bytes)[5]));
  CHECK(std::isnan(parse_netcdf(written(values, ".nc").bytes, "x").variable("slope")->values[5]));
  CHECK(written(values, ".csv").bytes.find(",nan\n") != std::string::npos);
  const std::string ply = written(values, ".ply").bytes;
  CHECK(ply.substr(ply.find("end_header\n") + 11 + 5 * 75 + 72, 3) == "\x8c\x8c\x8c");
  CHECK(written(values, ".glb").bytes.find("_SLOPE") == std::string::npos);
}

TEST_CASE("values that do not fit their mesh, and names that files cannot have, are refused", "[mesh-values]") {
  const auto refused = [](void (*change)(MeshValues&), const char* suffix = ".csv") {
    MeshValues values = sample(ValuePlace::faces);
    change(values);
    return outcome_of([&] { written(values, suffix); });
  };
  CHECK(refused([](MeshValues&) {}).fault == "none");
  CHECK(refused([](MeshValues& v) { v.places.pop_back(); }).fault == "bad-argument");
  CHECK(refused([](MeshValues& v) { v.columns[1].values.pop_back(); }).says("for 80 faces"));
  CHECK(refused([](MeshValues& v) { v.columns[0].name = "x"; }).says("'x' is taken"));
  CHECK(refused([](MeshValues& v) { v.columns[0].name = "a,b"; }).says("cannot name"));
  CHECK(refused([](MeshValues& v) { v.columns[0].name = "g_x"; }).says("'g_x' is taken"));
  CHECK(refused([](MeshValues& v) { v.columns[1].components = 2; }).says("has 2 components"));
  CHECK(refused([](MeshValues& v) { v.faces[3][1] = 99; }).fault == "mesh-index-range");
  CHECK(refused([](MeshValues& v) { v.vertices[3].x() = HUGE_VAL; }).fault == "mesh-not-finite");
  CHECK(refused([](MeshValues& v) { v = sample(ValuePlace::points), v.vertices.clear(), v.places.clear(); }).fault ==
        "mesh-empty");
  CHECK(refused([](MeshValues& v) { v = sample(ValuePlace::points); }, ".glb").says("points without faces"));
  CHECK(refused([](MeshValues&) {}, ".vtk").says("must end in .vtp"));
  const MeshValues values = sample(ValuePlace::faces);
  CHECK(outcome_of([&] { written(values, ".ply", "tilt"); }).says("there are potential, g, g, slope"));
  CHECK(shown_column(values, "g").components == 1);
  CHECK(shown_column(values, "").name == "slope");
}

TEST_CASE("writing values takes no more memory than is said before", "[mesh-values]") {
  if (!memory_is_measurable()) return;
  for (const ValuePlace place : {ValuePlace::faces, ValuePlace::vertices}) {
    const MeshValues values = sample(place, 6); // 81,920 faces
    const TemporaryFolder folder;
    for (const char* suffix : {".vtp", ".ply", ".glb", ".csv", ".nc"}) {
      const std::string path = folder / ("x" + std::string(suffix));
      const std::size_t growth = peak_growth([&] { write_mesh_values(path, values); });
      const std::uint64_t said =
          mesh_values_file_memory(mesh_values_format(path), place, values.vertices.size(), values.faces.size(), 6);
      INFO(suffix << ": " << growth << " of " << said);
      CHECK(growth <= said);
    }
  }
}

TEST_CASE("colours span all but one value in two hundred at each end", "[mesh-values]") {
  std::vector<double> values;
  for (int i = 0; i < 1000; ++i) values.push_back(double((i * 377) % 1000));
  values.push_back(std::numeric_limits<double>::quiet_NaN());
  values[0] = -1e9;
  const ColourRange range = colour_range(values);
  CHECK((range.low == 5 && range.high == 994));
  CHECK((range.place(-3) == 0 && range.place(2000) == 1));
  CHECK(range.place(499.5) == Approx(0.5));
  CHECK(std::isnan(range.place(values.back())));
  CHECK((colour_range({}).low == 0 && ColourRange{2, 2}.place(2) == 0.5));
}
