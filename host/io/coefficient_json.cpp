#include "host/error.hpp"
#include "host/io/coefficient_file.hpp"
#include "host/io/coefficient_formats.hpp"
#include "host/io/coefficient_metadata.hpp"
#include "host/io/document_json.hpp"
#include "host/io/number.hpp"
#include "host/io/result_json.hpp"
#include "host/io/shown.hpp"
#include "host/sphere_transform.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>

namespace cowgpu {
namespace {

using nlohmann::json;

// Members of the document's top that are numbers, and those of its provenance.
constexpr std::array number_words = {"reference_radius", "brillouin_radius",       "density", "mass",
                                     "second_moment",    "gravitational_constant", "gm"};
constexpr std::array provenance_words = {"program", "created", "command", "mesh", "mesh_sha256", "history"};
constexpr std::array text_words = {"kind", "form", "normalisation", "phase", "length_unit", "mass_unit"};

std::string number_text(double value) {
  std::string text;
  append_number(text, value);
  return text;
}

std::string text_of(const std::string& name, const json& value, const char* key) {
  if (!value.is_string()) throw Error(Fault::file_syntax, fmt::format("{}: the member '{}' must be a text", name, key));
  return one_line(value.get<std::string>());
}

std::vector<std::string> words_of(const std::string& name, const json& value, const char* key) {
  if (!value.is_array()) throw Error(Fault::file_syntax, fmt::format("{}: the member '{}' must be a list", name, key));
  std::vector<std::string> words;
  for (const json& word : value) words.push_back(text_of(name, word, key));
  return words;
}

// [x, y, z] as the text of a comment line.
MetadataText origin_text(const std::string& name, const json& object) {
  const json& value = object.at("origin");
  if (!value.is_array() || value.size() != 3 ||
      !std::all_of(value.begin(), value.end(), [](const json& c) { return c.is_number(); }))
    throw Error(Fault::file_syntax, fmt::format("{}: the member 'origin' is not three numbers", name));
  std::string text;
  if (object.contains("origin_kind")) text = "(" + text_of(name, object.at("origin_kind"), "origin_kind") + ")";
  for (const json& c : value) text += " " + number_text(c.get<double>());
  return {text, 0};
}

Metadata metadata_in(const std::string& name, const json& all) {
  Metadata metadata;
  const auto take = [&](const json& object, const char* key) {
    if (object.contains(key)) metadata[key] = {text_of(name, object.at(key), key), 0};
  };
  for (const char* key : text_words) take(all, key);
  for (const char* key : number_words)
    if (all.contains(key)) metadata[key] = {number_text(result_json::number(name, all, key)), 0};
  if (all.contains("origin")) metadata["origin"] = origin_text(name, all);
  if (all.contains("provenance")) {
    const json& provenance = all.at("provenance");
    if (!provenance.is_object())
      throw Error(Fault::file_syntax, fmt::format("{}: the member 'provenance' must be an object", name));
    for (const char* key : provenance_words) take(provenance, key);
  }
  if (all.contains("remarks")) {
    const json& remarks = all.at("remarks");
    if (!remarks.is_object())
      throw Error(Fault::file_syntax, fmt::format("{}: the member 'remarks' must be an object", name));
    for (const auto& [key, value] : remarks.items()) metadata["remark." + key] = {text_of(name, value, "remarks"), 0};
  }
  return metadata;
}

void take_values(const SphereCoefficients& a, CoefficientSet& set) {
  set.lmax = a.lmax;
  set.fields = a.fields;
  set.first.reserve(a.values.size());
  set.second.reserve(a.values.size());
  for (const std::complex<double>& value : a.values) {
    set.first.push_back(value.real());
    set.second.push_back(value.imag());
  }
}

int field_count(const std::string& name, std::size_t fields) {
  if (fields < 1 || fields > std::size_t(most_fields))
    throw Error(Fault::file_format,
                fmt::format("{}: the file has {} fields; 1 to {} are possible", name, fields, most_fields));
  return int(fields);
}

CoefficientSet read_own(const std::string& name, const json& all) {
  CoefficientSet set;
  set.names = words_of(name, result_json::member(name, all, "fields"), "fields");
  take_values(result_json::rows(name, all, field_count(name, set.names.size()), largest_file_degree), set);
  set.units.resize(set.names.size());
  if (all.contains("units")) set.units = words_of(name, all.at("units"), "units");
  if (set.units.size() != set.names.size())
    throw Error(Fault::file_syntax, fmt::format("{}: the members 'fields' and 'units' differ in length", name));
  for (const char* key : {"kind", "form"}) result_json::member(name, all, key);
  if (!take_metadata(metadata_in(name, all), name, set))
    throw Error(Fault::file_format, fmt::format("{}: no members 'normalisation' and 'phase'", name));
  return set;
}

// The trace of tensors.second_moment, where that is about the same point.
std::optional<double> second_moment_in(const std::string& name, const json& all, const json& expansion) {
  if (!all.contains("tensors") || !all.at("tensors").is_object() || !all.at("tensors").contains("second_moment"))
    return std::nullopt;
  const json& tensors = all.at("tensors");
  if (tensors.contains("origin") && expansion.contains("origin") && tensors.at("origin") != expansion.at("origin"))
    return std::nullopt;
  const json& rows = tensors.at("second_moment");
  double trace = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!rows.is_array() || rows.size() != 3 || !rows[i].is_array() || rows[i].size() != 3 || !rows[i][i].is_number())
      throw Error(Fault::file_syntax,
                  fmt::format("{}: the member 'tensors.second_moment' is not three rows of three numbers", name));
    trace += rows[i][i].get<double>();
  }
  return trace;
}

// An expansion in the result of `cowgpu expand`.
CoefficientSet read_result(const std::string& name, const json& all, const std::string& of) {
  const json& expansion = result_json::expansion(name, all, of);
  CoefficientSet set;
  const bool mass = !expansion.contains("fields");
  set.form = Form::complex;
  set.names = mass ? std::vector<std::string>{mass_expansion}
                   : words_of(name, result_json::member(name, expansion, "fields"), "fields");
  take_values(result_json::coefficients(name, expansion, field_count(name, set.names.size()), largest_file_degree),
              set);
  set.units.resize(set.names.size());
  Metadata metadata;
  if (expansion.contains("origin")) metadata["origin"] = origin_text(name, expansion);
  const bool metric = all.contains("mesh") && result_json::placement(name, all).units.stated;
  set.length_unit = metric ? "m" : mesh_length_unit;
  if (mass) {
    set.kind = CoefficientKind::multipoles;
    set.mass_unit = metric ? "kg" : mesh_mass_unit;
    metadata["reference_radius"] = {number_text(result_json::number(name, expansion, "reference_radius")), 0};
    // Files that lack it refer their moments to that sphere.
    const bool stated = expansion.contains("brillouin_radius");
    metadata["brillouin_radius"] = {
        number_text(result_json::number(name, expansion, stated ? "brillouin_radius" : "reference_radius")), 0};
    if (expansion.contains("density"))
      metadata["density"] = {number_text(result_json::number(name, expansion, "density")), 0};
    set.second_moment = second_moment_in(name, all, expansion);
  } else {
    for (std::size_t f = 0; f < set.names.size(); ++f)
      set.units[f] = set.names[f] == "f_dtheta" || set.names[f] == "f_dphi" ? "radian" : "length";
    if (expansion.contains("removed_means") && expansion.at("removed_means").is_object())
      for (const auto& [key, value] : expansion.at("removed_means").items())
        if (value.is_number()) set.remarks.emplace_back("removed_mean_" + key, number_text(value.get<double>()));
  }
  take_metadata(metadata, name, set);
  // Provenance is told where it is there; nothing depends on it.
  const auto text = [](const json& object, const char* key) {
    return object.is_object() && object.contains(key) && object.at(key).is_string()
               ? one_line(object.at(key).get<std::string>())
               : std::string();
  };
  set.provenance.created = text(all, "created");
  if (all.contains("mesh")) {
    set.provenance.mesh = text(all.at("mesh"), "name");
    set.provenance.mesh_sha256 = text(all.at("mesh"), "sha256");
  }
  if (all.contains("program")) set.provenance.program = "cowgpu " + text(all.at("program"), "version");
  if (all.contains("command") && all.at("command").is_array())
    for (const json& word : all.at("command"))
      if (word.is_string())
        set.provenance.command += (set.provenance.command.empty() ? "" : " ") + one_line(word.get<std::string>());
  return set;
}

} // namespace

std::string expansion_note(std::string_view reference_radius) {
  return fmt::format("these are mass moments Q_lm / R^l with R = {}", shown(reference_radius));
}

CoefficientSet parse_json_coefficients(const std::string& bytes, const std::string& name, const std::string& of) {
  const json all = result_json::parse(name, bytes);
  const json& schema = result_json::member(name, all, "schema");
  if (schema == "cowgpu.result.v1") return read_result(name, all, of);
  if (schema != "cowgpu.coefficients.v1")
    throw Error(Fault::file_format,
                fmt::format("{}: this JSON is neither cowgpu.result.v1 nor cowgpu.coefficients.v1; take a file that "
                            "`cowgpu expand -o FILE.json` or `cowgpu convert` wrote",
                            name));
  if (!of.empty())
    throw Error(Fault::bad_argument,
                fmt::format("--of {}: {} holds no expansions to choose from; the .json and .csv of "
                            "`cowgpu expand` do",
                            of, name));
  return read_own(name, all);
}

void write_json_coefficients(const CoefficientSet& set, AtomicFile& file) {
  Object all = {{"schema", "cowgpu.coefficients.v1"},
                {"program", program()},
                {"kind", name(set.kind)},
                {"form", name(set.form)},
                {"lmax", set.lmax},
                {"fields", set.names},
                {"units", set.units}};
  Object provenance, remarks;
  const auto among = [](const auto& words, const std::string& key) {
    return std::find(words.begin(), words.end(), key) != words.end();
  };
  for (const auto& [key, text] : metadata_of(set)) {
    if (among(provenance_words, key)) provenance.add(key, text);
    if (key.starts_with("remark.")) remarks.add(key.substr(7), text);
    if ((among(text_words, key) && key != "kind" && key != "form") || key == "coefficients_of") all.add(key, text);
  }
  const std::array<std::optional<double>, 7> numbers = {
      set.reference_radius, set.brillouin_radius,       set.density, set.mass,
      set.second_moment,    set.gravitational_constant, set.gm};
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i]) all.add(number_words[i], *numbers[i]);
  if (set.origin) {
    all.add("origin", *set.origin);
    if (!set.origin_kind.empty()) all.add("origin_kind", set.origin_kind);
  }
  if (!provenance.members.empty()) all.add("provenance", std::move(provenance));
  if (!remarks.members.empty()) all.add("remarks", std::move(remarks));
  all.add("coefficients", CoefficientRows{set.lmax, [&set](int l, int m, Numbers& row) {
                                            for (int f = 0; f < set.fields; ++f) {
                                              row.push_back(set.first[set.index(f, l, m)]);
                                              row.push_back(set.second[set.index(f, l, m)]);
                                            }
                                          }});
  write_json(all, [&](std::string_view text) { file.write(text); });
}

} // namespace cowgpu
