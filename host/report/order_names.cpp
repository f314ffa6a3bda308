#include "host/report/order_names.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

#include <iterator>

namespace cowgpu {

std::string order_name(int l) {
  static constexpr const char* names[] = {"monopole",
                                          "dipole",
                                          "quadrupole",
                                          "octupole",
                                          "hexadecapole",
                                          "dotriacontapole",
                                          "tetrahexacontapole",
                                          "octacosahectapole",
                                          "hexapentacontadictapole",
                                          "dodecapentactapole",
                                          "tetracosakiliapole",
                                          "octatetracontadiliapole",
                                          "hexanonacontatetraliapole",
                                          "dononacontahectaoctaliapole"};
  if (l < 0) throw Error(Fault::bad_argument, fmt::format("there is no multipole of degree {}", l));
  return std::size_t(l) < std::size(names) ? names[l] : fmt::format("2^{}-pole", l);
}

} // namespace cowgpu
