#include "host/error.hpp"
#include "host/io/netcdf.hpp"
#include "host/io/shown.hpp"

#include <fmt/format.h>
#include <netcdf.h>
#include <netcdf_mem.h>

#include <cstdlib>
#include <limits>
#include <memory>

namespace cowgpu {
namespace {

void check(int status) {
  if (status == NC_NOERR) return;
  const bool memory = status == NC_ENOMEM || status == NC_EHDFERR; // in memory, HDF5 has no other reason to fail
  throw Error(memory ? Fault::too_large : Fault::cannot_write,
              fmt::format("the netCDF library cannot build the file: {}", nc_strerror(status)));
}

int place(int variable) {
  return variable == NetcdfWriter::global ? NC_GLOBAL : variable;
}

} // namespace

NetcdfWriter::NetcdfWriter() {
  check(nc_create_mem("cowgpu", NC_NETCDF4, 0, &id_));
}

NetcdfWriter::~NetcdfWriter() {
  if (id_ < 0) return;
  NC_memio bytes{};
  if (nc_close_memio(id_, &bytes) == NC_NOERR) std::free(bytes.memory);
}

int NetcdfWriter::dimension(const std::string& name, std::size_t length) {
  int id = 0;
  check(nc_def_dim(id_, name.c_str(), length, &id));
  return id;
}

int NetcdfWriter::variable(const std::string& name, Type type, std::span<const int> dimensions) {
  int id = 0;
  check(nc_def_var(id_, name.c_str(), type == Type::real ? NC_DOUBLE : NC_INT64, int(dimensions.size()),
                   dimensions.data(), &id));
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  if (type == Type::real) check(nc_put_att_double(id_, id, "_FillValue", NC_DOUBLE, 1, &nan));
  return id;
}

// An empty text is one NUL, as xarray writes it.
void NetcdfWriter::attribute(int variable, const std::string& name, std::string_view given) {
  const std::string safe = one_line(given);
  const std::string_view text = safe.empty() ? std::string_view("\0", 1) : std::string_view(safe);
  check(nc_put_att_text(id_, place(variable), name.c_str(), text.size(), text.data()));
}

void NetcdfWriter::attribute(int variable, const std::string& name, double number) {
  check(nc_put_att_double(id_, place(variable), name.c_str(), NC_DOUBLE, 1, &number));
}

void NetcdfWriter::attribute(int variable, const std::string& name, std::int64_t number) {
  const auto value = static_cast<long long>(number);
  check(nc_put_att_longlong(id_, place(variable), name.c_str(), NC_INT64, 1, &value));
}

void NetcdfWriter::values(int variable, std::span<const double> values) {
  check(nc_put_var_double(id_, variable, values.data()));
}

void NetcdfWriter::row(int variable, std::size_t i, std::span<const double> values) {
  const std::size_t start[] = {i, 0}, count[] = {1, values.size()};
  check(nc_put_vara_double(id_, variable, start, count, values.data()));
}

void NetcdfWriter::write_to(AtomicFile& file) {
  NC_memio bytes{};
  const int id = id_;
  id_ = -1;
  check(nc_close_memio(id, &bytes));
  const std::unique_ptr<void, decltype(&std::free)> owner(bytes.memory, &std::free);
  file.write({static_cast<const char*>(bytes.memory), bytes.size});
}

} // namespace cowgpu
