// Whole runs, distances and contexts: the CPU and the device give the same.
#include <string>
#include <utility>
#include <vector>

#include "golden/golden_cases.h"
#include "isoshell/advanced/digest.h"
#include "isoshell/distance.h"
#include "isoshell/error.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/site_shapes.h"
#include "support/solid_soup.h"
#include "support/test_context.h"

using namespace isoshell;

TEST_CASE("parity: whole runs, three times, with every digest", "[parity][cuda]") {
  std::vector<golden::Case> cases = golden::cases();
  cases.push_back({"sphere, few cells", [] { return shapes::sphere({0, 0, 0}, 1, 24); }, golden::options(4, 40)});
  cases.push_back({"torus, band 9", [] { return shapes::torus(2, .7, 33, 17); }, golden::options(250, 71)});
  cases.back().options.band_vox = 9;
  cases.push_back(
      {"torus shell, band 6", [] { return shapes::torus(2, .7, 33, 17); }, golden::options(250, 71, Method::shell)});
  cases.back().options.band_vox = 6;
  cases.push_back({"confetti", [] { return shapes::random_soup(2000, 4, .05, 2); }, golden::options(300, 60)});
  cases.push_back({"random soup, shell", [] { return shapes::random_soup(150, 4, 3, 1); },
                   golden::options(600, 64, Method::shell, 2)});
  cases.push_back({"sieve", [] { return shapes::sieve(3, 4, 3, 3); }, golden::options(3000, 80)});
  const auto run = [](const golden::Case& c, Backend backend) {
    Context context;
    context.backend = backend;
    try {
      return golden::run(c, context);
    } catch (const Error& e) {
      return std::string(e.stage()) + ": " + e.what();
    }
  };
  for (const golden::Case& c : cases) {
    const std::string expected = run(c, Backend::cpu);
    for (int repeat = 0; repeat < 3; ++repeat) CHECK(run(c, Backend::cuda) == expected);
  }
}

TEST_CASE("parity: distances and turns of normals, with creases, far away and of many samples", "[parity][cuda]") {
  REQUIRE(test_backend() == Backend::cuda);
  const TriangleMesh torus = mesh_of(shapes::torus(2, .7, 96, 48)), rough = mesh_of(shapes::torus(2, .68, 31, 17)),
                     box = mesh_of(shapes::box({0, 0, 0}, {1, 2, 3})), far = mesh_of(shapes::sphere({40, 0, 7}, 1, 48)),
                     one{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}}}};
  Context cpu, cuda;
  cpu.backend = Backend::cpu;
  cuda.backend = Backend::cuda;
  const auto figures = [](const MeshDistance& d) {
    std::vector<double> all;
    for (const OneSidedDistance& side : {d.to_reference, d.from_reference})
      all.insert(all.end(), {side.mean, side.rms, side.max, side.at_most.value_or(-1)});
    for (const NormalDeviation& side : {d.normal_to_reference, d.normal_from_reference})
      all.insert(all.end(), {side.mean_deg, side.max_deg});
    return all;
  };
  const std::pair<const TriangleMesh*, const TriangleMesh*> pairs[] = {
      {&torus, &rough}, {&rough, &box}, {&box, &box}, {&torus, &far}, {&box, &one}};
  for (const auto& [mesh, reference] : pairs)
    for (const DistanceOptions& options : {DistanceOptions{}, DistanceOptions{1}, DistanceOptions{70001, true}})
      CHECK(figures(measure_distance(*mesh, *reference, cuda, options)) ==
            figures(measure_distance(*mesh, *reference, cpu, options)));
}

TEST_CASE("parity: one context serves run after run, and two contexts do not disturb each other", "[parity][cuda]") {
  const golden::Case c = golden::cases()[1];
  Context cpu, one, two;
  cpu.backend = Backend::cpu;
  one.backend = two.backend = Backend::cuda;
  const std::string expected = golden::run(c, cpu);
  for (Context* context : {&one, &two, &one}) CHECK(golden::run(c, *context) == expected);
}

TEST_CASE("parity: what one context made is taken by another one at once", "[parity][cuda]") {
  Context host;
  host.backend = Backend::cpu;
  const LatticeSurface surface = shapes::snapped(shapes::torus(2, .7, 96, 48), 300, host);
  const SiteSet sites = voxelize(surface, host);
  const uint64_t expected = digest(build_shell(sites, {2}, host));
  for (int repeat = 0; repeat < 20; ++repeat) {
    Context one, two;
    one.backend = two.backend = Backend::cuda;
    const SiteSet made = voxelize(surface, one);
    CHECK(digest(build_shell(made, {2}, two)) == expected);
  }
}
