// From the engine's failures to the host's faults.
#pragma once

#include "engine/gpu.hpp"
#include "host/error.hpp"
#include "host/monitor.hpp"

namespace cowgpu::gpu {

inline Fault fault_of(engine::Failure failure) {
  switch (failure) {
  case engine::Failure::no_loader: return Fault::no_loader;
  case engine::Failure::no_device: return Fault::no_device;
  case engine::Failure::no_fp64: return Fault::no_fp64;
  case engine::Failure::out_of_range: return Fault::too_large;
  case engine::Failure::cut_short:
  case engine::Failure::vulkan: return Fault::device_failed;
  case engine::Failure::device_lost: return Fault::device_lost;
  case engine::Failure::stopped: return Fault::interrupted;
  }
  return Fault::device_failed;
}

/// Runs `call`, turning engine::Error into cowgpu::Error.
template <class Call>
auto translated(const Call& call) {
  try {
    return call();
  } catch (const engine::Error& error) {
    throw Error(fault_of(error.failure()), error.what());
  }
}

/// Runs `call`; waits for the device end soon once the monitor says stop.
template <class Call>
auto watched(engine::Gpu& gpu, const Monitor& monitor, const Call& call) {
  const engine::StopScope stop(gpu, [&monitor] { return monitor.stopped(); });
  return translated(call);
}

} // namespace cowgpu::gpu
