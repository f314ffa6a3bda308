#include "tests/support/gravity_model.hpp"

#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

namespace cowgpu::test {

GravityModel read_gravity_model(const std::string& path) {
  std::ifstream file(path);
  GravityModel model;
  std::string line;
  bool head = true;
  std::size_t rows = 0;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string key, value;
    words >> key;
    if (head) {
      if (key == "#") {
        words >> key;
        std::getline(words >> std::ws, value);
        model.comments.emplace(key, value);
      } else if (key == "end_of_head") {
        head = false;
        model.lmax = std::stoi(model.head.at("max_degree"));
        model.c.resize(std::size_t(model.lmax) + 1);
        for (std::size_t l = 0; l < model.c.size(); ++l) model.c[l].assign(l + 1, NAN);
        model.s = model.c;
      } else if (words >> value) {
        model.head[key] = value;
      }
      continue;
    }
    std::string c, s;
    std::size_t l = 0, m = 0;
    if (key != "gfc" || !(words >> l >> m >> c >> s)) throw std::runtime_error("not a row: " + line);
    model.c.at(l).at(m) = std::stod(c);
    model.s.at(l).at(m) = std::stod(s);
    ++rows;
  }
  if (head || model.head.at("product_type") != "gravity_field" || model.head.at("norm") != "fully_normalized" ||
      rows != std::size_t(model.lmax + 1) * std::size_t(model.lmax + 2) / 2)
    throw std::runtime_error(path + " is no complete gravity model");
  return model;
}

GravityModel read_gravity_table(const std::string& path, double metres) {
  std::ifstream file(path);
  GravityModel model;
  std::string line;
  const auto numbers = [&line] {
    for (char& c : line)
      if (c == ',') c = ' ';
    std::istringstream words(line);
    return std::vector<double>(std::istream_iterator<double>(words), std::istream_iterator<double>());
  };
  std::getline(file, line);
  const std::vector<double> head = numbers();
  if (head.size() < 4) throw std::runtime_error(path + " is no gravity table");
  std::ostringstream radius, gm;
  radius.precision(17);
  gm.precision(17);
  radius << head[0] * metres;
  gm << head[1] * metres * metres * metres;
  model.head = {{"radius", radius.str()}, {"earth_gravity_constant", gm.str()}};
  model.lmax = int(head[3]);
  for (int l = 0; l <= model.lmax; ++l) model.c.emplace_back(l + 1, l < 2 ? double(l == 0) : NAN);
  model.s = model.c;
  model.s[0][0] = 0;
  while (std::getline(file, line)) {
    const std::vector<double> row = numbers();
    if (row.empty()) continue;
    if (row.size() < 4) throw std::runtime_error(path + " has a short row");
    model.c.at(std::size_t(row[0])).at(std::size_t(row[1])) = row[2];
    model.s.at(std::size_t(row[0])).at(std::size_t(row[1])) = row[3];
  }
  return model;
}

long double GravityModel::potential(long double x, long double y, long double z) const {
  using Real = long double;
  const Real r = std::sqrt(x * x + y * y + z * z), u = z / r, sine = std::sqrt(x * x + y * y) / r;
  const Real phi = std::atan2(y, x), ratio = std::stold(head.at("radius")) / r;
  const auto n = std::size_t(lmax) + 1;
  std::vector<Real> degree(n, 0);
  Real sectoral = 1; // P_mm, fully normalised
  for (std::size_t m = 0; m < n; ++m) {
    if (m == 1) sectoral = std::sqrt(Real(3)) * sine;
    if (m > 1) sectoral *= sine * std::sqrt(Real(2 * m + 1) / Real(2 * m));
    Real before = 0, here = sectoral;
    for (std::size_t l = m; l < n; ++l) {
      degree[l] += here * (c[l][m] * std::cos(Real(m) * phi) + s[l][m] * std::sin(Real(m) * phi));
      const Real k = Real(l + 1), mm = Real(m);
      const Real a = std::sqrt((2 * k - 1) * (2 * k + 1) / ((k - mm) * (k + mm)));
      const Real b =
          l == m ? 0 : std::sqrt((2 * k + 1) * (k + mm - 1) * (k - mm - 1) / ((k - mm) * (k + mm) * (2 * k - 3)));
      const Real after = a * u * here - b * before;
      before = here;
      here = after;
    }
  }
  Real sum = 0, power = 1;
  for (std::size_t l = 0; l < n; ++l, power *= ratio) sum += power * degree[l];
  return std::stold(head.at("earth_gravity_constant")) / r * sum;
}

} // namespace cowgpu::test
