#include "host/cli/child.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/stop.hpp"
#include "host/error.hpp"
#include "host/io/shown.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <new>
#include <stdexcept>

using namespace cowgpu;

namespace {

int fail(const char* name, const char* what, int code) {
  cli::say(fmt::format("cowgpu: error [{}]: {}\n", name, one_line(what)));
  return code;
}

int run(int argc, char** argv) {
  cli::CommandLine app("cowgpu", "Exact multipole moments of triangle meshes, on the GPU and on the CPU");
  app.set_version(std::string("cowgpu ") + version);
  app.require_subcommand(1);
  app.footer("Exit codes: 0 ok, 1 a numeric check failed, 2 usage, 3 bad input, 4 no or lost device, 5 input/output, "
             "130 interrupted (128 + n by another signal n).\nNumbers are decimal and finite, with a point and perhaps "
             "an exponent (1e-3); whole "
             "numbers are "
             "digits alone, after a sign perhaps (010 is ten).\nFirst steps: cowgpu expand --lmax 8; cowgpu expand "
             "MESH.off --lmax 512 -o moments.json");
  cli::Common common;
  common.command.assign(argv, argv + argc);
  cli::add_expand(app, common);
  cli::add_validate(app, common);
  cli::add_transform(app, common);
  cli::add_spectrum(app, common);
  cli::add_convert(app, common);
  cli::add_diff(app, common);
  cli::add_map(app, common);
  cli::add_reconstruct(app, common);
  cli::add_report(app, common);
  cli::add_inflate(app, common);
  cli::add_distance(app, common);
  cli::add_streamlines(app, common);
  cli::add_figure(app, common);
  cli::add_physics(app, common);
  cli::add_surface(app, common);
  cli::add_reproduce(app, common);
  cli::add_errata(app, common);
  cli::add_inspect(app, common);
  cli::add_meshes(app);
  cli::add_devices(app, common);
  cli::add_render(app, common);
  cli::add_bench(app, common);
  cli::add_manual(app);
  // A name with one would break every line that tells of it.
  for (int i = 1; i < argc; ++i)
    if (std::strpbrk(argv[i], "\r\n"))
      return fail(name(Fault::bad_argument).data(),
                  fmt::format("argument {}, '{}', holds a line end, and no option and no file that this program takes "
                              "does; rename the file",
                              i, shown(argv[i], 60))
                      .c_str(),
                  2);
  if (argc > 1 && argv[1][0] != '-') {
    std::string there;
    bool known = false;
    for (const std::string& command : app.command_names()) {
      known = known || command == argv[1];
      there += (there.empty() ? "" : ", ") + command;
    }
    if (!known)
      return fail(name(Fault::bad_argument).data(),
                  fmt::format("there is no command '{}'; there are {}", argv[1], there).c_str(), 2);
  }
  const cli::Parsed parsed = app.parse(argc, argv);
  if (!parsed.complaint.empty()) return fail(name(Fault::bad_argument).data(), parsed.complaint.c_str(), 2);
  cli::flush_stdout();
  return parsed.help ? 0 : common.exit_code;
}

} // namespace

int main(int argc, char** argv) {
  cli::open_standard_streams();
  cli::catch_signals();
  cli::end_with_parent();
  try {
    return run(argc, argv);
  } catch (const Error& error) {
    // Whatever fails once the user has asked to stop fails because of that.
    const bool stopped = cli::stop_requested;
    const Fault fault = stopped ? Fault::interrupted : error.fault();
    const int code = fail(name(fault).data(), (error.what() + cli::stop_reason()).c_str(),
                          stopped ? cli::stop_exit_code() : exit_code(fault));
    if (!stopped && fault != Fault::device_lost) return code;
    // A device that was given up may still run: the end of the process must not take anything from under its threads.
    std::fflush(nullptr);
    std::_Exit(code);
  } catch (const std::bad_alloc&) {
    return fail("too-large", "this machine has not enough memory for this; lower --lmax or take a smaller mesh", 3);
  } catch (const std::length_error&) {
    return fail("too-large", "this is more than any machine's memory holds; lower --lmax or take a smaller mesh", 3);
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(name(Fault::cannot_read).data(), error.what(), exit_code(Fault::cannot_read));
  } catch (const std::exception& error) {
    return fail("internal", error.what(), 70);
  }
}
