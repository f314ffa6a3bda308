#include "host/reproduce/row.hpp"

#include "host/error.hpp"
#include "host/number.hpp"

#include <fmt/format.h>

#include <cmath>

namespace cowgpu::reproduce {
namespace {

double number(std::string_view text) {
  const auto value = read_number(text);
  if (!value) throw Error(Fault::bad_argument, fmt::format("\"{}\" {}", text, not_a_number(text)));
  return *value;
}

std::string shown(const std::vector<std::string>& parts) {
  if (parts.size() == 1) return parts[0];
  const bool minus = parts[1].starts_with('-');
  return fmt::format("{} {} {}i", parts[0], minus ? '-' : '+', minus ? parts[1].substr(1) : parts[1]);
}

} // namespace

std::string_view name(Verdict verdict) {
  switch (verdict) {
  case Verdict::agrees: return "agrees";
  case Verdict::differs: return "differs";
  case Verdict::not_compared: return "not compared";
  case Verdict::not_computed: break;
  }
  return "not computed";
}

double last_digit(std::string_view printed) {
  (void)number(printed);
  const std::size_t exponent_at = printed.find_first_of("eE");
  const std::string_view digits = printed.substr(0, exponent_at);
  int exponent = exponent_at == std::string_view::npos ? 0 : int(number(printed.substr(exponent_at + 1)));
  if (const std::size_t point = digits.find('.'); point != std::string_view::npos)
    exponent -= int(digits.size() - point - 1);
  return number(fmt::format("1e{}", exponent));
}

Row compared(const paper::Printed& printed, std::vector<double> ours, std::string source) {
  Row row{printed.table, printed.item, shown(printed.parts), {}, std::move(ours), {}, {}, {}, std::move(source)};
  for (const std::string& part : printed.parts) row.paper.push_back(number(part));
  if (row.ours.size() != row.paper.size()) {
    row.ours.clear();
    row.reason = "it was not computed";
    return row;
  }
  row.verdict = Verdict::agrees;
  double square = 0;
  for (std::size_t i = 0; i < row.paper.size(); ++i) {
    const double difference = row.ours[i] - row.paper[i], unit = last_digit(printed.parts[i]);
    square += difference * difference;
    if (!(std::abs(difference) <= 0.5 * unit * (1 + 1e-9))) row.verdict = Verdict::differs;
  }
  row.difference = row.paper.size() == 1 ? row.ours[0] - row.paper[0] : std::sqrt(square);
  if (row.verdict == Verdict::differs) row.reason = printed.reason;
  return row;
}

} // namespace cowgpu::reproduce
