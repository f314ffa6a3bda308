#include "host/cli/commands.hpp"

#include "host/cli/quantities.hpp"
#include "host/io/document_json.hpp"
#include "host/requests/spectrum.hpp"

namespace cowgpu::cli {
namespace {

struct Options {
  std::string input, length_unit;
  bool cross = false;
  bool json = false;
};

void run(const Options& options, const Common& common) {
  SpectrumResult result = spectrum({options.input, stated_metres(options.length_unit), options.cross});
  result.command = common.command;
  if (options.json)
    write_json(document(result), write_stdout);
  else
    write_screen(result, write_stdout);
}

} // namespace

void add_spectrum(Command& app, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command = app.add_subcommand("spectrum", "Power per degree of coefficients in a file");
  command
      ->add_option("FILE", options->input,
                   "Coefficients of any format that `convert` reads, recognised by their content")
      ->required();
  add_length_unit_option(*command, options->length_unit, "FILE");
  command->add_flag("--cross", options->cross, "For two fields: their cross spectrum too");
  command->add_flag("--json", options->json, "As JSON (data/schemas/cowgpu.spectrum.v1.json)");
  command->footer(
      "S_l is the sum over m = -l ... l of |a_lm|^2 with orthonormal harmonics, whatever convention the file has; "
      "the\nS_l add up to the integral of f^2 over the unit sphere. Unit: the square of the field's. The bar is "
      "logarithmic\nbetween the powers of ten that its head names.\n"
      "Example: cowgpu expand --lmax 16 -o moments.csv && cowgpu spectrum moments.csv");
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
