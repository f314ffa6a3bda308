// The paper's tables and derived numbers, row by row, beside what the stages wrote.
#pragma once

#include "host/reproduce/row.hpp"

#include <nlohmann/json.hpp>

#include <map>
#include <string>
#include <vector>

namespace cowgpu::reproduce {

/// What the stages wrote, by name of the file: "mass.json".
using Documents = std::map<std::string, nlohmann::json>;

/// Every number of the paper: bounding box, mass multipoles, tensors, radiation, both tables of the surface, spectrum and
/// tipping. Rows whose document is missing or lacks the number are there, not computed.
std::vector<Row> paper_rows(const Documents& documents);

/// The same of another body: nothing is compared.
void not_the_papers_body(std::vector<Row>& rows, const std::string& body);

} // namespace cowgpu::reproduce
