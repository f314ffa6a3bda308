#include "host/io/ply_header.hpp"

#include "host/io/shown.hpp"
#include "host/io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <optional>

namespace cowgpu {
namespace {

constexpr std::uint64_t most_instances = 0xffffffff;
constexpr std::size_t most_header_bytes = std::size_t{1} << 20, most_names = 1000; // elements, or properties of one

std::optional<PlyType> type_named(std::string_view name) {
  struct Type {
    std::string_view old_name, name;
  };
  static constexpr Type types[] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"}, {"ushort", "uint16"},
                                   {"int", "int32"},     {"uint", "uint32"},   {"int64", "int64"}, {"uint64", "uint64"},
                                   {"float", "float32"}, {"double", "float64"}};
  for (std::size_t i = 0; i < std::size(types); ++i)
    if (name == types[i].old_name || name == types[i].name) return static_cast<PlyType>(i);
  return {};
}

class HeaderReader {
public:
  HeaderReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  PlyHeader read() {
    header_.lines = 1;
    if (!starts_as_ply(bytes_))
      fail(bytes_.empty() ? Fault::file_truncated : Fault::file_format,
           "this is not a PLY file: its first line is not 'ply'.");
    const std::size_t end = bytes_.find_first_of("\r\n"), after = end + 1;
    line_end_ = bytes_.substr(end, 1);
    if (const std::string_view two = bytes_.substr(end, 2); two == "\r\n" || two == "\n\r") line_end_ = two;
    at_ = after;
    skip_second_half(end);
    format(line());
    for (;;) {
      const auto words = line();
      if (words[0] == "end_header") break;
      if (!remark(words)) {
        if (words[0] == "element")
          element(words);
        else if (words[0] == "property")
          property(words);
        else
          fail(Fault::file_syntax, fmt::format("'{}' is not a word of a PLY header.", shown(words[0])));
      }
    }
    header_.size = at_;
    return std::move(header_);
  }

private:
  using Words = std::vector<std::string_view>;

  [[noreturn]] void fail(Fault fault, const std::string& sentence) const {
    throw Error(fault, fmt::format("{}:{}: {}", name_, header_.lines, sentence));
  }

  /// After the first character of a line end at `end`: the second one where the file's line ends have two. A line that ends
  /// with CR LF in a file of LF is one line.
  void skip_second_half(std::size_t end) {
    const std::string_view two = bytes_.substr(end, 2);
    if (two == line_end_ || (two == "\r\n" && line_end_ != "\r")) at_ = end + two.size();
  }

  /// The words of the next line that has some.
  Words line() {
    Words words;
    while (words.empty()) {
      ++header_.lines;
      const std::size_t end = bytes_.substr(0, most_header_bytes).find_first_of("\r\n", at_);
      if (end == std::string_view::npos && bytes_.size() > most_header_bytes)
        fail(Fault::file_syntax, fmt::format("the header does not end within {} bytes.", most_header_bytes));
      if (end == std::string_view::npos)
        fail(Fault::file_truncated, "the file ends within its header. It was cut off; write or fetch it again.");
      std::string_view rest = bytes_.substr(at_, end - at_);
      at_ = end + 1;
      skip_second_half(end);
      while (!rest.empty()) {
        const std::size_t begin = std::min(rest.find_first_not_of(" \t"), rest.size());
        const std::size_t length = std::min(rest.find_first_of(" \t", begin), rest.size()) - begin;
        if (length) words.push_back(rest.substr(begin, length));
        rest.remove_prefix(begin + length);
      }
    }
    return words;
  }

  /// Whether the line is a comment, which is kept, or an obj_info.
  bool remark(const Words& words) {
    if (words[0] == "comment")
      header_.comments.push_back(fmt::format("{}", fmt::join(words.begin() + 1, words.end(), " ")));
    return words[0] == "comment" || words[0] == "obj_info";
  }

  void format(Words words) {
    while (remark(words)) words = line();
    if (words.size() != 3 || words[0] != "format")
      fail(Fault::file_syntax,
           fmt::format("'format', an encoding and 1.0 expected before anything but comments, found '{}'.",
                       shown(words[0])));
    if (words[1] == "ascii")
      header_.encoding = PlyEncoding::ascii;
    else if (words[1] == "binary_little_endian")
      header_.encoding = PlyEncoding::little_endian;
    else if (words[1] == "binary_big_endian")
      header_.encoding = PlyEncoding::big_endian;
    else
      fail(Fault::file_format, fmt::format("'{}' is not a format of PLY files.", shown(words[1])));
    if (words[2] != "1.0")
      fail(Fault::file_format, fmt::format("PLY of version '{}' is not read, only 1.0.", shown(words[2])));
  }

  void element(const Words& words) {
    if (words.size() != 3) fail(Fault::file_syntax, "an element has a name and a number.");
    PlyElement element;
    element.name = words[1];
    element.line = header_.lines;
    const char* end = words[2].data() + words[2].size();
    const auto result = std::from_chars(words[2].data(), end, element.count);
    if (result.ec != std::errc() || result.ptr != end || element.count > most_instances)
      fail(Fault::file_syntax, fmt::format("'{}' {} are announced; from 0 to {} are possible.", shown(words[2]),
                                           shown(words[1]), most_instances));
    for (const PlyElement& other : header_.elements)
      if (other.name == element.name)
        fail(Fault::file_syntax, fmt::format("'{}' is announced twice.", shown(words[1])));
    if (header_.elements.size() == most_names) fail(Fault::file_syntax, "too many elements.");
    header_.elements.push_back(std::move(element));
  }

  void property(const Words& words) {
    if (header_.elements.empty()) fail(Fault::file_syntax, "a property before the first element.");
    PlyProperty property;
    property.line = header_.lines;
    property.is_list = words.size() > 1 && words[1] == "list";
    const std::size_t name_at = property.is_list ? 4 : 2;
    if (words.size() <= name_at)
      fail(Fault::file_syntax,
           "a property is a scalar type and a name, or the word list, a type of whole numbers for its "
           "length, a type and a name.");
    const auto type = [&](std::string_view word) {
      const auto known = type_named(word);
      if (!known) fail(Fault::file_syntax, fmt::format("'{}' is not a type of a PLY property.", shown(word)));
      return *known;
    };
    property.type = type(words[name_at - 1]);
    if (property.is_list) property.count_type = type(words[2]);
    if (is_real(property.count_type))
      fail(Fault::file_syntax,
           fmt::format("'{}' is not a type of whole numbers for a list's length.", shown(words[2])));
    property.name = {words[name_at].data(),
                     static_cast<std::size_t>(words.back().data() + words.back().size() - words[name_at].data())};
    PlyElement& owner = header_.elements.back();
    property.again = owner.find(property.name) != nullptr;
    if (owner.properties.size() == most_names) fail(Fault::file_syntax, "too many properties.");
    owner.properties.push_back(property);
  }

  std::string_view bytes_;
  const std::string& name_;
  std::size_t at_ = 0;
  std::string_view line_end_;
  PlyHeader header_;
};

} // namespace

std::size_t bytes_of(PlyType type) {
  static constexpr std::size_t bytes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return bytes[static_cast<std::size_t>(type)];
}

bool is_real(PlyType type) {
  return type == PlyType::float32 || type == PlyType::float64;
}

const PlyProperty* PlyElement::find(std::string_view property) const {
  const auto found =
      std::find_if(properties.begin(), properties.end(), [&](const PlyProperty& p) { return p.name == property; });
  return found == properties.end() ? nullptr : &*found;
}

std::size_t PlyElement::least_bytes() const {
  std::size_t sum = 0;
  for (const PlyProperty& p : properties) sum += bytes_of(p.is_list ? p.count_type : p.type);
  return sum;
}

bool starts_as_ply(std::string_view bytes) {
  bytes = without_byte_order_mark(bytes);
  if (!bytes.starts_with("ply")) return false;
  const std::size_t end = bytes.find_first_not_of(" \t", 3);
  return end != std::string_view::npos && (bytes[end] == '\n' || bytes[end] == '\r');
}

PlyHeader read_ply_header(std::string_view bytes, const std::string& name) {
  return HeaderReader(bytes, name).read();
}

} // namespace cowgpu
