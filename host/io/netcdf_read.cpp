#include "host/error.hpp"
#include "host/io/foreign_file.hpp"
#include "host/io/netcdf.hpp"
#include "host/io/shown.hpp"
#include "host/signals.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <netcdf.h>
#include <netcdf_mem.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <fstream>
#include <limits>

namespace cowgpu {
namespace {

constexpr std::uint64_t longest_text = 1 << 20;
constexpr std::uint64_t most_items = 100000;       // dimensions, variables, attributes of one thing
constexpr std::uint64_t best_compression = 1100;   // deflate cannot do better
constexpr rlim_t base_seconds = 5;                 // processor time for the reader, and for each
constexpr std::size_t bytes_a_second = 10'000'000; // so many bytes one more
constexpr std::uint64_t base_memory = std::uint64_t(1) << 30;

// What ends the reader: a status of the library or an absurd size.
struct Damage {
  std::string what;
};

void check(int status, const char* what) {
  if (status != NC_NOERR) throw Damage{fmt::format("{}: {}", what, nc_strerror(status))};
}

std::uint64_t largest_total(std::size_t file_size) {
  return best_compression * std::uint64_t(file_size);
}

// The reader's end of the pipe. Both sides run the same program, so numbers go as they lie in memory.
class Sender {
public:
  explicit Sender(int fd) : fd_(fd) {}
  void number(std::uint64_t value) { bytes(&value, sizeof value); }
  void real(double value) { bytes(&value, sizeof value); }
  void text(std::string_view value) {
    number(value.size());
    bytes(value.data(), value.size());
  }
  void bytes(const void* data, std::size_t size) {
    const char* at = static_cast<const char*>(data);
    while (size > 0) {
      const ssize_t done = ::write(fd_, at, size);
      if (done < 0 && errno == EINTR) continue;
      if (done <= 0) _exit(2);
      at += done;
      size -= std::size_t(done);
    }
  }

private:
  int fd_;
};

void send_attribute(Sender& out, int file, int variable, int i) {
  std::array<char, NC_MAX_NAME + 1> name{};
  nc_type type = NC_NAT;
  std::size_t length = 0;
  check(nc_inq_attname(file, variable, i, name.data()), "an attribute");
  check(nc_inq_att(file, variable, name.data(), &type, &length), "an attribute");
  if (length > longest_text) throw Damage{"an attribute is too long"};
  std::string text;
  double number = std::numeric_limits<double>::quiet_NaN();
  bool is_text = false;
  if (type == NC_CHAR) {
    is_text = true;
    text.resize(length);
    if (length > 0) check(nc_get_att_text(file, variable, name.data(), text.data()), "an attribute");
  } else if (type == NC_STRING && length == 1) {
    is_text = true;
    char* string = nullptr;
    check(nc_get_att_string(file, variable, name.data(), &string), "an attribute");
    if (string) text = std::string(string).substr(0, longest_text);
  } else if (type < NC_STRING && length > 0) {
    std::vector<double> numbers(length);
    check(nc_get_att_double(file, variable, name.data(), numbers.data()), "an attribute");
    number = numbers.front();
  }
  out.text(name.data());
  out.number(is_text);
  out.text(text.substr(0, text.find_last_not_of('\0') + 1));
  out.real(number);
}

void send_variable(Sender& out, int file, int variable, std::size_t file_size) {
  std::array<char, NC_MAX_NAME + 1> name{};
  nc_type type = NC_NAT;
  int rank = 0, attributes = 0;
  check(nc_inq_varndims(file, variable, &rank), "a variable");
  if (rank < 0 || rank > NC_MAX_VAR_DIMS) throw Damage{"a variable has an absurd number of dimensions"};
  std::vector<int> dimensions(std::size_t(rank) + 1);
  check(nc_inq_var(file, variable, name.data(), &type, &rank, dimensions.data(), &attributes), "a variable");
  out.text(name.data());
  out.number(std::uint64_t(rank));
  std::uint64_t total = 1;
  std::vector<std::size_t> lengths;
  for (int d = 0; d < rank; ++d) {
    std::size_t length = 0;
    check(nc_inq_dimlen(file, dimensions[std::size_t(d)], &length), "a dimension");
    lengths.push_back(length);
    out.number(std::uint64_t(dimensions[std::size_t(d)]));
    total = length && total > largest_total(file_size) / length ? largest_total(file_size) + 1 : total * length;
  }
  out.number(std::uint64_t(attributes));
  for (int i = 0; i < attributes; ++i) send_attribute(out, file, variable, i);
  const bool numbers = type != NC_CHAR && type > NC_NAT && type < NC_STRING;
  int longer = 0, first_long = -1; // number of dimensions longer than 1, and the first of them
  for (int d = 0; d < rank; ++d) {
    if (lengths[std::size_t(d)] <= 1) continue;
    if (first_long < 0) first_long = d;
    ++longer;
  }
  const bool wanted = numbers && rank >= 1 && longer <= 2;
  if (wanted && total > largest_total(file_size))
    throw Damage{fmt::format("variable {} is larger than the file can hold", shown(name.data()))};
  out.number(wanted);
  if (!wanted) return;
  out.number(type == NC_FLOAT);
  out.number(total);
  if (total == 0) return;
  // By slices of the first of two longer dimensions: no second copy of the field.
  const std::size_t rows = longer == 2 ? lengths[std::size_t(first_long)] : 1;
  const auto row_length = std::size_t(total / rows);
  const std::size_t step = std::max<std::size_t>(1, (std::size_t(1) << 20) / row_length);
  std::vector<double> values(std::min(rows, step) * row_length);
  std::vector<std::size_t> start(lengths.size(), 0), count = lengths;
  for (std::size_t i = 0; i < rows; i += step) {
    const std::size_t n = std::min(step, rows - i);
    if (longer == 2) {
      start[std::size_t(first_long)] = i;
      count[std::size_t(first_long)] = n;
    }
    check(nc_get_vara_double(file, variable, start.data(), count.data(), values.data()), name.data());
    out.bytes(values.data(), n * row_length * sizeof(double));
  }
}

// What the reader does: 1, the contents, 1; or at any place it ends, with the reason on the second pipe.
void send_file(Sender& out, std::string& bytes) {
  int file = 0, count = 0, attributes = 0;
  // A fixed name: the library takes others for addresses on the net.
  check(nc_open_mem("cowgpu", NC_NOWRITE, bytes.size(), bytes.data(), &file), "the file");
  check(nc_inq_ndims(file, &count), "the dimensions");
  out.number(std::uint64_t(count));
  for (int d = 0; d < count; ++d) {
    std::array<char, NC_MAX_NAME + 1> name{};
    std::size_t length = 0;
    check(nc_inq_dim(file, d, name.data(), &length), "a dimension");
    out.text(name.data());
    out.number(length);
  }
  check(nc_inq_natts(file, &attributes), "the attributes");
  out.number(std::uint64_t(attributes));
  for (int i = 0; i < attributes; ++i) send_attribute(out, file, NC_GLOBAL, i);
  check(nc_inq_nvars(file, &count), "the variables");
  out.number(std::uint64_t(count));
  for (int v = 0; v < count; ++v) send_variable(out, file, v, bytes.size());
}

void limit(int what, std::uint64_t value) {
  const struct rlimit bound { rlim_t(value), rlim_t(value) };
  setrlimit(decltype(RLIMIT_CPU)(what), &bound);
}

[[noreturn]] void run_reader(std::string& bytes, int results, int reasons) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : ending_signals())
    if (std::signal(signal, SIG_DFL) == SIG_IGN) std::signal(signal, SIG_IGN);
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE}) std::signal(signal, SIG_DFL);
  const int null = open("/dev/null", O_WRONLY);
  if (null >= 0) dup2(null, STDERR_FILENO);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, base_seconds + bytes.size() / bytes_a_second);
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  if (pages > 0) limit(RLIMIT_AS, pages * std::uint64_t(sysconf(_SC_PAGE_SIZE)) + base_memory + 16 * bytes.size());
  try {
    Sender out(results);
    send_file(out, bytes);
    out.text("whole");
    _exit(0);
  } catch (const Damage& damage) {
    Sender(reasons).bytes(damage.what.data(), std::min<std::size_t>(damage.what.size(), 1000));
  } catch (...) {
    Sender(reasons).bytes("it asks for absurd memory", 25);
  }
  _exit(1);
}

struct Ends {
  std::array<int, 2> fd = {-1, -1};
  Ends() {
    if (pipe2(fd.data(), O_CLOEXEC) != 0)
      throw Error(Fault::cannot_read, "a pipe to read a netCDF file could not be opened");
  }
  ~Ends() {
    shut(0);
    shut(1);
  }
  Ends(const Ends&) = delete;
  Ends& operator=(const Ends&) = delete;
  void shut(int which) {
    if (fd[std::size_t(which)] >= 0) close(fd[std::size_t(which)]);
    fd[std::size_t(which)] = -1;
  }
};

// Our end. Everything is bounded before it is allocated: the reader may have been led astray.
class Receiver {
public:
  explicit Receiver(int fd) : fd_(fd) {}
  void bytes(void* data, std::size_t size) {
    char* at = static_cast<char*>(data);
    while (size > 0) {
      const ssize_t got = ::read(fd_, at, size);
      if (got < 0) throw Error(Fault::cannot_read, "a signal ended the wait for a netCDF file");
      if (got == 0) throw Damage{""};
      at += got;
      size -= std::size_t(got);
    }
  }
  std::uint64_t number(std::uint64_t largest) {
    std::uint64_t value = 0;
    bytes(&value, sizeof value);
    if (value > largest) throw Damage{"absurd sizes"};
    return value;
  }
  double real() {
    double value = 0;
    bytes(&value, sizeof value);
    return value;
  }
  std::string text() {
    std::string value(number(longest_text), '\0');
    bytes(value.data(), value.size());
    return value;
  }
  std::vector<NetcdfAttribute> attributes() {
    std::vector<NetcdfAttribute> list(number(most_items));
    for (NetcdfAttribute& a : list) {
      a.name = text();
      a.is_text = number(1) == 1;
      a.text = text();
      a.number = real();
    }
    return list;
  }
  NetcdfFile file(std::size_t file_size) {
    NetcdfFile file;
    file.dimensions.resize(number(most_items));
    for (NetcdfDimension& d : file.dimensions) {
      d.name = text();
      d.length = number(std::numeric_limits<std::uint64_t>::max());
    }
    file.attributes = attributes();
    file.variables.resize(number(most_items));
    for (NetcdfVariable& v : file.variables) {
      v.name = text();
      v.dimensions.resize(number(NC_MAX_VAR_DIMS));
      std::uint64_t total = 1;
      for (std::size_t& d : v.dimensions) {
        d = number(most_items);
        if (d >= file.dimensions.size()) throw Damage{"a dimension that is not there"};
        total *= file.dimensions[d].length;
      }
      v.attributes = attributes();
      v.read = number(1) == 1;
      if (!v.read) continue;
      v.single = number(1) == 1;
      v.values.resize(number(largest_total(file_size)));
      if (v.values.size() != total) throw Damage{"sizes that do not fit each other"};
      bytes(v.values.data(), v.values.size() * sizeof(double));
    }
    if (text() != "whole") throw Damage{"absurd contents"};
    return file;
  }

private:
  int fd_;
};

} // namespace

const NetcdfAttribute* attribute(const std::vector<NetcdfAttribute>& list, std::string_view name) {
  for (const NetcdfAttribute& a : list)
    if (a.name == name) return &a;
  return nullptr;
}

double present_value(const NetcdfVariable& variable, std::size_t at) {
  constexpr double default_fill = 9.9692099683868690e+36; // NC_FILL_DOUBLE and NC_FILL_FLOAT
  const double value = variable.values[at];
  const auto number = [&](const char* key) {
    const NetcdfAttribute* a = attribute(variable.attributes, key);
    return a && !a->is_text ? a : nullptr;
  };
  bool missing = !number("_FillValue") && value == default_fill;
  for (const char* key : {"_FillValue", "missing_value"})
    if (const NetcdfAttribute* fill = number(key)) missing = missing || value == fill->number;
  for (const char* key : {"valid_min", "valid_range"})
    if (const NetcdfAttribute* low = number(key)) missing = missing || value < low->number;
  if (const NetcdfAttribute* high = number("valid_max")) missing = missing || value > high->number;
  if (missing) return std::nan("");
  const NetcdfAttribute *scale = number("scale_factor"), *offset = number("add_offset");
  return (scale ? value * scale->number : value) + (offset ? offset->number : 0);
}

const NetcdfVariable* NetcdfFile::variable(std::string_view variable_name) const {
  for (const NetcdfVariable& v : variables)
    if (v.name == variable_name) return &v;
  return nullptr;
}

void sort_fields(std::vector<const NetcdfVariable*>& variables) {
  const auto place = [](const NetcdfVariable* v) {
    const NetcdfAttribute* a = attribute(v->attributes, "field");
    return a && a->number >= 1 ? a->number : std::numeric_limits<double>::infinity(); // NaN is no place
  };
  std::stable_sort(variables.begin(), variables.end(),
                   [&](const NetcdfVariable* a, const NetcdfVariable* b) { return place(a) < place(b); });
}

NetcdfFile read_netcdf(const std::filesystem::path& path) {
  return parse_netcdf(read_input_file(path), path.string());
}

NetcdfFile parse_netcdf(std::string bytes, const std::string& name) {
  if (!bytes.starts_with("\x89HDF\r\n\x1a\n") && !bytes.starts_with("CDF\x01") && !bytes.starts_with("CDF\x02") &&
      !bytes.starts_with("CDF\x05"))
    throw Error(Fault::file_format,
                fmt::format("{}: this is not a netCDF file: it begins with neither HDF nor CDF; a name "
                            "that ends in .csv is read as text",
                            name));
  Ends results, reasons;
  const pid_t reader = fork();
  if (reader < 0) throw Error(Fault::cannot_read, fmt::format("{}: a process to read it could not be started", name));
  if (reader == 0) run_reader(bytes, results.fd[1], reasons.fd[1]);
  results.shut(1);
  reasons.shut(1);
  const std::size_t size = bytes.size();
  std::string().swap(bytes); // the reader has it

  // The reader ends by itself, or by SIGPIPE's error once our end is closed.
  const auto end_reader = [&](bool kill_it) {
    if (kill_it) kill(reader, SIGKILL);
    results.shut(0);
    while (waitpid(reader, nullptr, 0) < 0 && errno == EINTR) {
    }
  };
  try {
    NetcdfFile file = Receiver(results.fd[0]).file(size);
    end_reader(false);
    file.name = name;
    return file;
  } catch (const Damage& damage) {
    end_reader(!damage.what.empty());
    std::string why(1000, '\0');
    const ssize_t got = ::read(reasons.fd[0], why.data(), why.size());
    why.resize(got > 0 ? std::size_t(got) : 0);
    if (why.empty()) why = damage.what.empty() ? "the netCDF library fails on it" : damage.what;
    throw Error(Fault::file_format,
                fmt::format("{}: the netCDF file is damaged or incomplete ({}). Fetch or write it again", name, why));
  } catch (const Error& error) {
    end_reader(true);
    throw Error(error.fault(), fmt::format("{}: {}", name, error.what()));
  } catch (...) {
    end_reader(true);
    throw;
  }
}

} // namespace cowgpu
