// What each ingredient is worth: the default run with one of them switched off in turn. Energy a pass, quality and
// share of irregular vertices after a number of passes (dual only), and the final mesh of every variant. JSON on
// standard output; ablation.py draws it.
//   bench_ablation MESH [--vertices K] [--threads T]
#include <vector>

#include "bench/programs/program.h"
#include "isoshell/isoshell.h"
#include "pipeline/sheet/hierarchy.h"

using namespace isoshell;
using nlohmann::json;

namespace {

constexpr int32_t kPassCounts[] = {0, 1, 2, 3, 5, 8, 12, 20, 30, 40, 60, 100};
constexpr int32_t kTolerancePpb = 10000;

struct Bench {
  const Prepared& prepared;
  const SeedOptions start;
  Context& context;

  SeedSet from_levels(int32_t passes) const {
    return relax_by_levels(PreparedParts::of(prepared), {start, {passes, kTolerancePpb, 0}, true}, context).seeds;
  }
  SeedSet from_strata() const { return place_seeds(prepared.sheet(), start, context); }

  RelaxReport relax(SeedSet& s, int32_t passes) const {
    RelaxedSeeds relaxed = relax_on_sheet(prepared.sheet(), std::move(s), {passes, 0, 0}, context);
    s = std::move(relaxed.seeds);
    return relaxed.report;
  }
  /// A pass alone has nothing to look ahead along.
  RelaxReport relax_without_momentum(SeedSet& s, int32_t passes) const {
    RelaxReport all;
    for (int32_t p = 0; p < passes; ++p) all.energy.push_back(relax(s, 1).energy.front());
    return all;
  }

  /// Quality of the dual of a copy of the seeds, improved as asked.
  json judged(const SeedSet& seeds, const OptimizeOptions* optimize) const {
    SeededMesh dual = triangulate_dual(prepared.sheet(), to_host(seeds), {}, context);
    json row = json::object();
    if (optimize) {
      OptimizedMesh optimized = optimize_mesh(prepared.sheet(), std::move(dual), *optimize, context);
      row["self_intersections"] = optimized.report.self_intersections;
      dual = std::move(optimized);
    }
    const MeshQuality q = measure_quality(to_world(dual.mesh, prepared.surface().frame));
    row.update({{"q_avg", q.q_avg},
                {"q_min", q.q_min},
                {"theta_avg", q.theta_avg_deg},
                {"theta_min", q.theta_min_deg},
                {"irregular", q.irregular_ratio},
                {"vertices", dual.seeds.size()}});
    return row;
  }

  using Relax = RelaxReport (Bench::*)(SeedSet&, int32_t) const;

  json curve(const SeedSet& from, Relax method, int32_t most) const {
    json rows = json::array();
    std::vector<double> energy;
    for (const int32_t passes : kPassCounts) {
      if (passes > most) break;
      SeedSet seeds = to_host(from);
      if (passes > 0) energy = (this->*method)(seeds, passes).energy;
      rows.push_back(judged(seeds, nullptr));
      rows.back()["passes"] = passes;
    }
    return {{"energy", energy}, {"after", rows}};
  }
};

}  // namespace

int main(int argc, char** argv) {
  int64_t vertices = 10000;
  Context context;
  const std::string path = bench::read_arguments(
      argc, argv, "bench_ablation MESH", 1, {{"--vertices", "K", &vertices}, {"--threads", "T", &context.threads}})[0];
  RemeshOptions options;
  options.vertices = vertices;
  const TriangleSoup soup = read_mesh(path);
  const Prepared prepared = prepare(soup, options, context);
  const Bench bench{prepared, {vertices, options.seed}, context};

  const SeedSet levels = bench.from_levels(0), strata = bench.from_strata();
  json curves = {{"all", bench.curve(levels, &Bench::relax, 40)},
                 {"no levels", bench.curve(strata, &Bench::relax, 100)},
                 {"no momentum", bench.curve(levels, &Bench::relax_without_momentum, 40)}};

  const OptimizeOptions optimize;
  OptimizeOptions no_flips = optimize, flips_only = optimize, no_search = optimize, no_fit = optimize;
  no_flips.flip_rounds = 0;
  flips_only.smoothing_steps = flips_only.search_rounds = 0;
  no_search.search_rounds = 0;
  no_fit.fit = Fit::surface;
  const SeedSet relaxed = bench.from_levels(100);
  SeedSet no_levels = to_host(strata), no_momentum = to_host(levels);
  bench.relax(no_levels, 100);
  bench.relax_without_momentum(no_momentum, 40);
  json finals = json::array();
  const auto add = [&](const char* name, const SeedSet& seeds, const OptimizeOptions* p) {
    finals.push_back(bench.judged(seeds, p));
    finals.back()["variant"] = name;
  };
  add("all", relaxed, &optimize);
  add("no levels", no_levels, &optimize);
  add("no momentum", no_momentum, &optimize);
  add("no relaxation of the finest level", levels, &optimize);
  add("no flips", relaxed, &no_flips);
  add("no search", relaxed, &no_search);
  add("no fit", relaxed, &no_fit);
  add("flips only", relaxed, &flips_only);
  add("no post", relaxed, nullptr);

  bench::print_result({{"mesh", path},
                       {"vertices", vertices},
                       {"sheet_vertices", prepared.sheet().vertex_count()},
                       {"curves", curves},
                       {"final", finals}});
}
