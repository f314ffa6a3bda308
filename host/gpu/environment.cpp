#include "host/gpu/environment.hpp"

#include <cstdlib>
#include <filesystem>
#include <string>
#include <sys/stat.h>
#include <unistd.h>

namespace cowgpu::gpu {

void prepare_environment() {
  if (std::getenv("MESA_SHADER_CACHE_DIR") || std::getenv("MESA_SHADER_CACHE_DISABLE")) return;
  const char* xdg = std::getenv("XDG_CACHE_HOME");
  const char* home = std::getenv("HOME");
  if (!(xdg && *xdg) && !(home && *home)) return;
  const char* width = std::getenv("LP_NATIVE_VECTOR_WIDTH");
  const std::filesystem::path base = xdg && *xdg ? std::filesystem::path(xdg) : std::filesystem::path(home) / ".cache";
  const auto folder = base / "cowgpu" / (std::string("shaders") + (width ? std::string("-") + width : ""));
  std::error_code failed; // without a cache everything works, only slower
  std::filesystem::create_directories(folder, failed);
  struct stat status {};
  if (failed || ::stat(folder.c_str(), &status) != 0) return;
  // The cache holds machine code: another user's is not run.
  if (status.st_uid == ::geteuid() && !(status.st_mode & S_IWOTH))
    setenv("MESA_SHADER_CACHE_DIR", folder.c_str(), 0);
  else
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 0);
}

} // namespace cowgpu::gpu
