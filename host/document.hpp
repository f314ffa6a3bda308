// A result as a document: members in order, each with a value. host/io/document_json.hpp writes it as JSON.
#pragma once

#include "host/types.hpp"

#include <Eigen/Core>

#include <array>
#include <concepts>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace cowgpu {

/// Where text goes: a stream or a file.
using Sink = std::function<void(std::string_view)>;

struct Value;
struct Member;
using List = std::vector<Value>;
using Numbers = std::vector<double>; ///< a list of numbers, in less memory

/// Members in their order; no key stands twice.
struct Object {
  std::vector<Member> members;

  // What makes and copies members is defined below them.
  Object() noexcept;
  Object(std::initializer_list<Member> list);
  Object(const Object& other);
  Object(Object&& other) noexcept;
  Object& operator=(const Object& other);
  Object& operator=(Object&& other) noexcept;
  ~Object();

  /// At the end.
  void add(std::string key, Value value);
  void add(const Object& more);
};

/// The table of coefficients to degree lmax: for each l and m >= 0, by l, then m, a row [l, m, numbers...]. A document may hold
/// more of them than fit into memory: row(l, m, numbers) appends the numbers of one row, when the document is written. What
/// row() refers to must live until then.
struct CoefficientRows {
  int lmax = -1;
  std::function<void(int l, int m, Numbers& numbers)> row;
};

/// A value of any kind. Nothing (std::monostate) is what is not known; numbers that are not finite are written like it. A
/// matrix is a list of rows.
struct Value {
  std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string, Vec3, Eigen::Matrix3d, Numbers,
               List, Object, CoefficientRows>
      content;

  Value() = default;
  Value(std::monostate) {}
  Value(bool value) : content(value) {}
  template <std::integral T>
  Value(T value) : content(std::conditional_t<std::is_signed_v<T>, std::int64_t, std::uint64_t>(value)) {}
  template <std::floating_point T>
  Value(T value) : content(double(value)) {}
  Value(const char* text) : content(std::string(text)) {}
  Value(std::string_view text) : content(std::string(text)) {}
  Value(std::string text) : content(std::move(text)) {}
  Value(const Vec3& value) : content(value) {}
  Value(const Eigen::Matrix3d& value) : content(value) {}
  Value(Numbers values) : content(std::move(values)) {}
  Value(List values) : content(std::move(values)) {}
  Value(Object object) : content(std::move(object)) {}
  Value(CoefficientRows rows) : content(std::move(rows)) {}
  template <class T>
  Value(std::span<const T> values) : content(List(values.begin(), values.end())) {}
  Value(std::span<const double> values) : content(Numbers(values.begin(), values.end())) {}
  template <class T>
  Value(const std::vector<T>& values) : Value(std::span<const T>(values)) {}
  template <class T, std::size_t N>
  Value(const std::array<T, N>& values) : Value(std::span<const T>(values)) {}
  template <class T>
  Value(const std::optional<T>& value) {
    if (value) *this = Value(*value);
  }

  template <class T>
  const T* get() const {
    return std::get_if<T>(&content);
  }
};

struct Member {
  std::string key;
  Value value;
};

inline Object::Object() noexcept = default;
inline Object::Object(std::initializer_list<Member> list) : members(list) {}
inline Object::Object(const Object& other) = default;
inline Object::Object(Object&& other) noexcept = default;
inline Object& Object::operator=(const Object& other) = default;
inline Object& Object::operator=(Object&& other) noexcept = default;
inline Object::~Object() = default;

inline void Object::add(std::string key, Value value) {
  members.push_back({std::move(key), std::move(value)});
}

inline void Object::add(const Object& more) {
  members.insert(members.end(), more.members.begin(), more.members.end());
}

/// Nothing for an empty text.
inline Value known_text(const std::string& text) {
  return text.empty() ? Value() : Value(text);
}

} // namespace cowgpu
