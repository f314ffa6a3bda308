// What an application of the multipoles found, in one form for the screen and for its document (host/document.hpp).
#pragma once

#include "host/document.hpp"

#include <string>
#include <vector>

namespace cowgpu::physics {

/// A result: a member of the JSON document and a line on the screen.
struct Finding {
  std::string key;   ///< in JSON: "power_W"
  std::string label; ///< on the screen: "radiated power"
  Value value;
  std::string unit = {}; ///< "W"; in JSON the member `units` has it under the same key
  std::string missing =
      "not known"; ///< on the screen where there is no value, without the unit: "never"; empty: no line
};

/// A column of a table; the name is lower case with underscores, for JSON and CSV.
struct Column {
  std::string name;      ///< "order"
  std::string unit = {}; ///< "N"; empty where there is none
  bool on_screen = true; ///< false: in JSON alone
};

/// Rows of numbers, words and yes or no: in JSON `key` is {"columns": [...], "units": [...], "rows": [[...], ...]}. Each row
/// has as many values as there are columns.
struct Table {
  std::string key;   ///< in JSON: "orders"
  std::string label; ///< on the screen, above the columns
  std::vector<Column> columns;
  std::vector<std::vector<Value>> rows;
  /// In JSON instead a list of objects with the columns as members; units among those of Findings.
  bool as_entries = false;
};

/// A number that a paper prints, beside ours.
struct Comparison {
  std::string quantity;
  double ours = 0, printed = 0;
  std::string why = {};   ///< they differ: a sentence, or empty where it is the last printed digit
  double uncertainty = 0; ///< uncertainty of ours, where it is more than rounding
  int erratum = 0;        ///< the number of the erratum that it shows (host/paper/errata.hpp); 0: none
};

/// The input that findings are about, and what there is to say of it.
struct Subject {
  std::string title;
  std::string kind, name, sha256; ///< as in Findings
  std::vector<std::string> notes;
};

struct Findings {
  Findings() = default;
  explicit Findings(const Subject& subject)
      : title(subject.title), input_kind(subject.kind), input_name(subject.name), input_sha256(subject.sha256),
        notes(subject.notes) {}

  std::string title;
  std::string input_kind, input_name, input_sha256; ///< "mesh" or "coefficients"; a mesh's hash, else empty
  std::vector<Finding> rows;
  std::vector<Table> tables;
  std::vector<Comparison> paper; ///< "Higher multipoles of the cow"; empty unless asked for
  std::vector<std::string> notes;
};

} // namespace cowgpu::physics
