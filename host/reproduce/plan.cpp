#include "host/reproduce/stage.hpp"

namespace cowgpu::reproduce {
namespace {

using Words = std::vector<std::string>;

Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

} // namespace

Plan plan(const std::string& mesh, bool papers_mesh, const std::string& device) {
  const Words on = {"--device", device};
  const Words recipe = papers_mesh ? Words{"--recipe", "paper"} : Words{};
  const Words body = {"--recipe", "paper", "--json"}; // of another mesh its units alone
  Plan plan;
  plan.stages = {
      {"inspect", "what the mesh is", {"inspect", mesh, "--json"}, "data/inspect.json", {}, 0.2},
      {"mass",
       "mass multipoles to degree 512",
       Words{"expand", mesh, "--lmax", "512", "-o", "data/mass.json"} + on,
       "data/mass.txt",
       {"data/mass.json"},
       1.5},
      {"tensors", "quadrupole and inertia", Words{"tensors", mesh} + body, "data/tensors.json", {}, 0.2},
      {"radiate", "gravitational radiation", Words{"radiate", mesh, "--octupole"} + body, "data/radiate.json", {}, 0.2},
      {"harmonic",
       "the surface over the harmonic map",
       Words{"expand", mesh, "--of", "harmonic", "--lmax", "128", "-o", "data/harmonic.json"} + recipe + on,
       "data/harmonic.txt",
       {"data/harmonic.json"},
       1},
      {"flow",
       "the surface over the gradient flow",
       Words{"expand", mesh, "--of", "flow", "--lmax", "128", "-o", "data/flow.json"} + recipe + on,
       "data/flow.txt",
       {"data/flow.json"},
       60},
      {"stretch",
       "the surface over the map of least stretch",
       Words{"expand", mesh, "--of", "stretch", "--lmax", "128", "-o", "data/stretch.json"} + on,
       "data/stretch.txt",
       {"data/stretch.json"},
       5},
      {"tip",
       "what tips it, by order",
       Words{"tip", mesh, "--of", "harmonic", "--order", "0..7,full"} + body + on,
       "data/tip.json",
       {},
       10},
      {"drop",
       "whether it lands on its feet",
       Words{"drop", mesh, "--height", "1km", "--attitude", "on-side"} + body,
       "data/drop.json",
       {},
       1},
      {"tides", "what holds it in orbit", Words{"tides", mesh, "--orbit", "6771km"} + body, "data/tides.json", {}, 1},
      {"errata", "what is wrong in the paper", {"errata", "--json"}, "data/errata.json", {}, 1.5},
  };
  return plan;
}

} // namespace cowgpu::reproduce
