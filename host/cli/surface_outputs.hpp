// Files for several surfaces: one name with {} in it, or a folder.
#pragma once

#include "host/io/atomic_file.hpp"
#include "host/io/glb.hpp"

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace cowgpu::cli {

/// What a surface is called in names of files.
struct OutputKey {
  std::string text; ///< in the place of {}
  std::string stem; ///< stem of its file's name in a folder
};

class SurfaceOutputs {
public:
  /// `output` is -o: FILE.glb or FILE.ply, with {} where there are several surfaces, or a folder; "": no files. `format`
  /// is --format or "". `what` names one of the surfaces in messages: "order". Throws Error(bad_argument).
  SurfaceOutputs(const std::string& output, const std::string& format, std::size_t count, const char* what);

  bool any() const { return !output_.empty(); }

  /// Opens the file of a surface, so that what cannot be written fails early. Throws Error(cannot_write).
  void open(const OutputKey& key);

  /// Writes and commits it; `facts` are sentences that begin with a name and a blank. The file's name.
  std::string write(const OutputKey& key, const TriangleSurface& surface, const std::vector<std::string>& facts,
                    const std::pair<std::string, double>& number);

  /// The file's name.
  std::string path(const OutputKey& key) const;

private:
  std::string output_, suffix_;
  bool folder_ = false;
  std::map<std::string, std::unique_ptr<AtomicFile>> files_;
};

} // namespace cowgpu::cli
