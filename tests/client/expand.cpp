// All expansions of a mesh, and the body again at order 7.
#include <cowgpu/cowgpu.hpp>

#include <cstdio>

int main(int argc, char** argv) try {
  const std::string mesh = argc > 1 ? argv[1] : "builtin:cow@1";
  cowgpu::Monitor monitor;
  const auto backend = cowgpu::make_cpu_backend();
  std::vector<std::string> notes;
  cowgpu::Body body = cowgpu::load_body({mesh}, notes, monitor);
  const cowgpu::ExpandResult all =
      cowgpu::expand({cowgpu::all_expansions(16)}, std::move(body), *backend, monitor, notes);
  std::printf("mass %.12g\n", all.body.mass());
  for (const cowgpu::SurfaceResult& surface : all.surfaces)
    std::printf("%s: f_r at degree 0 %.12g\n", name(surface.of).data(),
                surface.expansion.coefficients.at(0, 0, 0).real());
  const cowgpu::ReconstructReport seven = cowgpu::reconstruct({{mesh}, {7}}, *backend, monitor);
  std::printf("order 7: volume %.12g\n", seven.orders[0].measures.volume);
} catch (const cowgpu::Error& error) {
  std::fprintf(stderr, "expand: %s\n", error.what());
  return cowgpu::exit_code(error.fault());
}
