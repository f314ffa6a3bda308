// Parts that several JSON documents share.
#pragma once

#include "host/device_facts.hpp"

#include <nlohmann/json_fwd.hpp>

#include <span>
#include <string>

namespace cowgpu {

/// The member `device`.
nlohmann::ordered_json device_json(const DeviceFacts& device);
/// The member `program`.
nlohmann::ordered_json program_json();
/// A document's text, indented by one; what is not UTF-8 is replaced.
std::string json_text(const nlohmann::ordered_json& document);
/// An object's text without the closing brace, so that more members can follow.
std::string json_members(const nlohmann::ordered_json& object);
/// Quantiles of a map's quality: the parts of the surface and the values there, infinity as null.
nlohmann::ordered_json quantiles_json(std::span<const double> parts, std::span<const double> values);
/// Now, UTC, ISO 8601.
std::string utc_now();

} // namespace cowgpu
