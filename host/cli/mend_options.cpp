#include "host/cli/mend_options.hpp"

namespace cowgpu::cli {

void add_mend_options(Command& command, Mending& mending) {
  command
      .add_option("--weld", mending.weld,
                  "Mend: merge vertices within EPS of each other, in the mesh's unit (0: at one point exactly)")
      ->check(non_negative_number())
      ->type_name("EPS");
  command.add_flag("--orient", mending.orient,
                   "Mend: turn faces so that each shell is consistent and looks outwards, cavities inwards");
  command.add_flag("--largest-shell", mending.largest_shell, "Mend: keep the shell of the largest volume only");
}

} // namespace cowgpu::cli
