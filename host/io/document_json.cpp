#include "host/io/document_json.hpp"

#include "host/io/number.hpp"
#include "host/io/shown.hpp"
#include "host/version.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace cowgpu {
namespace {

using nlohmann::json;

bool streams(const Object& object) {
  return std::any_of(object.members.begin(), object.members.end(), [](const Member& member) {
    const Object* inner = member.value.get<Object>();
    return member.value.get<CoefficientRows>() || (inner && streams(*inner));
  });
}

class Writer {
public:
  explicit Writer(const Sink& sink) : sink_(sink) {}

  void document(const Object& object) {
    if (streams(object)) {
      add_streamed(object);
      text_ += "\n}";
    } else {
      add(object, 0);
    }
    text_ += '\n';
    sink_(text_);
  }

private:
  void flush_some() {
    if (text_.size() < 65536) return;
    sink_(text_);
    text_.clear();
  }

  void add(std::monostate, int) { text_ += "null"; }
  void add(bool value, int) { text_ += value ? "true" : "false"; }
  void add(std::int64_t value, int) { text_ += std::to_string(value); }
  void add(std::uint64_t value, int) { text_ += std::to_string(value); }
  void add(double value, int) { text_ += json(value).dump(); }
  void add(const std::string& value, int) {
    text_ += terminal_json(json(value).dump(-1, ' ', false, json::error_handler_t::replace));
  }
  void add(const Vec3& v, int depth) { add_items('[', v, ']', depth); }
  void add(const Eigen::Matrix3d& m, int depth) {
    add_items('[', std::array<Vec3, 3>{m.row(0), m.row(1), m.row(2)}, ']', depth);
  }
  void add(const Numbers& values, int depth) { add_items('[', values, ']', depth); }
  void add(const List& values, int depth) { add_items('[', values, ']', depth); }
  void add(const Object& object, int depth) { add_items('{', object.members, '}', depth); }
  void add(const CoefficientRows& rows, int) {
    text_ += '[';
    Numbers numbers;
    for (int l = 0; l <= rows.lmax; ++l)
      for (int m = 0; m <= l; ++m) {
        numbers.clear();
        rows.row(l, m, numbers);
        text_ += l == 0 ? "\n[" : ",\n[";
        text_ += std::to_string(l) + ", " + std::to_string(m);
        for (const double number : numbers) {
          text_ += ", ";
          append_number(text_, number);
        }
        text_ += ']';
        flush_some();
      }
    text_ += "\n]";
  }
  void add(const Value& value, int depth) {
    std::visit([&](const auto& content) { add(content, depth); }, value.content);
  }
  void add(const Member& member, int depth) {
    add(member.key, depth);
    text_ += ": ";
    add(member.value, depth);
  }

  template <class Items>
  void add_items(char open, const Items& items, char close, int depth) {
    text_ += open;
    bool first = true;
    for (const auto& item : items) {
      text_ += first ? "\n" : ",\n";
      first = false;
      text_.append(std::size_t(depth) + 1, ' ');
      add(item, depth + 1);
      flush_some();
    }
    if (!first) text_.append(1, '\n').append(std::size_t(depth), ' ');
    text_ += close;
  }

  // An object with coefficients in or below it, but for its closing brace.
  void add_streamed(const Object& object) {
    text_ += '{';
    for (const Member& member : object.members) {
      const bool first = &member == &object.members.front();
      const Object* inner = member.value.get<Object>();
      if (!inner || !streams(*inner)) {
        text_ += first ? "\n " : ",\n ";
        add(member, 1);
        continue;
      }
      if (!first) text_ += ",\n ";
      add(member.key, 1);
      text_ += ": ";
      add_streamed(*inner);
      text_ += '}';
    }
  }

  const Sink& sink_;
  std::string text_;
};

} // namespace

Object program() {
  return {{"name", "cowgpu"}, {"version", version}};
}

void write_json(const Object& document, const Sink& sink) {
  Writer(sink).document(document);
}

std::string json_text(const Object& document) {
  std::string text;
  write_json(document, [&](std::string_view part) { text += part; });
  return text;
}

} // namespace cowgpu
