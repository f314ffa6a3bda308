#include "host/reproduce/stage.hpp"

namespace cowgpu::reproduce {
namespace {

using Words = std::vector<std::string>;

Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

// A stage that draws; each format is a run of its own.
struct Drawing {
  std::string name;
  std::string title, caption;
  Words command;
  std::vector<std::string> formats;
  double seconds = 1;
};

std::vector<Drawing> drawings(const std::string& mesh, const Words& recipe) {
  const auto figure = [&](const char* name) { return Words{"figure", name, mesh}; };
  return {
      {"definition",
       "The choice of f",
       "The point (theta, phi) of the sphere goes to F(theta, phi) on the body, at the "
       "distance f_r from the origin and with other angles; the difference of azimuths is f_dphi. A slice through the "
       "origin, seen along z.",
       figure("definition"),
       {"png", "svg"},
       1},
      {"inflation",
       "Inflating the cow",
       "The level sets of the distance from the surface: the body, the level set at a "
       "tenth of its diagonal, and at three times its diagonal, which is nearly a sphere. The flow takes each to the "
       "next.",
       figure("inflation"),
       {"png"},
       15},
      {"streamlines",
       "The flow of the distance's gradient",
       "Points where the yz plane through the centre of mass cuts the "
       "cow (blue), the streamlines off them (grey), and where they end, as directions on a circle (orange). Below, "
       "the legs, "
       "which are out of the plane, push the flow away from it.",
       figure("streamlines"),
       {"png", "svg"},
       5},
      {"orders_flow",
       "Orders over the gradient flow",
       "The body rebuilt from its expansion over the gradient flow, x, y "
       "and z: monopole to octacosahectapole, and the whole.",
       figure("orders") + Words{"--result", "data/flow.json"},
       {"png"},
       6},
      {"orders_harmonic",
       "Orders over the harmonic map",
       "The same over the harmonic map, which shrinks what sticks out to "
       "nothing.",
       figure("orders") + Words{"--result", "data/harmonic.json"},
       {"png"},
       6},
      {"orders_stretch",
       "Orders over the map of least stretch",
       "The same over a map that keeps room for the legs; the "
       "paper has none like it.",
       figure("orders") + Words{"--result", "data/stretch.json", "--lmax", "128"},
       {"png"},
       6},
      {"components",
       "The map between the cow and the sphere",
       "The components of f over the harmonic map, on the body and "
       "on the sphere in Mollweide's projection. Angles in radians, their means removed; f_dphi as its absolute value, "
       "as in "
       "the paper's tables.",
       figure("components") + Words{"--of", "harmonic"} + recipe,
       {"png"},
       10},
      {"tipping",
       "The geometry of tipping",
       "Left: a spherical body, which any force tips, as the ground's force points at the "
       "barycentre. Right: the body on its feet. x comes out of the page.",
       figure("tipping"),
       {"png"},
       3},
      {"spectra",
       "Power by degree",
       "Of the components of f over three maps, and of the mass multipoles over their radius. "
       "The paper has none.",
       figure("spectra") +
           Words{"--result", "data/harmonic.json", "--result", "data/flow.json", "--result", "data/stretch.json"},
       {"png", "svg"},
       2},
      {"force_duration",
       "How long a push must last",
       "The least duration of a constant push that tips the body, over its "
       "force: above the line it tips, below it falls back. 500 N sustained never tip it. The paper has none.",
       {"tip", mesh, "--recipe", "paper"},
       {"png", "svg"},
       2},
  };
}

} // namespace

Plan plan(const std::string& mesh, bool papers_mesh, const std::string& device, bool page) {
  const Words on = {"--device", device};
  const Words recipe = papers_mesh ? Words{"--recipe", "paper"} : Words{};
  const Words body = {"--recipe", "paper", "--json"}; // for another mesh than the paper's, units alone
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
      {"potential",
       "how good the spherical cow is, and where",
       Words{"potential", mesh, "--errors", "--plot", "figures/potential_error.png", "--plot",
             "figures/potential_error.svg", "--json"} +
           on,
       "data/potential.json",
       {"figures/potential_error.png", "figures/potential_error.svg"},
       20},
  };
  for (const Drawing& d : drawings(mesh, recipe)) {
    for (const std::string& format : d.formats) {
      const std::string file = "figures/" + d.name + "." + format;
      // `tip` has a result of its own, and draws beside it.
      const Words output = {d.command[0] == "figure" ? "-o" : "--plot", file};
      plan.stages.push_back({d.name + (format == "png" ? "" : "_" + format),
                             "figure: " + d.title + ", " + format,
                             d.command + output + on,
                             "data/" + d.name + "_" + format + ".txt",
                             {file},
                             d.seconds});
    }
    plan.figures.push_back({"figures/" + d.name + ".png", d.title, d.caption});
  }
  plan.figures.push_back(
      {"figures/potential_error.png", "How good the spherical cow is, and where",
       "The largest error of the potential (and of the acceleration) of each order on spheres about the "
       "centre of mass, against the exact polyhedron. The paper has none."});
  if (page)
    plan.stages.push_back(
        {"report",
         "the page report.html",
         Words{"report", "data/stretch.json", "--mesh", mesh, "--physics", "data/tensors.json", "--physics",
               "data/radiate.json", "--physics", "data/tides.json", "--physics", "data/drop.json", "--physics",
               "data/tip.json", "--physics", "data/potential.json", "-o", "report.html"} +
             on,
         "data/report.txt",
         {"report.html"},
         5});
  return plan;
}

} // namespace cowgpu::reproduce
