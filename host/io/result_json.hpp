// Parts of result files (data/schemas/cowgpu.result.v1.json) that the readers of expansions share.
#pragma once

#include "host/document.hpp"
#include "host/mesh/placement.hpp"
#include "host/sphere_coefficients.hpp"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <string>

namespace cowgpu::result_json {

/// The file's document, of any kind. Throws Error(cannot_read, too_large), file_syntax where it is no JSON.
nlohmann::json parse(const std::filesystem::path& path);

/// The same of bytes that were read; `name` is the file's. A byte order mark before the document is passed over; zero bytes
/// are refused.
nlohmann::json parse(const std::string& name, const std::string& bytes);
/// The same with the members of objects as they stand.
nlohmann::ordered_json parse_in_order(const std::string& name, const std::string& bytes);

/// A part of a parsed document as a value of another document, its members by name.
Value value(const nlohmann::json& parsed);

/// A file; Error(file_format) where it is another document than a cowgpu.result.v1.
nlohmann::json read(const std::filesystem::path& path);

/// A member of an object; `name` is the file's. Throws Error(file_format) where there is none.
const nlohmann::json& member(const std::string& name, const nlohmann::json& object, const char* key);

/// A member that is a number. Throws Error(file_format).
double number(const std::string& name, const nlohmann::json& object, const char* key);

/// The member `mesh.placement`: the identity where a file has none. Throws Error(file_format) for a scale that is not
/// above 0 or a matrix that is no rotation to 1e-9.
Placement placement(const std::string& name, const nlohmann::json& document);

/// The member of `expansions` with the mass multipoles or a surface: `of`, or where that is empty `mass`. Throws
/// Error(file_format) where there is no mass to take, and bad_argument where there is no `of`.
const nlohmann::json& expansion(const std::string& name, const nlohmann::json& result, const std::string& of);

/// The members `lmax` and `coefficients` of an object: rows [l, m, and two numbers of each field] by l, then m, as real and
/// imaginary parts. Allocates only what there are rows for. Throws Error(file_format) where lmax is none, above `largest`
/// or not that of the rows; file_syntax for a row that is wrong.
SphereCoefficients rows(const std::string& name, const nlohmann::json& object, int fields, int largest);

/// The same of an expansion. Throws also Error(file_format) where the coefficients are not orthonormal with the
/// Condon-Shortley phase.
SphereCoefficients coefficients(const std::string& name, const nlohmann::json& expansion, int fields, int largest);

} // namespace cowgpu::result_json
