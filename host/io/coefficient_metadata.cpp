#include "host/io/coefficient_metadata.hpp"

#include "host/error.hpp"
#include "host/io/number.hpp"
#include "host/io/shown.hpp"
#include "host/number.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {
namespace {

std::string text_of(double value) {
  std::string text;
  append_number(text, value);
  return text;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") + 1 - first);
}

std::vector<std::string> split(std::string_view text) {
  std::vector<std::string> words;
  for (;;) {
    const auto comma = text.find(',');
    words.emplace_back(trimmed(text.substr(0, comma)));
    if (comma == std::string_view::npos) return words;
    text.remove_prefix(comma + 1);
  }
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) {
    if (&word != &words.front()) text += ",";
    for (const char c : word) text += c == ',' ? ';' : c;
  }
  return one_line(text);
}

bool any(const std::vector<std::string>& words) {
  return std::any_of(words.begin(), words.end(), [](const std::string& word) { return !word.empty(); });
}

// Texts of one file, read.
class Reader {
public:
  Reader(const Metadata& metadata, const std::string& file) : metadata_(metadata), file_(file) {}

  const MetadataText* find(const std::string& key) const {
    const auto found = metadata_.find(key);
    return found == metadata_.end() ? nullptr : &found->second;
  }
  void text(const std::string& key, std::string& into) const {
    if (const MetadataText* at = find(key)) into = one_line(at->text);
  }
  double number(const std::string& key, const MetadataText& at, std::string_view word) const {
    const auto value = read_number(word);
    if (!value) fail(at, fmt::format("{} is '{}', and must be a finite number", key, shown(word)));
    return *value;
  }
  void number(const std::string& key, std::optional<double>& into, bool positive) const {
    const MetadataText* at = find(key);
    if (!at) return;
    into = number(key, *at, at->text);
    if (positive && !(*into > 0)) fail(*at, fmt::format("{} is {}; it must be above 0", key, shown(at->text)));
  }
  template <class Value>
  bool word(const char* key, std::optional<Value> (*named)(std::string_view), const char* words, Value& into) const {
    const MetadataText* at = find(key);
    if (!at) return false;
    const auto value = named(at->text);
    if (!value) fail(*at, fmt::format("{} is '{}'; there are {}", key, shown(at->text), words));
    into = *value;
    return true;
  }
  void list(const char* key, std::vector<std::string>& into) const {
    const MetadataText* at = find(key);
    if (!at) return;
    std::vector<std::string> words = split(one_line(at->text));
    if (words.size() != into.size())
      fail(*at, fmt::format("{} names {} between commas; the file holds {} of them", key, words.size(), into.size()));
    into = std::move(words);
  }
  // "(kind) x y z" or "x y z".
  void origin(CoefficientSet& set) const {
    const MetadataText* at = find("origin");
    if (!at) return;
    std::string_view rest = at->text;
    if (rest.starts_with('(')) {
      const auto end = rest.find(')');
      set.origin_kind = one_line(rest.substr(1, end == std::string_view::npos ? end : end - 1));
      rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    }
    Vec3 origin;
    for (int c = 0; c < 3; ++c) {
      rest = trimmed(rest);
      const auto space = rest.find_first_of(" \t");
      origin[c] = number("origin", *at, rest.substr(0, space));
      rest.remove_prefix(space == std::string_view::npos ? rest.size() : space);
    }
    if (!trimmed(rest).empty()) fail(*at, "origin has more than three coordinates");
    set.origin = origin;
  }

private:
  [[noreturn]] void fail(const MetadataText& at, const std::string& sentence) const {
    throw Error(Fault::file_syntax, fmt::format("{}: {}", place(file_, at.line), sentence));
  }
  const Metadata& metadata_;
  const std::string& file_;
};

} // namespace

std::string place(const std::string& file, std::size_t line) {
  return line ? fmt::format("{}:{}", file, line) : file;
}

std::string coefficients_of(const CoefficientSet& set) {
  if (set.kind == CoefficientKind::potential) return "f = V R / GM on the sphere r = R, V the gravitational potential";
  if (set.kind == CoefficientKind::field) return "";
  const std::string field = "f = sum of conj(Q_lm) / R^l Y_lm on the unit sphere, Q_lm = integral of density r^l Y_lm";
  if (set.convention == Convention{})
    return set.form == Form::complex ? "conj of f: these are Q_lm / R^l; " + field : field;
  return (set.form == Form::complex ? "conj of " : "") + field +
         ", both Y_lm orthonormal with the Condon-Shortley phase: the same f as in any other convention, so these are "
         "no "
         "moments of density r^l with other Y_lm";
}

std::vector<std::pair<std::string, std::string>> metadata_of(const CoefficientSet& set) {
  std::vector<std::pair<std::string, std::string>> list;
  const auto add = [&](const char* key, const std::string& text) {
    if (!text.empty()) list.emplace_back(key, one_line(text));
  };
  const auto add_number = [&](const char* key, const std::optional<double>& value) {
    if (value) list.emplace_back(key, text_of(*value));
  };
  add("lmax", std::to_string(set.lmax));
  add("normalisation", std::string(name(set.convention.normalisation)));
  add("phase", std::string(name(set.convention.phase)));
  if (set.kind != CoefficientKind::field || set.form != Form::real) add("kind", std::string(name(set.kind)));
  if (set.form != Form::real) add("form", std::string(name(set.form)));
  add("coefficients_of", coefficients_of(set));
  add_number("reference_radius", set.reference_radius);
  add_number("brillouin_radius", set.brillouin_radius);
  if (set.origin) {
    std::string text = set.origin_kind.empty() ? "" : "(" + set.origin_kind + ") ";
    for (int c = 0; c < 3; ++c) text += (c ? " " : "") + text_of((*set.origin)[c]);
    add("origin", text);
  }
  add("length_unit", set.length_unit);
  add("mass_unit", set.mass_unit);
  add_number("density", set.density);
  add_number("mass", set.mass);
  add_number("second_moment", set.second_moment);
  add_number("gravitational_constant", set.gravitational_constant);
  add_number("gm", set.gm);
  if (any(set.names)) add("fields", joined(set.names));
  if (any(set.units)) add("units", joined(set.units));
  const Provenance& from = set.provenance;
  add("program", from.program);
  add("created", from.created);
  add("command", from.command);
  add("mesh", from.mesh);
  add("mesh_sha256", from.mesh_sha256);
  add("history", from.history);
  for (const auto& [word, text] : set.remarks) add(("remark." + word).c_str(), text);
  return list;
}

std::string comment_lines(const CoefficientSet& set, const std::vector<std::string_view>& elsewhere) {
  std::string lines;
  for (const auto& [key, text] : metadata_of(set))
    if (std::find(elsewhere.begin(), elsewhere.end(), key) == elsewhere.end())
      lines += fmt::format("# {} {}\n", key, text);
  return lines;
}

void take_comment(std::string_view line, std::size_t number, Metadata& metadata) {
  const std::string_view comment = trimmed(trimmed(line).substr(trimmed(line).starts_with('#')));
  const auto space = comment.find_first_of(" \t");
  constexpr std::size_t most_words = 4096; // far more than any file of ours has
  if (space == std::string_view::npos || metadata.size() >= most_words) return;
  metadata.try_emplace(std::string(comment.substr(0, space)),
                       MetadataText{std::string(trimmed(comment.substr(space))), number});
}

bool take_metadata(const Metadata& metadata, const std::string& file, CoefficientSet& set) {
  const Reader read(metadata, file);
  const bool normalisation = read.word("normalisation", normalisation_named,
                                       "orthonormal, 4pi, schmidt and unnormalised", set.convention.normalisation);
  const bool phase = read.word("phase", phase_named, "cs and none", set.convention.phase);
  read.word("kind", kind_named, "field, multipoles and potential", set.kind);
  read.word("form", form_named, "real and complex", set.form);
  read.number("reference_radius", set.reference_radius, true);
  read.number("brillouin_radius", set.brillouin_radius, true);
  read.origin(set);
  read.text("length_unit", set.length_unit);
  read.text("mass_unit", set.mass_unit);
  if (set.kind != CoefficientKind::field && !set.reference_radius)
    throw Error(Fault::file_syntax,
                fmt::format("{}: the file is of kind {} and says no reference_radius", file, name(set.kind)));
  read.number("density", set.density, false);
  read.number("mass", set.mass, false);
  read.number("second_moment", set.second_moment, false);
  read.number("gravitational_constant", set.gravitational_constant, true);
  read.number("gm", set.gm, false);
  read.list("fields", set.names);
  read.list("units", set.units);
  read.text("program", set.provenance.program);
  read.text("created", set.provenance.created);
  read.text("command", set.provenance.command);
  read.text("mesh", set.provenance.mesh);
  read.text("mesh_sha256", set.provenance.mesh_sha256);
  read.text("history", set.provenance.history);
  for (const auto& [key, at] : metadata)
    if (key.starts_with("remark.") && key.size() > 7)
      set.remarks.emplace_back(one_line(key.substr(7)), one_line(at.text));
  return normalisation && phase;
}

bool words_of_this_program(const Metadata& metadata) {
  if (metadata.contains("cowgpu")) return true;
  const auto text = [&](const char* key) {
    const auto found = metadata.find(key);
    return found == metadata.end() ? std::string_view() : std::string_view(found->second.text);
  };
  if (text("program").starts_with("cowgpu ")) return true;
  std::size_t count = 0;
  for (const char* key : {"coefficients_of", "brillouin_radius", "length_unit", "mass_unit", "second_moment",
                          "gravitational_constant", "mesh_sha256"})
    count += metadata.contains(key);
  count += kind_named(text("kind")).has_value();
  count += normalisation_named(text("normalisation")).has_value();
  count += phase_named(text("phase")).has_value();
  return count > 1;
}

std::string assumed_convention(const CoefficientSet& set) {
  if (!set.normalisation_stated && !set.phase_stated)
    return "the file does not say its convention; pyshtools' default was assumed: 4pi, without the Condon-Shortley "
           "phase";
  if (!set.normalisation_stated) return "the file says no normalisation (the line norm of a .gfc); 4pi was assumed";
  if (!set.phase_stated)
    return "the file does not say whether it has the Condon-Shortley phase; none was assumed, as in gravity tables of "
           "the PDS and by pyshtools' default";
  return "";
}

std::string convention_text(Convention convention) {
  return fmt::format("{}, {} Condon-Shortley phase", name(convention.normalisation),
                     convention.phase == Phase::condon_shortley ? "with" : "without");
}

double remark_number(const CoefficientSet& set, const std::string& file, std::string_view word, double otherwise) {
  for (const auto& [key, text] : set.remarks) {
    if (key != word) continue;
    const auto value = read_number(text);
    if (!value)
      throw Error(Fault::file_syntax, fmt::format("{}: the remark {} is '{}', and must be a finite number", file,
                                                  shown(word, 60), shown(text)));
    return *value;
  }
  return otherwise;
}

} // namespace cowgpu
