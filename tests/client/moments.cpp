// The moments of arrays of vertices and faces, on the CPU or a GPU: the component `moments` alone.
#include <cowgpu/moments.hpp>

#include <cstdio>

int main() try {
  cowgpu::RawMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  mesh.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const cowgpu::Body body = cowgpu::make_body(cowgpu::ClosedSurface::from(mesh), {}, 1);
  cowgpu::Monitor monitor;
  const auto backend = cowgpu::make_cpu_backend();
  const cowgpu::Multipoles q = cowgpu::mass_moments(cowgpu::mass_problems(body, 8, 0), *backend, monitor);
  std::printf("mass %.15g, Q_20 / R^2 %.15g\n", body.mass(), q(2, 0).real());
} catch (const cowgpu::Error& error) {
  std::fprintf(stderr, "moments: %s\n", error.what());
  return cowgpu::exit_code(error.fault());
}
