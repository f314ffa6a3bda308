// The force that tips a cow of 2.5 m over, and each of its first orders.
#include <cowgpu/cowgpu.hpp>

#include <cstdio>

int main(int argc, char** argv) try {
  cowgpu::TipRequest request;
  request.body.mesh = argc > 1 ? argv[1] : "builtin:cow@1";
  request.body.length = 2.5;
  request.body.density = 1000;
  request.orders = {0, 1, 2, 3, 4, 5, 6, 7};
  cowgpu::Monitor monitor;
  const auto backend = cowgpu::make_cpu_backend();
  const cowgpu::TipResult result = cowgpu::tip(request, *backend, monitor);
  std::printf("mass %.12g kg, force %.12g N\n", result.body.mass,
              result.forces.chosen().force * result.forces.weight());
  for (const cowgpu::TippedOrder& order : result.orders)
    if (order.forces)
      std::printf("order %d: %.12g N\n", order.order, order.forces->chosen().force * order.forces->weight());
    else
      std::printf("order %d: %s\n", order.order, order.note.c_str());
} catch (const cowgpu::Error& error) {
  std::fprintf(stderr, "tip: %s\n", error.what());
  return cowgpu::exit_code(error.fault());
}
