// What the commands that draw have in common.
#pragma once

#include "host/cli/commands.hpp"

#include <memory>

namespace cowgpu::cli {

/// The CPU path where --device auto found nothing but a software device: it gives the same picture, and sooner. Null where
/// the backend itself is to draw.
inline std::unique_ptr<Backend> faster_drawing(const Backend& backend, const Common& common) {
  if (common.device != "auto" || backend.facts().type != "software") return nullptr;
  return make_cpu_backend(common.threads);
}

} // namespace cowgpu::cli
