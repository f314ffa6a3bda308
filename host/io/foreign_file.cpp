#include "host/io/foreign_file.hpp"

#include "host/error.hpp"
#include "host/io/file.hpp"
#include "host/io/shown.hpp"
#include "host/io/words.hpp"

#include <fmt/format.h>

namespace cowgpu {
namespace {

using namespace std::string_view_literals;

struct Packed {
  std::string_view magic, name, tool;
  std::size_t at = 0; ///< where the magic bytes stand
};

constexpr Packed packed[] = {{"\x1f\x8b"sv, "gzip", "gunzip"},
                             {"\x1f\x9d"sv, "compress (.Z)", "gunzip"},
                             {"BZh"sv, "bzip2", "bunzip2"},
                             {"\xfd"
                              "7zXZ\0"sv,
                              "xz", "unxz"},
                             {"\x28\xb5\x2f\xfd"sv, "Zstandard", "unzstd"},
                             {"\x04\x22\x4d\x18"sv, "LZ4", "unlz4"},
                             {"LZIP"sv, "lzip", "lzip -d"},
                             {"7z\xbc\xaf\x27\x1c"sv, "7-Zip", "7z x"},
                             {"Rar!\x1a\x07"sv, "RAR", "unrar x"},
                             {"ustar"sv, "tar", "tar -xf", 257}};

bool holds(std::string_view bytes, std::string_view text, std::size_t first, std::size_t last) {
  constexpr auto none = std::string_view::npos;
  return bytes.substr(0, first).find(text) != none ||
         bytes.substr(bytes.size() - std::min(last, bytes.size())).find(text) != none;
}

bool ends_with(std::string_view name, std::string_view suffix) {
  return name.size() >= suffix.size() && same_word(name.substr(name.size() - suffix.size()), suffix);
}

/// What a ZIP archive is used for here: by the names of its entries, which stand at its beginning and its end.
std::string zip_sentence(std::string_view bytes, std::string_view name) {
  constexpr std::size_t looked_at = std::size_t{1} << 16;
  const auto has = [&](std::string_view entry, std::string_view suffix) {
    return ends_with(name, suffix) || holds(bytes, entry, looked_at, looked_at);
  };
  if (has("3D/3dmodel.model", ".3mf"))
    return "this is a 3MF file, a ZIP archive of XML, which is not read. Export the body as STL, OBJ, PLY or glTF from "
           "the "
           "program that made it.";
  if (has(".usdc", ".usdz"))
    return "this is a USDZ file, a ZIP archive of USD, which is not read. Export the body as glTF, OBJ or STL from the "
           "program that made it.";
  if (has(".npy", ".npz"))
    return "this is a NumPy archive (.npz), which is not read. Save its array as .csv or netCDF.";
  std::string entry;
  if (bytes.starts_with("PK\x03\x04") && bytes.size() > 30) {
    const std::size_t length =
        std::size_t(static_cast<unsigned char>(bytes[26])) | std::size_t(static_cast<unsigned char>(bytes[27])) << 8;
    if (length != 0) entry = fmt::format(" (its first entry is {})", shown(bytes.substr(30, length), 60));
  }
  return fmt::format("this is a ZIP archive{}. Unpack it (unzip) and give the file that is inside.", entry);
}

std::string sentence_about(std::string_view bytes, std::string_view name) {
  if (bytes.starts_with("version https://git-lfs.github.com/") ||
      bytes.starts_with("version https://hawser.github.com/"))
    return "this is a Git LFS pointer, a few lines of text that stand for the file. Fetch the file itself: `git lfs "
           "pull` "
           "in its repository, or download it instead of its pointer.";
  if (bytes.size() < 1024 && bytes.find("annex/objects/") < 64)
    return "this is a git-annex pointer, a line of text that stands for the file. Fetch the file itself: `git annex "
           "get` in "
           "its repository.";
  if (bytes.starts_with("PK\x03\x04") || bytes.starts_with("PK\x05\x06") || bytes.starts_with("PK\x07\x08"))
    return zip_sentence(bytes, name);
  for (const Packed& kind : packed)
    if (bytes.substr(std::min(kind.at, bytes.size())).starts_with(kind.magic))
      return fmt::format("this is a file packed by {}. Unpack it first ({}) and give the file that is inside.",
                         kind.name, kind.tool);
  if (bytes.starts_with("%PDF-")) return "this is a PDF document. Give the data file itself.";
  if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff"))
    return "the file is UTF-16 text. Save it as UTF-8 or ASCII.";
  const std::string_view word = WordScanner(without_byte_order_mark(bytes), '\0').word();
  if (same_word(word, "<!doctype") || same_word(word.substr(0, 5), "<html"))
    return "this is a web page, saved in the place of the file. Download the file itself, by the link named Raw or "
           "Download.";
  return {};
}

} // namespace

void refuse_foreign_file(std::string_view bytes, const std::string& name) {
  if (const std::string sentence = sentence_about(bytes, name); !sentence.empty())
    throw Error(Fault::file_format, fmt::format("{}:1: {}", name, sentence));
}

std::string read_input_file(const std::filesystem::path& path) {
  std::string bytes = read_file(path);
  refuse_foreign_file(bytes, path.string());
  return bytes;
}

} // namespace cowgpu
