#include "host/cli/surface_outputs.hpp"

#include "host/error.hpp"
#include "host/io/ply.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <span>
#include <system_error>

namespace cowgpu::cli {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& sentence) {
  throw Error(Fault::bad_argument, sentence);
}

} // namespace

SurfaceOutputs::SurfaceOutputs(const std::string& output, const std::string& format, std::size_t count,
                               const char* what)
    : output_(output) {
  if (output.empty()) {
    if (!format.empty()) fail("--format is about files, and there is no -o");
    return;
  }
  const std::string suffix = fs::path(output).extension();
  folder_ = suffix != ".ply" && suffix != ".glb";
  if (folder_) {
    if (std::error_code none; !suffix.empty() && !fs::is_directory(output, none))
      fail(fmt::format("-o {}: a file's name must end in .glb or .ply; a folder has no suffix", output));
    suffix_ = "." + (format.empty() ? "glb" : format);
    return;
  }
  suffix_ = suffix;
  if (!format.empty() && suffix != "." + format)
    fail(fmt::format("-o {}: the name and --format {} contradict each other", output, format));
  if (count > 1 && output.find("{}") == std::string::npos)
    fail(fmt::format("-o {}: there are {} {}s and one file; put {{}} for the {} into the name, or name a folder",
                     output, count, what, what));
}

void SurfaceOutputs::open(const OutputKey& key) {
  if (!any() || files_.contains(key.text)) return;
  if (folder_) {
    std::error_code reason;
    fs::create_directories(output_, reason);
    if (reason) throw Error(Fault::cannot_write, fmt::format("{}: cannot be made: {}.", output_, reason.message()));
  }
  files_[key.text] = std::make_unique<AtomicFile>(path(key));
}

std::string SurfaceOutputs::write(const OutputKey& key, const TriangleSurface& surface,
                                  const std::vector<std::string>& facts, const std::pair<std::string, double>& number) {
  open(key);
  AtomicFile& file = *files_.at(key.text);
  if (suffix_ == ".ply")
    write_ply(surface, facts, file);
  else {
    GlbAbout about;
    for (const std::string& fact : facts)
      about.facts.emplace_back(fact.substr(0, fact.find(' ')), fact.substr(fact.find(' ') + 1));
    GlbPart part{&surface};
    part.numbers = {number};
    write_glb(std::span(&part, 1), about, file);
  }
  file.commit();
  files_.erase(key.text);
  return path(key);
}

std::string SurfaceOutputs::path(const OutputKey& key) const {
  if (folder_) return fs::path(output_) / (key.stem + suffix_);
  std::string name = output_;
  const std::size_t braces = name.find("{}");
  if (braces != std::string::npos) name.replace(braces, 2, key.text);
  return name;
}

} // namespace cowgpu::cli
