#include "host/report/page.hpp"

#include "host/coefficient_set.hpp"
#include "host/colour_scale.hpp"
#include "host/error.hpp"
#include "host/io/document_json.hpp"
#include "host/io/file.hpp"
#include "host/io/result_json.hpp"
#include "host/report/document_parts.hpp"
#include "host/report/order_names.hpp"
#include "host/spectrum/power.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace cowgpu {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "arrays are copied as they lie in memory");

// What the page's template has where these go (host/report/page/index.html).
constexpr std::string_view title_place = "<!--cowgpu:title-->", data_place = "{\"cowgpu\":\"data\"}";
constexpr int largest_mass_degree = 128; // last degree in the table; the spectrum has all

std::string base64(const void* data, std::size_t bytes) {
  constexpr const char* letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto* in = static_cast<const unsigned char*>(data);
  std::string text;
  text.reserve((bytes + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes; i += 3) {
    const std::size_t there = std::min<std::size_t>(3, bytes - i);
    const unsigned three =
        unsigned(in[i]) << 16 | (there > 1 ? unsigned(in[i + 1]) << 8 : 0U) | (there > 2 ? unsigned(in[i + 2]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= there ? letters[three >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

template <class Number>
std::string base64(const std::vector<Number>& numbers) {
  return base64(numbers.data(), numbers.size() * sizeof(Number));
}

/// Degrees 0 to `order`, by field, m, l, as re, im.
std::string coefficients_text(const SphereCoefficients& all, int order) {
  std::vector<double> numbers;
  for (int f = 0; f < all.fields; ++f)
    for (int m = 0; m <= order; ++m)
      for (int l = m; l <= order; ++l) {
        numbers.push_back(all.at(f, l, m).real());
        numbers.push_back(all.at(f, l, m).imag());
      }
  return base64(numbers);
}

ordered_json powers(const SphereCoefficients& all) {
  ordered_json by_field = ordered_json::array();
  for (int f = 0; f < all.fields; ++f) by_field.push_back(power(all, f));
  return by_field;
}

/// An expansion's members but its coefficients.
json about(const json& expansion) {
  json copy = json::object();
  for (const auto& [key, value] : expansion.items())
    if (key != "coefficients") copy[key] = value;
  return copy;
}

ordered_json distances_json(const std::vector<PageDistances>& orders) {
  ordered_json all = ordered_json::array();
  for (const PageDistances& order : orders)
    all.push_back({{"largest", order.largest}, {"rms", order.rms}, {"roots", base64(order.roots)}});
  return all;
}

ordered_json surface_json(const PageSurface& surface, const json& expansions) {
  const SurfaceExpansion& e = *surface.expansion;
  return {{"name", surface.name},
          {"order", surface.order},
          {"lmax", e.coefficients.lmax},
          {"origin", {e.origin.x(), e.origin.y(), e.origin.z()}},
          {"means", {e.mean_dtheta, e.mean_dphi}},
          {"signed_dphi", e.signed_dphi},
          {"radius", spherical_radius(e)},
          {"about", about(expansions.at(surface.name))},
          {"power", powers(e.coefficients)},
          {"coefficients", coefficients_text(e.coefficients, surface.order)},
          {"distances",
           {{"xyz", distances_json(surface.distances[std::size_t(SurfaceFields::xyz)])},
            {"f", distances_json(surface.distances[std::size_t(SurfaceFields::f)])}}}};
}

ordered_json mass_json(const std::string& name, const json& mass) {
  const SphereCoefficients all = result_json::coefficients(name, mass, 1, 4096);
  const int order = std::min(all.lmax, largest_mass_degree);
  return {{"order", order},
          {"lmax", all.lmax},
          {"about", about(mass)},
          {"power", powers(all)},
          {"coefficients", coefficients_text(all, order)}};
}

ordered_json mesh_json(const PageDocument& document) {
  if (document.mesh_name.empty()) return nullptr;
  std::vector<float> places;
  for (const Vec3& v : document.vertices)
    for (int c = 0; c < 3; ++c) places.push_back(float(v[c]));
  std::vector<std::uint32_t> corners;
  for (const Face& face : document.faces) corners.insert(corners.end(), face.begin(), face.end());
  return {{"name", document.mesh_name}, {"vertices", base64(places)}, {"faces", base64(corners)}};
}

ordered_json values_json(const MeshValues* values) {
  if (!values) return nullptr;
  ordered_json columns = ordered_json::array();
  for (const ValueColumn& column : values->columns) {
    const ColourRange range = colour_range(numbers_of(column));
    columns.push_back({{"name", column.name},
                       {"unit", column.unit},
                       {"meaning", column.meaning},
                       {"components", column.components},
                       {"range", {range.low, range.high}},
                       {"values", base64(std::vector<float>(column.values.begin(), column.values.end()))}});
  }
  std::vector<float> places;
  for (const Vec3& place : values->places)
    for (int c = 0; c < 3; ++c) places.push_back(float(place[c]));
  return {{"place", name_of(values->place)},         {"length_unit", values->length_unit},
          {"shown", shown_column(*values, "").name}, {"places", base64(places)},
          {"columns", std::move(columns)},           {"notes", values->notes}};
}

/// JSON, whose '<', '>' and '&' stand in strings only, without them.
void append_escaped(std::string& to, std::string_view text) {
  for (const char c : text)
    if (c == '<' || c == '>' || c == '&')
      to += fmt::format("\\u{:04x}", unsigned(c));
    else
      to += c;
}

std::string html_text(const std::string& text) {
  std::string safe;
  for (const char c : text) switch (c) {
    case '&': safe += "&amp;"; break;
    case '<': safe += "&lt;"; break;
    case '>': safe += "&gt;"; break;
    case '"': safe += "&quot;"; break;
    default: safe += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
  return safe;
}

std::string compact(const ordered_json& value) {
  return value.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

} // namespace

PageDistances page_distances(const SphereGrid& grid, std::span<const double> distances) {
  PageDistances found;
  for (const double d : distances) found.largest = std::max(found.largest, d);
  const std::size_t length = std::size_t(grid.ring_length), last = distances.size() - 1;
  double squares = 0, weights = 0;
  for (std::size_t i = 0; i <= last; ++i) {
    const std::size_t ring = i == 0 ? 0 : i == last ? std::size_t(grid.rings) - 1 : 1 + (i - 1) / length;
    const double weight = grid.weights[ring] / (i == 0 || i == last ? 1 : double(length));
    squares += weight * distances[i] * distances[i];
    weights += weight;
    const double part = found.largest > 0 ? std::sqrt(distances[i] / found.largest) : 0;
    found.roots.push_back(std::uint8_t(std::lround(255 * part)));
  }
  found.rms = std::sqrt(squares / weights);
  return found;
}

int page_resolution(int order) {
  return std::clamp(2 * order, 64, 128);
}

std::vector<fs::path> page_folders() {
  std::vector<fs::path> folders;
  if (const char* given = std::getenv("COWGPU_PAGE"); given && *given) return {given};
  std::error_code failed;
  const auto program = fs::read_symlink("/proc/self/exe", failed);
  if (failed) return folders;
  folders.push_back(program.parent_path().parent_path() / "share" / "cowgpu" / "page");
  folders.push_back(program.parent_path().parent_path() / "page");
  return folders;
}

std::string read_page() {
  std::string looked;
  for (const fs::path& folder : page_folders()) {
    const fs::path path = folder / "report.html";
    looked += (looked.empty() ? "" : ", ") + path.string();
    std::error_code none;
    if (!fs::is_regular_file(path, none)) continue;
    std::string page = read_file(path);
    if (page.find(title_place) == page.npos || page.find(data_place) == page.npos)
      throw Error(Fault::file_format, fmt::format("{}: this is not the page of cowgpu's reports, which has a place for "
                                                  "title and data; build it again: `cmake --build DIR --target page`",
                                                  path.string()));
    return page;
  }
  throw Error(
      Fault::page_missing,
      fmt::format("the page of reports is not built: it was looked for at {}. `./cowgpu report` in a clone builds "
                  "it, and so does `cmake --build DIR --target page`, with node and npm; COWGPU_PAGE names a "
                  "folder that has it",
                  looked));
}

std::string page_data(const PageDocument& document) {
  const json& result = *document.result;
  const std::string name = "the result";
  const json& expansions = result_json::member(name, result, "expansions");
  ordered_json head = ordered_json::parse(json_text(opening("cowgpu.page.v1", document.command)));
  head["notes"] = document.notes;
  head["grid"] = {{"rings", document.grid.rings}, {"ring_length", document.grid.ring_length}};
  json rest = json::object();
  for (const auto& [key, value] : result.items())
    if (key != "expansions") rest[key] = value;
  head["result"] = rest;
  int order = 0;
  head["surfaces"] = ordered_json::array();
  for (const PageSurface& surface : document.surfaces) {
    head["surfaces"].push_back(surface_json(surface, expansions));
    order = std::max(order, surface.order);
  }
  head["mass"] =
      expansions.contains(mass_expansion) ? mass_json(name, expansions.at(mass_expansion)) : ordered_json(nullptr);
  head["mesh"] = mesh_json(document);
  head["values"] = values_json(document.values);
  head["order_names"] = ordered_json::array();
  for (int l = 0; l <= order; ++l) head["order_names"].push_back(order_name(l));
  std::string text;
  append_escaped(text, compact(head));
  text.back() = ','; // was the brace
  text += "\"physics\":[";
  for (std::size_t i = 0; i < document.physics.size(); ++i) {
    if (i > 0) text += ',';
    append_escaped(text, compact(document.physics[i]));
  }
  return text + "]}";
}

void write_page(const std::string& page, const PageDocument& document, AtomicFile& file) {
  std::string title = "cowgpu report";
  const json& result = *document.result;
  if (result.contains("mesh") && result["mesh"].contains("name") && result["mesh"]["name"].is_string())
    title = compact(result["mesh"]["name"]); // which mends what is no UTF-8
  if (title.size() > 1 && title.front() == '"') title = json::parse(title).get<std::string>() + " - cowgpu";
  const std::size_t at = page.find(title_place), data = page.find(data_place);
  file.write(std::string_view(page).substr(0, at));
  file.write(html_text(title));
  file.write(std::string_view(page).substr(at + title_place.size(), data - at - title_place.size()));
  file.write(page_data(document));
  file.write(std::string_view(page).substr(data + data_place.size()));
}

} // namespace cowgpu
