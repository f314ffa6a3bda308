#include "host/monitor.hpp"

#include "host/error.hpp"

namespace cowgpu {

Monitor& silent_monitor() {
  static Monitor silent;
  return silent;
}

void check_stop(const Monitor& monitor) {
  if (monitor.stopped()) throw Error(Fault::interrupted, "interrupted: nothing was written");
}

} // namespace cowgpu
