#include "host/io/mesh_format.hpp"

#include "host/error.hpp"
#include "host/io/foreign_file.hpp"
#include "host/io/gltf.hpp"
#include "host/io/obj.hpp"
#include "host/io/off.hpp"
#include "host/io/plates.hpp"
#include "host/io/ply_header.hpp"
#include "host/io/ply_reader.hpp"
#include "host/io/shown.hpp"
#include "host/io/stl.hpp"
#include "host/io/words.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace cowgpu {
namespace {

enum Index { off, obj, ply, stl, gltf, plates };

constexpr MeshFormat formats[] = {{"OFF", ".off", parse_off},
                                  {"OBJ", ".obj", parse_obj},
                                  {"PLY", ".ply", parse_ply},
                                  {"STL", ".stl", parse_stl},
                                  {"glTF", ".gltf .glb", parse_gltf},
                                  {"PDS plates", "", parse_plates}}; // suffixes that tables of other things have, too

/// The format whose suffix the name has, in either case; null for another.
const MeshFormat* by_suffix(const std::string& name) {
  const std::string suffix = std::filesystem::path(name).extension();
  if (suffix.empty()) return nullptr;
  for (const MeshFormat& format : formats) {
    WordScanner scan(format.suffixes);
    for (std::string_view known = scan.word(); !known.empty(); known = scan.word())
      if (same_word(known, suffix)) return &format;
  }
  return nullptr;
}

/// OFF, COFF, STCN4OFF ..., alone or with a number glued to it.
bool is_off_header(std::string_view word) {
  const std::size_t at = word.find("OFF");
  if (at == std::string_view::npos) return false;
  return word.substr(0, at).find_first_not_of("STCN4n") == std::string_view::npos &&
         word.substr(at + 3).find_first_not_of("0123456789") == std::string_view::npos;
}

/// By the bytes alone; null where they say nothing.
const MeshFormat* by_content(std::string_view bytes, const MeshFormat* suffix) {
  if (bytes.starts_with("glTF")) return &formats[gltf];
  if (starts_as_ply(bytes)) return &formats[ply];
  const bool text = bytes.substr(0, 1024).find('\0') == std::string_view::npos;
  if (looks_like_binary_stl(bytes)) {
    // A file that is not of the length its head announces, cut off or with more behind: zero bytes alone say little.
    const bool solid = same_word(bytes.substr(0, 5), "solid");
    if (text || solid || suffix == &formats[stl]) return &formats[stl];
    if (bytes.size() >= 84 && (bytes.size() - 84) % 50 == 0) return &formats[stl];
  }
  if (!text) return nullptr;
  const std::string_view word = WordScanner(without_byte_order_mark(bytes)).word();
  if (word.starts_with('{')) return &formats[gltf];
  if (is_off_header(word)) return &formats[off];
  if (same_word(word, "solid")) return &formats[stl];
  if (is_obj_statement(word)) return &formats[obj];
  if (looks_like_plates(bytes)) return &formats[plates];
  return nullptr;
}

/// Formats of shapes that are not read, by their first bytes; "" for others.
std::string_view other_format(std::string_view bytes) {
  struct Other {
    std::string_view begins, name;
  };
  constexpr Other others[] = {{"Kaydara FBX Binary", "FBX"},
                              {"; FBX", "FBX"},
                              {"BLENDER", "Blender"},
                              {"ISO-10303-21", "STEP"},
                              {"# vtk DataFile", "VTK"},
                              {"#VRML", "VRML"},
                              {"#X3D", "X3D"},
                              {"PXR-USDC", "USD"},
                              {"#usda", "USD"},
                              {"MeshVersionFormatted", "INRIA's .mesh"},
                              {"$MeshFormat", "Gmsh"}};
  const std::string_view text = without_byte_order_mark(bytes);
  for (const Other& other : others)
    if (text.starts_with(other.begins)) return other.name;
  if (WordScanner(text, '\0').word().starts_with('<')) {
    constexpr Other elements[] = {{"<COLLADA", "COLLADA"}, {"<X3D", "X3D"}, {"<VTKFile", "VTK"},
                                  {"<amf", "AMF"},         {"<svg", "SVG"}, {"<kml", "KML"}};
    const std::string_view head = text.substr(0, 4096);
    for (const Other& element : elements)
      if (head.find(element.begins) != std::string_view::npos) return element.name;
  }
  return {};
}

} // namespace

std::span<const MeshFormat> mesh_formats() {
  return formats;
}

const MeshFormat& mesh_format_of(std::string_view bytes, const std::string& name) {
  refuse_foreign_file(bytes, name);
  const MeshFormat* suffix = by_suffix(name);
  const auto refuse = [&](Fault fault, const std::string& sentence) {
    throw Error(fault, fmt::format("{}:1: {}", name, sentence));
  };
  std::string names;
  for (const MeshFormat& format : formats) names += fmt::format("{}{}", names.empty() ? "" : ", ", format.name);
  if (const std::string_view other = other_format(bytes); !other.empty())
    refuse(Fault::file_format,
           fmt::format(
               "this is a file of {}, which is not read. The formats read are {}; export the mesh as one of these.",
               other, names));
  if (const MeshFormat* format = by_content(bytes, suffix)) return *format;
  if (suffix) return *suffix; // its reader says what is wrong
  if (bytes.empty()) refuse(Fault::file_truncated, "the file is empty. Fetch or export it again.");
  const std::string_view word = WordScanner(without_byte_order_mark(bytes)).word();
  refuse(Fault::file_format,
         fmt::format(
             "this is not a mesh file: it begins with '{}'. The formats read are {}; export the mesh as one of these.",
             shown(word), names));
  return formats[off]; // refuse() throws
}

RawMesh parse_mesh(std::string_view bytes, const std::string& name) {
  const MeshFormat& format = mesh_format_of(bytes, name);
  RawMesh mesh = format.parse(bytes, name);
  if (const MeshFormat* suffix = by_suffix(name); suffix && suffix != &format)
    mesh.notes.push_back(fmt::format("The file's name says {}, but it holds {}.", suffix->name, format.name));
  return mesh;
}

} // namespace cowgpu
