// VTK XML PolyData. The file is text up to one element, whose content are the arrays as they lie in memory, each behind its
// length in bytes; the text says where each begins.
#include "host/error.hpp"
#include "host/io/mesh_values_formats.hpp"
#include "host/io/shown.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <functional>

namespace cowgpu::mesh_values_file {
namespace {

static_assert(std::endian::native == std::endian::little, "the writer copies memory");

constexpr std::uint64_t most_int32 = 0x7fffffff;

std::string escaped(std::string_view text) {
  std::string safe;
  for (const char c : one_line(text)) switch (c) {
    case '&': safe += "&amp;"; break;
    case '<': safe += "&lt;"; break;
    case '>': safe += "&gt;"; break;
    case '"': safe += "&quot;"; break;
    default: safe += c;
    }
  return safe;
}

struct Array {
  std::string name, type, unit;
  int components = 1;
  std::uint64_t bytes = 0;
  std::function<void(Pieces&)> put;
};

Array of_points(const std::string& name, const std::string& unit, const std::vector<Vec3>& points) {
  return {name, "Float64", unit, 3, 24 * points.size(), [&points](Pieces& out) {
            for (const Vec3& p : points) out.add(p), out.more();
          }};
}

Array of_column(const MeshValues& values, const ValueColumn& column) {
  const bool shared = std::count_if(values.columns.begin(), values.columns.end(),
                                    [&](const ValueColumn& other) { return other.name == column.name; }) > 1;
  return {column.components == 3 && shared ? column.name + "_vector" : column.name,
          "Float64",
          column.unit,
          column.components,
          8 * column.values.size(),
          [&column](Pieces& out) {
            for (const double v : column.values) out.add(v), out.more();
          }};
}

/// Whole numbers, of `width` bytes, the i-th by `number`.
template <class Number>
Array of_integers(const std::string& name, std::size_t count, bool wide, Number number) {
  return {name, wide ? "Int64" : "Int32", "", 1, count * (wide ? 8 : 4), [=](Pieces& out) {
            for (std::size_t i = 0; i < count; ++i) {
              if (wide)
                out.add(std::int64_t(number(i)));
              else
                out.add(std::int32_t(number(i)));
              out.more();
            }
          }};
}

class Document {
public:
  explicit Document(const Job& job) : job_(job), values_(job.values) {}

  void write() {
    head();
    Pieces out(job_);
    out.bytes() = text_ + "  <AppendedData encoding=\"raw\">\n_";
    for (const Array& array : arrays_) {
      out.add(array.bytes);
      array.put(out);
    }
    out.bytes() += "\n  </AppendedData>\n</VTKFile>\n";
    out.end();
  }

private:
  void head() {
    const std::size_t points = values_.vertices.size(), faces = values_.faces.size();
    const bool of_points = values_.place == ValuePlace::points, wide = std::max(points, 3 * faces) > most_int32;
    text_ = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
            "byte_order=\"LittleEndian\" "
            "header_type=\"UInt64\">\n  <PolyData>\n";
    field_data();
    text_ +=
        fmt::format("    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
                    "NumberOfPolys=\"{}\">\n",
                    points, of_points ? points : 0, faces);
    data("PointData", values_.place != ValuePlace::faces);
    data("CellData", values_.place == ValuePlace::faces);
    begin("Points");
    add(mesh_values_file::of_points("Points", values_.length_unit, values_.vertices));
    end("Points");
    begin("Verts");
    add(of_integers("connectivity", of_points ? points : 0, wide, [](std::size_t i) { return i; }));
    add(of_integers("offsets", of_points ? points : 0, wide, [](std::size_t i) { return i + 1; }));
    end("Verts");
    begin("Polys");
    add(of_integers("connectivity", 3 * faces, wide, [&f = values_.faces](std::size_t i) { return f[i / 3][i % 3]; }));
    add(of_integers("offsets", faces, wide, [](std::size_t i) { return 3 * i + 3; }));
    end("Polys");
    text_ += "    </Piece>\n  </PolyData>\n";
  }

  /// Texts go in as the codes of their bytes, each text with a zero behind it.
  void field_data() {
    begin("FieldData");
    std::vector<std::string> lines = sentences(values_);
    text_ += fmt::format("        <Array type=\"String\" Name=\"about\" NumberOfTuples=\"{}\" format=\"ascii\">\n",
                         lines.size());
    for (const std::string& line : lines) {
      text_ += "         ";
      for (const char c : line) text_ += fmt::format(" {}", unsigned(static_cast<unsigned char>(c)));
      text_ += " 0\n";
    }
    text_ += "        </Array>\n";
    end("FieldData");
  }

  void data(const char* element, bool here) {
    std::string first;
    if (here && !values_.columns.empty())
      if (const ValueColumn& shown = shown_column(values_, job_.colour); shown.components == 1)
        first = fmt::format(" Scalars=\"{}\"", escaped(shown.name));
    begin(element + first);
    if (here) {
      // The faces' middles, or vertices some height above the mesh's.
      if (values_.place == ValuePlace::faces || values_.places != values_.vertices)
        add(mesh_values_file::of_points("place", values_.length_unit, values_.places));
      for (const ValueColumn& column : values_.columns) add(of_column(values_, column));
    }
    end(element);
  }

  void begin(const std::string& element) { text_ += fmt::format("      <{}>\n", element); }
  void end(const char* element) { text_ += fmt::format("      </{}>\n", element); }

  void add(Array array) {
    text_ += fmt::format(
        "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"",
        array.type, escaped(array.name), array.components, offset_);
    if (array.unit.empty())
      text_ += "/>\n";
    else
      text_ += fmt::format(
          ">\n          <InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">{}</InformationKey>\n"
          "        </DataArray>\n",
          escaped(array.unit));
    offset_ += 8 + array.bytes;
    arrays_.push_back(std::move(array));
  }

  const Job& job_;
  const MeshValues& values_;
  std::string text_;
  std::uint64_t offset_ = 0;
  std::vector<Array> arrays_;
};

} // namespace

void write_vtp(const Job& job) {
  Document(job).write();
}

} // namespace cowgpu::mesh_values_file
