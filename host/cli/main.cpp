#include "host/cli/child.hpp"
#include "host/cli/commands.hpp"
#include "host/error.hpp"
#include "host/io/shown.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

#include <cstring>
#include <new>

using namespace cowgpu;

namespace {

int fail(const char* name, const char* what, int code) {
  cli::say(fmt::format("cowgpu: error [{}]: {}\n", name, one_line(what)));
  return code;
}

int run(int argc, char** argv) {
  CLI::App app("Exact multipole moments of triangle meshes, on the GPU and on the CPU");
  app.set_version_flag("--version", std::string("cowgpu ") + version);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 ok, 1 a numeric check failed, 2 usage, 3 bad input, 4 no or lost device, 5 input/output, "
      "130 interrupted.\nFirst steps: cowgpu expand --lmax 8; cowgpu expand MESH.off --lmax 512 -o moments.json");
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
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
      known = known || command->get_name() == argv[1];
      there += (there.empty() ? "" : ", ") + command->get_name();
    }
    if (!known)
      return fail(name(Fault::bad_argument).data(),
                  fmt::format("there is no command '{}'; there are {}", argv[1], there).c_str(), 2);
  }
  try {
    app.parse(argc, argv);
    cli::flush_stdout();
    return common.exit_code;
  } catch (const CLI::Success& help) {
    app.exit(help);
    cli::flush_stdout();
    return 0;
  } catch (const CLI::ParseError& error) {
    std::string command = "cowgpu";
    for (const CLI::App* at = &app; !at->get_subcommands().empty();) {
      at = at->get_subcommands().front();
      command += " " + at->get_name();
    }
    return fail(name(Fault::bad_argument).data(), fmt::format("{}; see `{} --help`", error.what(), command).c_str(), 2);
  }
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
    const Fault fault = cli::stop_requested ? Fault::interrupted : error.fault();
    return fail(name(fault).data(), error.what(), exit_code(fault));
  } catch (const std::bad_alloc&) {
    return fail("too-large", "this machine has not enough memory for this; lower --lmax or take a smaller mesh", 3);
  } catch (const std::exception& error) {
    return fail("internal", error.what(), 70);
  }
}
