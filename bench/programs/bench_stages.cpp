// One row per stage: size, time, throughput and peak memory, for one mesh. JSON on standard output.
//   bench_stages MESH [--resolution R] [--band D] [--vertices K] [--threads T] [--repeats N]
#include <string>
#include <vector>

#include "bench/programs/program.h"
#include "isoshell/isoshell.h"

using namespace isoshell;
using nlohmann::json;

namespace {

struct Arguments {
  std::string mesh;
  int32_t resolution = 512, band_vox = 2;
  int64_t vertices = 4000;
  int threads = 0, repeats = 3;
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  a.mesh = bench::read_arguments(argc, argv, "bench_stages MESH", 1,
                                 {{"--resolution", "R", &a.resolution},
                                  {"--band", "D", &a.band_vox},
                                  {"--vertices", "K", &a.vertices},
                                  {"--threads", "T", &a.threads},
                                  {"--repeats", "N", &a.repeats}})[0];
  return a;
}

/// Runs a stage `repeats` times and keeps the last product.
class Rows {
 public:
  explicit Rows(int repeats) : repeats_(repeats) {}

  template <class Stage, class Count>
  auto run(const char* name, const char* unit, Stage stage, Count count) {
    std::vector<double> ms;
    const bench::PeakMemory memory;
    auto product = timed(stage, ms);
    for (int i = 1; i < repeats_; ++i) product = timed(stage, ms);
    const bench::Spread spread = bench::spread_of(ms);
    const int64_t items = count(product);
    json row = {{"stage", name},
                {unit, items},
                {"million_per_second", double(items) / spread.median / 1000},
                {"peak_mb", memory.mb()}};
    bench::add_spread(row, "ms", spread);
    rows_.push_back(row);
    return product;
  }
  const json& rows() const { return rows_; }

 private:
  template <class Stage>
  static auto timed(Stage& stage, std::vector<double>& ms) {
    const bench::Watch watch;
    auto product = stage();
    ms.push_back(watch.ms());
    return product;
  }

  int repeats_;
  json rows_ = json::array();
};

}  // namespace

int main(int argc, char** argv) try {
  const Arguments args = parse(argc, argv);
  bench::BackendContext context(Backend::cpu, args.threads);
  Rows rows(args.repeats);

  const TriangleSoup soup = rows.run(
      "read", "triangles", [&] { return read_mesh(args.mesh); },
      [](const TriangleSoup& s) { return int64_t(s.triangles.size()); });
  const LatticeFrame frame = bench::frame_of(soup, args.resolution);
  const LatticeSurface surface = rows.run(
      "snap", "triangles", [&] { return snap_surface(soup, frame, context); },
      [](const LatticeSurface& s) { return s.triangles.size(); });
  const SiteSet sites = rows.run(
      "voxelize", "sites", [&] { return voxelize(surface, context); },
      [](const SiteSet& s) { return s.voxels.voxel_count(); });
  const SiteSamples samples = rows.run(
      "samples", "sites", [&] { return sample_sites(surface, sites, context); },
      [](const SiteSamples& s) { return s.sample.size(); });
  const Shell shell = rows.run(
      "shell", "active_voxels", [&] { return build_shell(sites, {args.band_vox}, context); },
      [](const Shell& s) { return s.voxels.voxel_count(); });
  const Sheet sheet = rows.run(
      "sheet", "sheet_vertices",
      [&] {
        return build_sheet(surface, sites, samples, {0, 0}, context);
      },
      [](const Sheet& s) { return s.vertex_count(); });
  constexpr int32_t kPasses = 20;
  const auto relaxed_on_sheet = [&] {
    SeedSet seeds = place_seeds(sheet, {args.vertices, 0}, context);
    return relax_on_sheet(sheet, std::move(seeds), {kPasses, 0, 0}, context).seeds;
  };
  const auto vertex_passes = [&](const SeedSet&) { return kPasses * sheet.vertex_count(); };
  SeedSet seeds = rows.run("relax_on_sheet", "vertex_passes", relaxed_on_sheet, vertex_passes);
  const auto relaxed_in_shell = [&] {
    SeedSet in_shell = place_seeds(sites, samples, {args.vertices, 0}, context);
    return relax_in_shell(shell, sites, samples, std::move(in_shell), {kPasses, 0, 0}, context).seeds;
  };
  rows.run("relax_in_shell", "voxel_passes", relaxed_in_shell,
           [&](const SeedSet&) { return kPasses * shell.voxels.voxel_count(); });
  rows.run(
      "flood", "active_voxels", [&] { return flood_shell(shell, seeds, context); },
      [&](const VoronoiLabels& l) { return l.voxel_seed.size(); });
  const auto dual = [&] {
    Triangulation made = triangulate_dual(sheet, std::move(seeds), {}, context);
    seeds = std::move(made.seeds);
    return std::move(made.mesh);
  };
  rows.run("dual", "triangles", dual, [](const DualMesh& m) { return m.triangles.size(); });

  bench::print_result({{"bench", "stages"},
                       {"mesh", bench::file_name(args.mesh)},
                       {"resolution", args.resolution},
                       {"band_vox", args.band_vox},
                       {"vertices", args.vertices},
                       {"threads", args.threads},
                       {"repeats", args.repeats},
                       {"rows", rows.rows()}});
} catch (const std::exception& e) {
  return bench::failed(argv[0], e);
}
