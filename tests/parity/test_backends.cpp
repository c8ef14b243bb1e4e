// The CPU and the device give the same product at every stage, from inputs in either memory. The stages are called
// without the help of TestContext, so that products stay where their backend leaves them.
#include <cstring>
#include <functional>
#include <utility>
#include <vector>

#include "isoshell/advanced/digest.h"
#include "isoshell/error.h"
#include "parity/product_hash.h"
#include "support/catch.h"
#include "support/paper_setup.h"
#include "support/site_shapes.h"
#include "support/solid_soup.h"
#include "support/test_context.h"

using namespace isoshell;
using namespace isoshell::parity;

namespace {

/// What one run of a stage gave: a hash of the product and other facts, or the error it ended with.
struct Outcome {
  bool failed = false;
  std::string text;
};
bool operator==(const Outcome& a, const Outcome& b) { return a.failed == b.failed && a.text == b.text; }
std::ostream& operator<<(std::ostream& out, const Outcome& o) { return out << o.text; }

/// A product and what a stage reports beside it.
template <class Product>
struct Made {
  Product product;
  std::string facts;
};

template <class Product>
Made<Product> made(Product product, std::string facts = "") {
  return {std::move(product), std::move(facts)};
}

std::string text_of(const RelaxReport& r) {
  std::string text = std::to_string(r.passes) + " passes, converged " + std::to_string(r.converged) + ", energy";
  for (double e : r.energy) {
    uint64_t bits;
    std::memcpy(&bits, &e, sizeof bits);
    text += " " + digest_text(bits);
  }
  return text;
}
std::string text_of(const DualReport& r) {
  return std::to_string(r.inserted_seeds) + " inserted, " + std::to_string(r.relabelled_vertices) + " relabelled, " +
         std::to_string(r.repair_rounds) + " rounds, " + std::to_string(r.failed_cells) + " failed";
}
std::string text_of(const SheetTopology& t) {
  return std::to_string(t.components) + " components, genus " + std::to_string(t.genus) + ", dropped " +
         std::to_string(t.dropped_components) + ", bridged " + std::to_string(t.bridged_vertices);
}

/// All products of a run, in one memory.
struct Products {
  LatticeSurface surface;
  SiteSet sites, coarse_sites;
  SiteSamples samples;
  Shell shell;
  Sheet sheet, proxy;
  SeedSet seeds, site_seeds;
  DualMesh dual;
  VoronoiLabels labels;
};

/// Runs stages on both backends side by side, and on each with what the other one made.
class SideBySide {
 public:
  SideBySide() {
    REQUIRE(test_backend() == Backend::cuda);  // run with --cuda, which also sees whether there is a device
    cpu_context_.backend = Backend::cpu;
    cuda_context_.backend = Backend::cuda;
  }

  Products cpu, cuda;

  /// The stage reads from the given products and returns Made<Product>. False when it ended with an error everywhere.
  template <class Product, class Stage>
  bool stage(const std::string& name, Product Products::*slot, Stage stage) {
    CAPTURE(name);
    Product on_cpu, on_cuda, ignored;
    const Outcome expected = outcome(stage, cpu, cpu_context_, on_cpu);
    CHECK(outcome(stage, cuda, cuda_context_, on_cuda) == expected);
    CHECK(outcome(stage, cuda, cuda_context_, ignored) == expected);
    CHECK(outcome(stage, cpu, cuda_context_, ignored) == expected);
    CHECK(outcome(stage, cuda, cpu_context_, ignored) == expected);
    cpu.*slot = std::move(on_cpu);
    cuda.*slot = std::move(on_cuda);
    return !expected.failed;
  }

 private:
  template <class Product, class Stage>
  static Outcome outcome(Stage& stage, const Products& inputs, Context& context, Product& product) {
    try {
      auto result = stage(inputs, context);
      product = std::move(result.product);
      return {false, digest_text(hash_arrays(product)) + " " + result.facts};
    } catch (const Error& e) {
      return {true, "error " + std::to_string(int(e.code())) + " in " + e.stage() + ": " + e.what()};
    }
  }

  Context cpu_context_, cuda_context_;
};
Triangulation dual_of(const Products& p, const DualOptions& options, Context& context) {
  return triangulate_dual(p.sheet, to_host(p.seeds), options, context);
}
SeededMesh seeded_mesh_of(const Products& p) { return {to_host(p.dual), to_host(p.seeds)}; }

std::string text_of(const InputTopology& t, const DirtCounts& d) {
  uint64_t area;
  std::memcpy(&area, &t.area_world, sizeof area);
  std::string text = digest_text(area);
  for (const int64_t n : {int64_t(t.closed), int64_t(t.oriented), t.components, t.boundary_loops, t.euler, t.genus,
                          d.nonfinite_vertices, d.dropped_faces_nonfinite, d.short_faces, d.degenerate_faces,
                          d.duplicate_faces, d.unreferenced_vertices, d.nonmanifold_edges, d.inconsistent_edges})
    text += " " + std::to_string(n);
  return text;
}

bool snapped(SideBySide& both, const TriangleSoup& soup, int32_t resolution) {
  const auto [lo, hi] = bounding_box(soup);
  const LatticeFrame frame = LatticeFrame::around(lo, hi, resolution);
  return both.stage("snap", &Products::surface, [&](const Products&, Context& c) {
    const auto [topology, dirt] = measure_topology(soup, c);
    return made(snap_surface(soup, frame, c), text_of(topology, dirt));
  });
}

bool up_to_samples(SideBySide& both) {
  return both.stage("voxelize", &Products::sites, [](const Products& p, Context& c) {
    return made(voxelize(p.surface, c));
  }) && both.stage("samples", &Products::samples, [](const Products& p, Context& c) {
    return made(sample_sites(p.surface, p.sites, c));
  });
}

bool shell_of_band(SideBySide& both, int32_t band_vox) {
  return both.stage("shell " + std::to_string(band_vox), &Products::shell,
                    [=](const Products& p, Context& c) { return made(build_shell(p.sites, {band_vox}, c)); });
}

void proxy_of_coarse_sites(SideBySide& both) {
  if (!both.stage("coarse sites", &Products::coarse_sites,
                  [](const Products& p, Context& c) { return made(coarsen_sites(p.sites, c)); }))
    return;
  both.stage("coarse proxy", &Products::proxy, [](const Products& p, Context& c) {
    Sheet proxy = build_proxy(p.coarse_sites, p.surface.frame, {}, c);
    const std::string facts = text_of(proxy.topology);
    return made(std::move(proxy), facts);
  });
}

bool sheet_with_closing(SideBySide& both, int32_t closing_vox) {
  return both.stage("sheet " + std::to_string(closing_vox), &Products::sheet, [=](const Products& p, Context& c) {
    Sheet sheet = build_sheet(p.surface, p.sites, p.samples, {closing_vox, 0}, c);
    const std::string facts = text_of(sheet.topology) + ", volume " + std::to_string(six_volume_vox(sheet, c));
    return made(std::move(sheet), facts);
  });
}

void relax_and_mesh_the_sheet(SideBySide& both, int64_t count) {
  if (!both.stage("seeds on the sheet", &Products::seeds, [=](const Products& p, Context& c) {
        return made(place_seeds(p.sheet, {count, 5}, c));
      }))
    return;
  const auto relax = [](const Products& p, Context& c) {
    RelaxedSeeds relaxed = relax_on_sheet(p.sheet, to_host(p.seeds), {12, 10000, 0}, c);
    return made(std::move(relaxed.seeds), text_of(relaxed.report));
  };
  if (!both.stage("relax on the sheet", &Products::seeds, relax)) return;
  both.stage("dual, only checked", &Products::dual, [](const Products& p, Context& c) {
    Triangulation run = dual_of(p, {0}, c);
    return made(std::move(run.mesh), text_of(run.report));
  });
  int64_t failed_cells = 0;
  if (!both.stage("dual", &Products::dual, [&](const Products& p, Context& c) {
        Triangulation run = dual_of(p, {}, c);
        failed_cells = run.report.failed_cells;
        return made(std::move(run.mesh), text_of(run.report));
      }))
    return;
  // The mesh's vertices are the seeds that the repair left.
  both.stage("seeds of the dual", &Products::seeds,
             [](const Products& p, Context& c) { return made(dual_of(p, {}, c).seeds); });
  both.stage("subdivided seeds", &Products::site_seeds, [](const Products& p, Context& c) {
    return made(subdivide_seeds(p.sheet, p.dual, p.seeds, p.seeds.size() * 2, c));
  });
  if (failed_cells > 0) return;
  both.stage("improved mesh", &Products::dual, [](const Products& p, Context& c) {
    OptimizedMesh run = optimize_mesh(p.sheet, seeded_mesh_of(p), {}, c);
    return made(std::move(run.mesh), std::to_string(run.report.flips) + " flips, " +
                                         std::to_string(run.report.self_intersections) + " intersections, seeds " +
                                         digest_text(hash_arrays(run.seeds)));
  });
  both.stage("mesh relaxed in passes", &Products::dual, [](const Products& p, Context& c) {
    OptimizeOptions passes;
    passes.for_seeds = true;
    passes.mesh_passes = 50;
    passes.noise_edges = 0.1;
    OptimizedMesh run = optimize_mesh(p.sheet, seeded_mesh_of(p), passes, c);
    return made(std::move(run.mesh), "seeds " + digest_text(hash_arrays(run.seeds)));
  });
  both.stage("mesh with edges collapsed", &Products::dual, [](const Products& p, Context& c) {
    SeededMesh run = collapse_edges(p.sheet, seeded_mesh_of(p), {p.seeds.size() * 4 / 5}, c);
    return made(std::move(run.mesh), "seeds " + digest_text(hash_arrays(run.seeds)));
  });
  both.stage("mesh with edges collapsed and ids kept", &Products::dual, [](const Products& p, Context& c) {
    SeededMesh run = collapse_edges(p.sheet, seeded_mesh_of(p), {p.seeds.size() * 4 / 5, true}, c);
    return made(std::move(run.mesh), "seeds " + digest_text(hash_arrays(run.seeds)));
  });
  both.stage("improved mesh without intersections", &Products::dual, [](const Products& p, Context& c) {
    UntangledSheet start = untangle_sheet(to_host(p.sheet), to_host(p.seeds), c);
    OptimizeOptions careful;
    careful.keep_apart = true;
    OptimizedMesh run = optimize_mesh(start.sheet, {to_host(p.dual), std::move(start.seeds)}, careful, c);
    return made(std::move(run.mesh), std::to_string(start.self_intersections) + " left, seeds " +
                                         digest_text(hash_arrays(run.seeds)) + ", sheet " +
                                         digest_text(hash_arrays(start.sheet)));
  });
}

void relax_and_flood_the_shell(SideBySide& both, int64_t count, bool has_sheet) {
  if (!both.stage("seeds on sites", &Products::site_seeds, [=](const Products& p, Context& c) {
        return made(place_seeds(p.sites, p.samples, {count, 9}, c));
      }))
    return;
  const auto relax = [](const Products& p, Context& c) {
    RelaxedSeeds relaxed = relax_in_shell(p.shell, p.sites, p.samples, to_host(p.site_seeds), {8, 10000, 0}, c);
    return made(std::move(relaxed.seeds), text_of(relaxed.report));
  };
  if (!both.stage("relax in the shell", &Products::site_seeds, relax)) return;
  both.stage("flood", &Products::labels,
             [](const Products& p, Context& c) { return made(flood_shell(p.shell, p.site_seeds, c)); });
  if (!has_sheet) return;
  const auto attach = [](const Products& p, Context& c) {
    return made(attach_to_sheet(p.sheet, to_host(p.site_seeds), 0, c));
  };
  both.stage("attached seeds", &Products::site_seeds, attach);
  if (both.cpu.proxy.vertex_count() == 0) return;
  const auto attach_twice_as_fine = [](const Products& p, Context& c) {
    SeedSet seeds = to_host(p.site_seeds);
    for (PointQ8& q : seeds.position) q = {q.x / 2, q.y / 2, q.z / 2};
    return made(attach_to_sheet(p.sheet, attach_to_sheet(p.proxy, std::move(seeds), 0, c), 1, c));
  };
  both.stage("seeds moved to a finer lattice", &Products::site_seeds, attach_twice_as_fine);
}

void every_stage_after_snapping(SideBySide& both, int32_t band_vox, int32_t closing_vox) {
  if (!up_to_samples(both)) return;
  shell_of_band(both, band_vox);
  proxy_of_coarse_sites(both);
  const bool has_sheet = sheet_with_closing(both, closing_vox);
  const int64_t sites = both.cpu.sites.voxels.voxel_count();
  if (has_sheet) relax_and_mesh_the_sheet(both, std::max<int64_t>(4, sites / 40));
  relax_and_flood_the_shell(both, std::max<int64_t>(4, sites / 60), has_sheet);
}

std::vector<shapes::NamedSoup> all_soups() {
  using namespace shapes;
  std::vector<NamedSoup> out = ugly_soups();
  out.push_back({"sphere", sphere({0.25, -1, 3}, 1.5, 48)});
  out.push_back({"torus and sphere", together(torus(2, 0.5, 48, 24), sphere({0, 0, 4}, 1, 32))});
  out.push_back({"two sheets far apart", two_sheets(4, 0.5)});
  out.push_back({"frame of a cube", cube_frame(12, 3)});
  out.push_back({"sieve", sieve(3, 4, 3, 3)});
  out.push_back({"rod", rod(20)});
  out.push_back({"cubes in a row", cubes(3, 4)});
  TriangleSoup triangle;
  triangle.vertices = {{0, 0, 0}, {1, 0.2, 0.1}, {0.3, 1, 0.7}};
  add_triangle(triangle, 0, 1, 2);
  triangle.faces_in_file = 1;
  out.push_back({"one triangle", triangle});
  return out;
}

}  // namespace

TEST_CASE("parity: every stage on every shape, whatever memory its inputs lie in", "[parity][cuda]") {
  int32_t turn = 0;
  for (const shapes::NamedSoup& shape : all_soups())
    for (const int32_t resolution : {17, 45, 98}) {
      CAPTURE(shape.name, resolution);
      const int32_t bands[] = {1, 2, 3, 5}, closings[] = {0, 0, 2, 5};
      SideBySide both;
      if (snapped(both, shape.soup, resolution))
        every_stage_after_snapping(both, bands[turn % 4], closings[turn / 2 % 4]);
      ++turn;
    }
}

TEST_CASE("parity: solids with hollows, on coarse lattices too", "[parity][cuda]") {
  const TriangleSoup shell = shapes::together(shapes::sphere({0, 0, 0}, 1, 32), shapes::sphere({0, 0, 0}, .6, 32));
  for (const int32_t resolution : {40, 300}) {
    SideBySide both;
    if (!snapped(both, shell, resolution) || !up_to_samples(both)) continue;
    for (Products* p : {&both.cpu, &both.cuda}) {
      p->sites = to_host(p->sites);
      p->sites.hollows = Buffer<Voxel>(1);
      const int32_t* extent = p->surface.frame.extent_vox;
      p->sites.hollows[0] = {extent[0] / 2, extent[1] / 2, extent[2] / 2};
    }
    CHECK(sheet_with_closing(both, 0));
    CHECK(both.cpu.sheet.topology.components == 2);
    proxy_of_coarse_sites(both);
    CHECK(both.cpu.proxy.topology.components == 2);
    sheet_with_closing(both, 2);
  }
}

TEST_CASE("parity: corners on voxel boundaries", "[parity][cuda]") {
  TestContext context;
  SideBySide both;
  both.cpu.surface = shapes::on_voxel_boundaries(context);
  both.cuda.surface = shapes::on_voxel_boundaries(context);
  every_stage_after_snapping(both, 2, 1);
}

TEST_CASE("parity: the shell of every thickness around every set of voxels", "[parity][cuda]") {
  std::vector<voxel_shapes::Named> sets = voxel_shapes::all(23);
  sets.push_back({"none", {}, {64, 64, 64}});
  sets.push_back({"one voxel", {{40, 33, 31}}, {64, 64, 64}});
  sets.push_back({"one voxel in the lattice's first corner", {{0, 0, 0}}, {64, 64, 64}});
  sets.push_back({"one voxel in the lattice's last corner", {{63, 63, 63}}, {64, 64, 64}});
  sets.push_back({"two voxels far apart", {{5, 5, 5}, {8000, 4300, 4200}}, {8192, 4352, 4224}});
  for (const voxel_shapes::Named& set : sets)
    for (int32_t band = 1; band <= kMaxBandVox; ++band) {
      CAPTURE(set.name, band);
      SideBySide both;
      both.cpu.sites = make_site_set(set.voxels, set.extent);
      both.cuda.sites = make_site_set(set.voxels, set.extent);
      shell_of_band(both, band);
    }
}

TEST_CASE("parity: the paper's loop and the flood on sets of voxels", "[parity][cuda]") {
  for (const voxel_shapes::Named& set : voxel_shapes::all(17)) {
    CAPTURE(set.name);
    SideBySide both;
    for (Products* p : {&both.cpu, &both.cuda}) {
      PaperSetup setup = paper_setup(set, 1);
      p->sites = std::move(setup.sites);
      p->samples = std::move(setup.samples);
    }
    for (const int32_t band : {1, 4}) {
      if (!shell_of_band(both, band)) continue;
      for (const int64_t count : {int64_t(1), int64_t(7), both.cpu.sites.voxels.voxel_count() / 9})
        relax_and_flood_the_shell(both, count, false);
    }
  }
}
