#include "host/io/gltf_document.hpp"

#include "host/counted.hpp"
#include "host/io/shown.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace cowgpu {
namespace {

static_assert(std::endian::native == std::endian::little, "the reader copies memory");

using Json = nlohmann::json;

constexpr std::size_t deepest = 100;
constexpr std::size_t most_values = std::size_t{1} << 18,
                      bytes_per_value = 32; // a value takes up to 110 bytes of memory
constexpr std::uint32_t json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;
const char* const whole_file = "the file";

// What no shape depends on, by name.
constexpr std::string_view left_out[] = {"animations", "cameras", "extras", "images",   "materials",
                                         "max",        "min",     "name",   "samplers", "textures"};
// Extensions that leave shapes alone, by the beginning of their names.
constexpr std::string_view harmless[] = {"KHR_materials_", "KHR_texture_", "EXT_texture_",  "KHR_lights_",
                                         "EXT_lights_",    "KHR_xmp",      "MSFT_texture_", "KHR_mesh_quantization"};

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// Builds the JSON while it is parsed: stops what is too deep or too much, drops what is not needed. (The parser's own
/// filter looks at all elements of an array at the end of each.)
class Builder : public nlohmann::json_sax<Json> {
public:
  Builder(const GltfDocument& document, std::string_view text, bool alone, std::size_t most)
      : document_(document), text_(text), alone_(alone), most_(most) {}

  Json take() { return std::move(root_); }

  bool null() override { return value(nullptr); }
  bool boolean(bool x) override { return value(x); }
  bool number_integer(number_integer_t x) override { return value(x); }
  bool number_unsigned(number_unsigned_t x) override { return value(x); }
  bool number_float(number_float_t x, const string_t&) override { return value(x); }
  bool string(string_t& x) override { return value(std::move(x)); }
  bool binary(binary_t&) override { return true; } // not in texts
  bool start_object(std::size_t) override { return start(Json::object()); }
  bool start_array(std::size_t) override { return start(Json::array()); }
  bool end_object() override { return end(); }
  bool end_array() override { return end(); }

  bool key(string_t& key) override {
    if (drop_depth_ != 0) return true;
    drop_next_ = std::find(std::begin(left_out), std::end(left_out), key) != std::end(left_out);
    key_ = std::move(key);
    return true;
  }

  bool parse_error(std::size_t position, const std::string&, const Json::exception&) override {
    document_.fail(alone_ && position > text_.size() ? Fault::file_truncated : Fault::file_syntax,
                   fmt::format("byte {} of the JSON", position),
                   "this is not JSON, or it holds a number beyond double precision. Fetch or export it again.");
  }

private:
  bool value(Json x) {
    if (drop_depth_ == 0 && !drop_next_) place(std::move(x));
    drop_next_ = false;
    return true;
  }

  bool start(Json empty) {
    if (++depth_ > deepest)
      document_.fail(Fault::file_syntax, whole_file, fmt::format("the JSON is nested more than {} deep.", deepest));
    if (drop_next_) drop_depth_ = depth_;
    drop_next_ = false;
    if (drop_depth_ == 0) open_.push_back(place(std::move(empty)));
    return true;
  }

  bool end() {
    if (drop_depth_ == 0) open_.pop_back();
    if (drop_depth_ == depth_) drop_depth_ = 0;
    --depth_;
    return true;
  }

  Json* place(Json x) {
    if (++values_ > most_)
      document_.fail(Fault::too_large, whole_file,
                     fmt::format("the JSON has more than {} values beside names and materials. Join the meshes and "
                                 "nodes, or export the body as PLY.",
                                 most_));
    if (open_.empty()) return &(root_ = std::move(x));
    Json& parent = *open_.back();
    if (parent.is_object()) return &(parent[key_] = std::move(x));
    parent.push_back(std::move(x));
    return &parent.back();
  }

  const GltfDocument& document_;
  std::string_view text_;
  const bool alone_; // not in a GLB
  const std::size_t most_;
  std::size_t values_ = 0, depth_ = 0, drop_depth_ = 0; // drop_depth_: of what is being dropped, 0 for nothing
  bool drop_next_ = false;
  std::string key_;
  std::vector<Json*> open_; // innermost last; only the last one grows, so that they stay where they are
  Json root_;
};

/// Nothing if the text is no base64.
std::optional<std::string> from_base64(std::string_view text) {
  while (text.ends_with('=')) text.remove_suffix(1);
  static constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  static const std::array<signed char, 256> values = [] {
    std::array<signed char, 256> table;
    table.fill(-1);
    for (std::size_t i = 0; i < digits.size(); ++i)
      table[static_cast<unsigned char>(digits[i])] = static_cast<signed char>(i);
    return table;
  }();
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t held = 0;
  int bits = 0;
  for (const char c : text) {
    const signed char value = values[static_cast<unsigned char>(c)];
    if (value < 0) return {};
    held = held << 6 | static_cast<std::uint32_t>(value);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<char>(held >> bits & 0xff));
  }
  return bytes;
}

std::size_t component_bytes(int type) {
  return type == gltf_byte || type == gltf_ubyte ? 1 : type == gltf_short || type == gltf_ushort ? 2 : 4;
}

std::uint32_t unsigned_at(const char* at, int type) {
  std::uint32_t value = 0; // little endian: a shorter number fills its lower bytes
  std::memcpy(&value, at, component_bytes(type));
  return value;
}

template <class Number>
double number_at(const char* at) {
  Number value;
  std::memcpy(&value, at, sizeof value);
  return double(value);
}

} // namespace

const char* GltfNumbers::at(std::size_t i) const {
  std::size_t low = 0, high = sparse.count;
  while (low < high) {
    const std::size_t middle = low + (high - low) / 2;
    const std::uint32_t index =
        unsigned_at(sparse.indices + middle * component_bytes(sparse.index_type), sparse.index_type);
    if (index == i) return sparse.values + middle * element;
    if (index < i)
      low = middle + 1;
    else
      high = middle;
  }
  return data ? data + i * stride : nullptr;
}

std::uint32_t GltfNumbers::index(std::size_t i) const {
  const char* found = at(i);
  return found ? unsigned_at(found, component_type) : 0;
}

double GltfNumbers::component(std::size_t i, std::size_t c) const {
  const char* found = at(i);
  if (!found) return 0;
  found += c * component_bytes(component_type);
  switch (component_type) {
  case gltf_byte:
    return normalized ? std::max(number_at<std::int8_t>(found) / 127, -1.0) : number_at<std::int8_t>(found);
  case gltf_ubyte: return number_at<std::uint8_t>(found) / (normalized ? 255 : 1);
  case gltf_short:
    return normalized ? std::max(number_at<std::int16_t>(found) / 32767, -1.0) : number_at<std::int16_t>(found);
  case gltf_ushort: return number_at<std::uint16_t>(found) / (normalized ? 65535 : 1);
  default: return number_at<float>(found);
  }
}

GltfDocument::GltfDocument(std::string_view bytes, const std::string& name) : name_(name) {
  parse(bytes.starts_with("glTF") ? container(bytes) : bytes, bytes.size());
  if (!root_.is_object() || !root_.contains("asset") || !root_["asset"].is_object())
    fail(Fault::file_format, whole_file, "this is JSON, but no glTF: it has no 'asset'.");
  const Json* version = member(root_["asset"], "version");
  if (!version || !version->is_string() || !version->get_ref<const std::string&>().starts_with("2."))
    fail(Fault::file_format, whole_file, "only version 2 of glTF is read.");
  require_known_extensions();
  decoded_.resize(count("buffers"));
}

void GltfDocument::fail(Fault fault, const std::string& what, const std::string& sentence) const {
  throw Error(fault, fmt::format("{}: {}: {}", name_, what, sentence));
}

std::string_view GltfDocument::container(std::string_view bytes) {
  const auto truncated = [&] {
    fail(Fault::file_truncated, fmt::format("byte {}", bytes.size()),
         "the file ends before what its header and its chunks announce. Fetch or export it again.");
  };
  if (bytes.size() < 12) truncated();
  if (const std::uint32_t version = word_at(bytes, 4); version != 2)
    fail(Fault::file_format, whole_file, fmt::format("only version 2 of GLB is read, and this is {}.", version));
  const std::size_t length = word_at(bytes, 8);
  if (bytes.size() < length) truncated();
  if (bytes.size() > length)
    notes.push_back(fmt::format("{} after the GLB's end {} ignored (from byte {}).",
                                counted(bytes.size() - length, "byte", "bytes"),
                                bytes.size() - length == 1 ? "was" : "were", length));
  std::string_view text;
  std::size_t chunks = 0;
  for (std::size_t at = 12; at < length; ++chunks) {
    if (length - at < 8 || length - at - 8 < word_at(bytes, at))
      fail(Fault::file_syntax, fmt::format("byte {}", at), "a chunk is longer than the file.");
    const std::string_view chunk = bytes.substr(at + 8, word_at(bytes, at));
    const std::uint32_t type = word_at(bytes, at + 4);
    if ((type == json_chunk) != (chunks == 0))
      fail(Fault::file_syntax, fmt::format("byte {}", at), "the first chunk of a GLB, and no other, is JSON.");
    if (type == json_chunk) text = chunk;
    if (type == binary_chunk && !has_chunk_) has_chunk_ = true, chunk_ = chunk;
    at += 8 + chunk.size();
  }
  if (chunks == 0) fail(Fault::file_syntax, whole_file, "the GLB has no chunk of JSON.");
  while (text.ends_with('\0')) text.remove_suffix(1); // some writers pad with zeros
  return text;
}

void GltfDocument::parse(std::string_view text, std::size_t file_size) {
  Builder builder(*this, text, text.size() == file_size, most_values + file_size / bytes_per_value);
  Json::sax_parse(text.begin(), text.end(), &builder); // the builder throws where it fails
  root_ = builder.take();
}

void GltfDocument::require_known_extensions() const {
  for (const Json& extension : list(root_, "extensionsRequired", whole_file)) {
    if (!extension.is_string())
      fail(Fault::file_syntax, whole_file, "'extensionsRequired' holds something else than names.");
    const auto& text = extension.get_ref<const std::string&>();
    if (std::none_of(std::begin(harmless), std::end(harmless), [&](std::string_view h) { return text.starts_with(h); }))
      fail(Fault::file_format, whole_file,
           fmt::format("it requires the extension {}, which is not read. Export it without (no compression).",
                       shown(text, 60)));
  }
}

const Json* GltfDocument::member(const Json& object, const char* key) const {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

std::uint64_t GltfDocument::whole(const Json& object, const char* key, const std::string& what,
                                  std::optional<std::uint64_t> otherwise) const {
  const Json* value = member(object, key);
  if (!value && otherwise) return *otherwise;
  constexpr double limit = 0x1p53;
  if (value && value->is_number()) {
    const double number = value->get<double>();
    if (number >= 0 && number < limit && number == std::floor(number)) return static_cast<std::uint64_t>(number);
  }
  fail(Fault::file_syntax, what, fmt::format("'{}' must be a whole number from 0.", key));
}

std::optional<std::vector<double>> GltfDocument::numbers(const Json& object, const char* key, std::size_t size,
                                                         const std::string& what) const {
  const Json* value = member(object, key);
  if (!value) return {};
  std::vector<double> numbers;
  if (value->is_array() && value->size() == size)
    for (const Json& number : *value)
      if (number.is_number()) numbers.push_back(number.get<double>());
  if (numbers.size() != size) fail(Fault::file_syntax, what, fmt::format("'{}' must be {} numbers.", key, size));
  return numbers;
}

const Json& GltfDocument::list(const Json& object, const char* key, const std::string& what) const {
  static const Json none = Json::array();
  const Json* value = member(object, key);
  if (!value) return none;
  if (!value->is_array()) fail(Fault::file_syntax, what, fmt::format("'{}' must be a list.", key));
  return *value;
}

const Json& GltfDocument::object(const char* key, std::uint64_t index, const std::string& what) const {
  const Json& all = list(root_, key, whole_file);
  if (index >= all.size())
    fail(Fault::file_syntax, what,
         fmt::format("it names {} of '{}', but there are {}, numbered from 0.", index, key, all.size()));
  if (!all[index].is_object()) fail(Fault::file_syntax, what, fmt::format("{} of '{}' must be an object.", index, key));
  return all[index];
}

std::string_view GltfDocument::buffer(std::uint64_t index, const std::string& what) {
  const Json& buffer = object("buffers", index, what);
  const std::string self = fmt::format("buffer {}", index);
  std::string_view bytes;
  if (const Json* uri = member(buffer, "uri")) {
    if (!decoded_[index]) {
      if (!uri->is_string()) fail(Fault::file_syntax, self, "'uri' must be text.");
      const std::string_view text = uri->get_ref<const std::string&>();
      if (!text.starts_with("data:"))
        fail(Fault::file_format, self,
             fmt::format("it lies in another file ('{}'), and other files are not opened. Pack all into one GLB.",
                         shown(text, 60)));
      constexpr std::string_view mark = ";base64,";
      const std::size_t at = text.substr(0, 200).find(mark);
      if (at == std::string_view::npos) fail(Fault::file_format, self, "its data: URI is not base64.");
      decoded_[index] = from_base64(text.substr(at + mark.size()));
      if (!decoded_[index]) fail(Fault::file_syntax, self, "its data: URI is not base64.");
    }
    bytes = *decoded_[index];
  } else {
    if (index != 0 || !has_chunk_)
      fail(Fault::file_format, self, "it has no 'uri', and no binary chunk stands for it.");
    bytes = chunk_;
  }
  const std::uint64_t length = whole(buffer, "byteLength", self);
  if (length > bytes.size())
    fail(Fault::file_truncated, self, fmt::format("it announces {} bytes and has {}.", length, bytes.size()));
  return bytes.substr(0, length);
}

bool GltfDocument::names_extension(std::string_view extension) const {
  for (const char* key : {"extensionsRequired", "extensionsUsed"})
    for (const Json& one : list(root_, key, whole_file))
      if (one.is_string() && one.get_ref<const std::string&>() == extension) return true;
  return false;
}

/// The first of `count` elements of the bufferView that an accessor, or a part of a sparse one, names. With `stride` they
/// may lie apart, and it receives how far.
const char* GltfDocument::elements(const Json& accessor, std::uint64_t count, std::size_t element, std::size_t* stride,
                                   const std::string& self) {
  const std::uint64_t view_index = whole(accessor, "bufferView", self);
  const Json& view = object("bufferViews", view_index, self);
  const std::string view_name = fmt::format("bufferView {}", view_index);
  const std::string_view bytes = buffer(whole(view, "buffer", view_name), view_name);
  const std::uint64_t begin = whole(view, "byteOffset", view_name, 0), length = whole(view, "byteLength", view_name);
  if (begin > bytes.size() || length > bytes.size() - begin)
    fail(Fault::file_syntax, view_name,
         fmt::format("its bytes {} to {} lie outside of its buffer of {} bytes.", begin, begin + length, bytes.size()));
  const std::uint64_t apart = stride ? whole(view, "byteStride", view_name, element) : element;
  if (apart < element || apart > 252)
    fail(Fault::file_syntax, view_name, fmt::format("its byteStride {} must be from {} to 252.", apart, element));
  const std::uint64_t offset = whole(accessor, "byteOffset", self, 0);
  const std::uint64_t room = offset <= length ? length - offset : 0;
  if (offset > length || (count != 0 && (room < element || (room - element) / apart < count - 1)))
    fail(
        Fault::file_syntax, self,
        fmt::format("its {} elements from byte {} do not fit into its bufferView of {} bytes.", count, offset, length));
  if (stride) *stride = apart;
  return bytes.data() + begin + offset;
}

GltfNumbers GltfDocument::accessor(std::uint64_t index, const char* type, const std::string& what) {
  const Json& accessor = object("accessors", index, what);
  const std::string self = fmt::format("{}, accessor {}", what, index);
  const Json* kind = member(accessor, "type");
  if (!kind || *kind != type) fail(Fault::file_format, self, fmt::format("its type must be {}.", type));
  const bool vector = std::string_view(type) == "VEC3";

  GltfNumbers numbers;
  const auto is_index = [](std::uint64_t t) { return t == gltf_ubyte || t == gltf_ushort || t == gltf_uint; };
  const std::uint64_t component = whole(accessor, "componentType", self);
  const bool quantized = vector && component >= gltf_byte && component <= gltf_ushort;
  if (quantized && !names_extension("KHR_mesh_quantization"))
    fail(Fault::file_format, self,
         fmt::format("positions of the component type {} are read where 'extensionsRequired' names "
                     "KHR_mesh_quantization, and here it does not. Export them as floats (5126).",
                     component));
  if (!(vector ? quantized || component == gltf_float : is_index(component)))
    fail(Fault::file_format, self,
         fmt::format("numbers of the component type {} are not read here, only {}.", component,
                     vector ? "floats (5126)" : "unsigned integers (5121, 5123, 5125)"));
  numbers.component_type = static_cast<int>(component);
  const Json* normalized = member(accessor, "normalized");
  numbers.normalized = vector && normalized && *normalized == true;
  numbers.element = (vector ? 3 : 1) * component_bytes(numbers.component_type);
  numbers.count = whole(accessor, "count", self);
  const Json* sparse = member(accessor, "sparse");
  if (member(accessor, "bufferView"))
    numbers.data = elements(accessor, numbers.count, numbers.element, &numbers.stride, self);
  else if (!sparse)
    fail(Fault::file_format, self, "it has no 'bufferView', so no data.");
  else if (numbers.count > 0xffffffff)
    fail(Fault::file_syntax, self, fmt::format("it announces {} elements and has no 'bufferView'.", numbers.count));
  if (!sparse) return numbers;

  numbers.sparse.count = whole(*sparse, "count", self);
  const Json *indices = member(*sparse, "indices"), *values = member(*sparse, "values");
  if (numbers.sparse.count > numbers.count || !indices || !values)
    fail(Fault::file_syntax, self,
         fmt::format("'sparse' must have 'indices', 'values' and a 'count' of at most {}.", numbers.count));
  const std::uint64_t index_type = whole(*indices, "componentType", self);
  if (!is_index(index_type))
    fail(Fault::file_syntax, self,
         fmt::format("the indices of 'sparse' are of the component type {}, and must be unsigned integers (5121, 5123, "
                     "5125).",
                     index_type));
  numbers.sparse.index_type = static_cast<int>(index_type);
  numbers.sparse.indices =
      elements(*indices, numbers.sparse.count, component_bytes(numbers.sparse.index_type), nullptr, self);
  numbers.sparse.values = elements(*values, numbers.sparse.count, numbers.element, nullptr, self);
  return numbers;
}

void GltfDocument::require_increasing(const GltfNumbers& numbers, const std::string& what) const {
  std::uint64_t next = 0;
  for (std::size_t i = 0; i < numbers.sparse.count; ++i) {
    const std::uint32_t index =
        unsigned_at(numbers.sparse.indices + i * component_bytes(numbers.sparse.index_type), numbers.sparse.index_type);
    if (index < next || index >= numbers.count)
      fail(Fault::file_syntax, what,
           fmt::format("index {} of a sparse accessor is {}; they must increase and stay below {}.", i, index,
                       numbers.count));
    next = std::uint64_t(index) + 1;
  }
}

} // namespace cowgpu
