#include "host/cli/order_list.hpp"

#include "host/error.hpp"
#include "host/io/shown.hpp"
#include "host/number.hpp"
#include "host/requests/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <string_view>

namespace cowgpu::cli {
namespace {

std::optional<int> number(std::string_view text) {
  return read_whole(text, 0, largest_surface_degree);
}

} // namespace

std::vector<int> parse_orders(const std::vector<std::string>& lists, std::string_view whole) {
  std::vector<int> orders;
  const auto add = [&](int order) {
    if (std::find(orders.begin(), orders.end(), order) == orders.end()) orders.push_back(order);
  };
  for (const std::string& list : lists) {
    std::istringstream words(list + ",");
    for (std::string word; std::getline(words, word, ',');) {
      if (!whole.empty() && word == whole) {
        add(whole_mesh);
        continue;
      }
      const std::size_t dots = word.find("..");
      const auto first = number(std::string_view(word).substr(0, dots));
      const auto last = dots == std::string::npos ? first : number(std::string_view(word).substr(dots + 2));
      if (first && last && *last < *first)
        throw Error(Fault::bad_argument,
                    fmt::format("--order {}: the range \"{}\" runs backwards; write the lower order first", shown(list),
                                shown(word)));
      if (!first || !last)
        throw Error(
            Fault::bad_argument,
            fmt::format("--order {}: \"{}\" is not an order; orders are whole numbers from 0 to {}, ranges such as "
                        "0..7{}, separated by commas",
                        shown(list), shown(word), largest_surface_degree,
                        whole.empty() ? "" : fmt::format(", and {} for the body itself", whole)));
      for (int order = *first; order <= *last; ++order) add(order);
    }
  }
  return orders;
}

} // namespace cowgpu::cli
