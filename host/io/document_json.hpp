// Documents as JSON.
#pragma once

#include "host/document.hpp"

#include <string>

namespace cowgpu {

/// The member `program` of every document that has one: name and version.
Object program();

/// Writes the document and a line end: a member or element a line, indented by one for each level. Numbers read back as the same
/// doubles, those that are not finite are null; what is not UTF-8 is replaced, and no text holds a character that a terminal
/// obeys. Coefficients have a row a line, and the objects around them begin at the left margin; they are written as they come.
void write_json(const Object& document, const Sink& sink);

/// The same as one text.
std::string json_text(const Object& document);

} // namespace cowgpu
