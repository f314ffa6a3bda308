// Twenty lines on top of the library: the quadrupole of a mesh, computed on whatever there is.
#include <host/backend.hpp>
#include <host/error.hpp>
#include <host/io/mesh_source.hpp>
#include <host/mesh/body.hpp>
#include <host/mass/mass_moments.hpp>

#include <cstdio>

int main(int argc, char** argv) {
  try {
    const cowgpu::Body body =
        cowgpu::make_body(cowgpu::ClosedSurface::from(cowgpu::load_mesh(argc > 1 ? argv[1] : "builtin:box:1,2,3")), {}, 1);
    cowgpu::Monitor monitor;
    const auto backend = cowgpu::make_cpu_backend();
    const auto q = cowgpu::mass_moments(cowgpu::mass_problems(body, 8, 0), *backend, monitor);
    std::printf("mass %.15g, Q_20 / R^2 %.15g\n", body.mass(), q(2, 0).real());
  } catch (const cowgpu::Error& error) {
    std::fprintf(stderr, "client: %s\n", error.what());
    return cowgpu::exit_code(error.fault());
  }
}
