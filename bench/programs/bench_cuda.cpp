// Whole runs and single stages on a CUDA device, as JSON and Markdown.
//   bench_cuda MESH --json F.json --markdown F.md [--big MESH] [--command PATH] [--repeats N] [--resolution R]
// Whole runs: MESH with 4000 vertices on the default grid and at R (512), both methods, and the big mesh with a million
// vertices; from a mesh in host memory to a mesh in host memory, after a warm-up. Cold runs: the command, file to file,
// each in a process of its own. Stages: alone, at R, from products in device memory to products in device memory.
#include <cuda_runtime_api.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "bench/programs/program.h"
#include "isoshell/isoshell.h"

using namespace isoshell;
using nlohmann::json;

namespace {

struct Arguments {
  std::string mesh, big, command, json_path, markdown_path;
  int32_t resolution = 512;
  int repeats = 7;
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  a.mesh = bench::read_arguments(argc, argv, "bench_cuda MESH", 1,
                                 {{"--json", "F.json", &a.json_path},
                                  {"--markdown", "F.md", &a.markdown_path},
                                  {"--big", "MESH", &a.big},
                                  {"--command", "PATH", &a.command},
                                  {"--repeats", "N", &a.repeats},
                                  {"--resolution", "R", &a.resolution}})[0];
  a.repeats = std::max(1, a.repeats);
  return a;
}

/// A whole run, warm. The stages' times are those of the library's report, medians as well.
json whole_run(const std::string& mesh, const std::string& label, const RemeshOptions& options, int repeats) {
  const TriangleSoup soup = read_mesh(mesh);
  bench::BackendContext context(Backend::cuda);
  std::vector<double> ms;
  std::map<std::string, std::vector<double>> stage_ms;
  std::vector<std::string> order;
  RemeshResult result;
  reset_device_memory_peak(context.device);
  for (int i = 0; i <= repeats; ++i) {
    const double took = bench::ms_of([&] { result = remesh(soup, options, context); });
    if (i == 0) continue;  // warm-up
    ms.push_back(took);
    for (const StageTime& t : result.report.times) {
      if (stage_ms[t.stage].empty()) order.push_back(t.stage);
      stage_ms[t.stage].push_back(t.ms);
    }
  }
  json row = {{"run", label},
              {"mesh", bench::file_name(mesh)},
              {"triangles_in", soup.triangles.size()},
              {"method", options.method == Method::shell ? "shell" : "sheet"},
              {"resolution", result.report.grid.frame.resolution},
              {"sheet_vertices", result.report.sheet.vertices},
              {"vertices", result.mesh.vertices.size()},
              {"passes", result.report.relax.passes},
              {"device_peak_bytes", device_memory_peak_bytes(context.device)},
              {"stages_ms", json::array()}};
  bench::add_spread(row, "ms", bench::spread_of(ms));
  for (const std::string& stage : order)
    row["stages_ms"].push_back({{"stage", stage}, {"ms_median", bench::spread_of(stage_ms[stage]).median}});
  return row;
}

/// "vdb_isomesh:   relax 14.2 ms" of a verbose run, and their sum over the command's own steps, which hold the stages.
json times_in(const std::string& path) {
  json times = json::object();
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    char stage[64];
    double ms = 0;
    const size_t at = line.find("  ");
    if (at != std::string::npos && std::sscanf(line.c_str() + at, " %63s %lf ms", stage, &ms) == 2) times[stage] = ms;
  }
  return times;
}

/// The command, file to file, in a process of its own. Without statistics: their digests take every product to the
/// host, which no other run does.
json cold_run(const Arguments& a, const std::string& mesh, const std::string& label, const std::string& options) {
  const std::string folder =
      (std::filesystem::temp_directory_path() / ("isoshell_bench_" + std::to_string(getpid()))).string();
  const std::string line = "mkdir -p " + folder + " && '" + a.command + "' '" + mesh + "' " + folder +
                           "/out.ply --force -v --device cuda " + options + " 2> " + folder + "/log";
  std::vector<double> ms;
  for (int i = 0; i < 3; ++i) {
    int ended = 0;
    ms.push_back(bench::ms_of([&] { ended = std::system(line.c_str()); }));
    if (ended != 0) throw std::runtime_error("the command failed: " + line);
  }
  const json times = times_in(folder + "/log");
  if (std::system(("rm -rf " + folder).c_str()) != 0) throw std::runtime_error("cannot remove " + folder);
  double inside = 0;
  for (const char* step : {"read", "prepare", "relax", "triangulate", "measure", "write"})
    if (times.contains(step)) inside += double(times[step]);
  json row = {{"run", label},
              {"mesh", bench::file_name(mesh)},
              {"options", options},
              {"timings_ms", times},
              {"outside_steps_ms", ms.back() - inside}};
  bench::add_spread(row, "ms", bench::spread_of(ms));
  return row;
}

/// Stages alone, products in device memory.
class StageRows {
 public:
  explicit StageRows(int repeats) : repeats_(repeats) {}

  template <class Stage>
  auto run(const char* name, const char* unit, Stage stage, const std::function<int64_t()>& count) {
    auto product = stage();  // warm-up
    cudaDeviceSynchronize();
    reset_device_memory_peak(0);
    std::vector<double> ms;
    for (int i = 0; i < repeats_; ++i)
      ms.push_back(bench::ms_of([&] {
        product = stage();
        cudaDeviceSynchronize();
      }));
    const bench::Spread s = bench::spread_of(ms);
    const int64_t items = count();
    json row = {{"stage", name},
                {"unit", unit},
                {"items", items},
                {"million_per_second", double(items) / s.median / 1000},
                {"device_peak_bytes", device_memory_peak_bytes(0)}};
    bench::add_spread(row, "ms", s);
    rows_.push_back(row);
    return product;
  }
  const json& rows() const { return rows_; }

 private:
  int repeats_;
  json rows_ = json::array();
};

json stage_rows(const Arguments& a) {
  constexpr int32_t kPasses = 20;
  const TriangleSoup soup = read_mesh(a.mesh);
  bench::BackendContext context(Backend::cuda);
  const LatticeSurface surface = snap_surface(soup, bench::frame_of(soup, a.resolution), context);
  StageRows rows(a.repeats);
  int64_t sites_count = 0;
  const SiteSet sites = rows.run(
      "voxelize, surface from the host", "sites",
      [&] {
        SiteSet made = voxelize(surface, context);
        sites_count = made.voxels.voxel_count();
        return made;
      },
      [&] { return sites_count; });
  const SiteSamples samples = rows.run(
      "samples, surface from the host", "sites", [&] { return sample_sites(surface, sites, context); },
      [&] { return sites_count; });
  for (const int32_t band : {1, 3, 6, 9}) {
    int64_t active = 0;
    rows.run(("shell, d = " + std::to_string(band)).c_str(), "active_voxels",
             [&] {
               Shell made = build_shell(sites, {band}, context);
               active = made.voxels.voxel_count();
               return made;
             },
             [&] { return active; });
  }
  const Shell shell = build_shell(sites, {2}, context);
  int64_t vertices = 0;
  const Sheet sheet = rows.run(
      "sheet, surface from the host", "sheet_vertices",
      [&] {
        Sheet made = build_sheet(surface, sites, samples, {0, 0}, context);
        vertices = made.vertex_count();
        return made;
      },
      [&] { return vertices; });
  for (const int64_t k : {int64_t(4000), vertices / 40})
    rows.run(("20 passes on the sheet, k = " + std::to_string(k)).c_str(), "vertex_passes",
             [&] {
               SeedSet seeds = place_seeds(sheet, {k, 0}, context);
               return relax_on_sheet(sheet, std::move(seeds), {kPasses, 0, 0}, context).seeds;
             },
             [&] { return kPasses * vertices; });
  rows.run(
      "20 passes in the shell, k = 4000", "voxel_passes",
      [&] {
        SeedSet seeds = place_seeds(sites, samples, {4000, 0}, context);
        return relax_in_shell(shell, sites, samples, std::move(seeds), {kPasses, 0, 0}, context).seeds;
      },
      [&] { return kPasses * shell.voxels.voxel_count(); });
  const SeedSet seeds = [&] {
    SeedSet made = place_seeds(sheet, {4000, 0}, context);
    return relax_on_sheet(sheet, std::move(made), {kPasses, 0, 0}, context).seeds;
  }();
  rows.run(
      "flood", "active_voxels", [&] { return flood_shell(shell, seeds, context); },
      [&] { return shell.voxels.voxel_count(); });
  const auto copied = [&] { return to_host(seeds); };
  rows.run(
      "dual, seeds from the host", "sheet_vertices",
      [&] { return triangulate_dual(sheet, copied(), {}, context).mesh; }, [&] { return vertices; });
  rows.run(
      "dual and improved mesh, seeds from the host", "sheet_vertices",
      [&] { return optimize_mesh(sheet, triangulate_dual(sheet, copied(), {}, context), {}, context).mesh; },
      [&] { return vertices; });
  return rows.rows();
}

std::string fixed(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::string markdown(const json& out) {
  const json& d = out["device"];
  std::string text = "# Whole runs and stages on " + d["name"].get<std::string>() + "\n\n";
  text += "Driver " + d["driver"].get<std::string>() + " (CUDA " + d["driver_cuda"].get<std::string>() + "), toolkit " +
          d["toolkit"].get<std::string>() + ", flags `" + d["flags"].get<std::string>() + "`, commit " +
          out["commit"].get<std::string>() + ", host " + out["machine"]["cpu"].get<std::string>() + " with " +
          std::to_string(out["machine"]["cores"].get<int>()) + " cores, " + out["machine"]["date"].get<std::string>() +
          ". Medians of " + std::to_string(out["repeats"].get<int>()) + " after a warm-up.\n\n";
  text += "## Mesh in host memory to mesh in host memory, warm\n\n";
  text +=
      "| run | method | resolution | sheet vertices | vertices | passes | ms | least | most | device peak, MiB | where "
      "it goes, ms |\n";
  text += "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const json& r : out["whole_runs"]) {
    std::string stages;
    for (const json& s : r["stages_ms"])
      stages += (stages.empty() ? "" : ", ") + s["stage"].get<std::string>() + " " + fixed(s["ms_median"], 1);
    text += "| " + r["run"].get<std::string>() + " | " + r["method"].get<std::string>() + " | " +
            r["resolution"].dump() + " | " + r["sheet_vertices"].dump() + " | " + r["vertices"].dump() + " | " +
            r["passes"].dump() + " | " + fixed(r["ms_median"], 1) + " | " + fixed(r["ms_min"], 1) + " | " +
            fixed(r["ms_max"], 1) + " | " + fixed(double(r["device_peak_bytes"]) / (1 << 20), 0) + " | " + stages +
            " |\n";
  }
  text +=
      "\n## The command, file to file, cold\n\n| run | ms | least | most | where it goes, ms |\n| --- | --- | --- | "
      "--- | --- |\n";
  for (const json& r : out["cold_runs"]) {
    std::string parts = "process start and end, device included " + fixed(r["outside_steps_ms"], 0);
    for (const auto& [stage, ms] : r["timings_ms"].items())
      if (stage != "total" && double(ms) >= 0.5) parts += ", " + stage + " " + fixed(ms, 1);
    text += "| " + r["run"].get<std::string>() + " | " + fixed(r["ms_median"], 0) + " | " + fixed(r["ms_min"], 0) +
            " | " + fixed(r["ms_max"], 0) + " | " + parts + " |\n";
  }
  text +=
      "\n`prepare`, `relax` and `triangulate` of the command hold the stages that follow them.\n\n## Stages alone, " +
      out["mesh"].get<std::string>() + " at " + out["resolution"].dump() +
      ", products in device memory\n\n| stage | items | ms | least | most | million a second | device peak, MiB |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n";
  for (const json& r : out["stages"])
    text += "| " + r["stage"].get<std::string>() + " | " + r["items"].dump() + " " + r["unit"].get<std::string>() +
            " | " + fixed(r["ms_median"], 3) + " | " + fixed(r["ms_min"], 3) + " | " + fixed(r["ms_max"], 3) + " | " +
            fixed(r["million_per_second"], 1) + " | " + fixed(double(r["device_peak_bytes"]) / (1 << 20), 1) + " |\n";
  return text;
}

void write_file(const std::string& path, const std::string& text) {
  if (path.empty())
    std::printf("%s\n", text.c_str());
  else
    std::ofstream(path) << text;
}

json device_json() {
  bench::BackendContext context(Backend::cuda);
  const DeviceInfo d = device_info(context);
  int runtime = 0;
  cudaRuntimeGetVersion(&runtime);
  return {{"name", d.name},
          {"driver", d.driver_version.empty() ? "unknown" : d.driver_version},
          {"driver_cuda", d.cuda_version},
          {"toolkit", std::to_string(runtime / 1000) + "." + std::to_string(runtime % 1000 / 10)},
          {"memory_bytes", d.memory_bytes},
          {"flags", ISOSHELL_BENCH_CUDA_FLAGS}};
}

}  // namespace

int main(int argc, char** argv) try {
  const Arguments a = parse(argc, argv);
  json out = {{"bench", "cuda"},           {"mesh", bench::file_name(a.mesh)}, {"resolution", a.resolution},
              {"repeats", a.repeats},      {"machine", bench::machine()},      {"device", device_json()},
              {"commit", ISOSHELL_COMMIT}, {"whole_runs", json::array()},      {"cold_runs", json::array()}};
  RemeshOptions options;
  options.vertices = 4000;
  json& runs = out["whole_runs"];
  runs.push_back(whole_run(a.mesh, "4000 vertices", options, a.repeats));
  options.resolution = a.resolution;
  runs.push_back(whole_run(a.mesh, "4000 vertices, given grid", options, a.repeats));
  options.method = Method::shell;
  runs.push_back(whole_run(a.mesh, "4000 vertices, given grid", options, a.repeats));
  if (!a.big.empty()) {
    RemeshOptions million;
    million.vertices = 1000000;
    runs.push_back(whole_run(a.big, "a million vertices", million, std::min(a.repeats, 3)));
  }
  if (!a.command.empty()) {
    json& cold = out["cold_runs"];
    cold.push_back(cold_run(a, a.mesh, "4000 vertices", "--vertices 4000"));
    if (!a.big.empty()) cold.push_back(cold_run(a, a.big, "a million vertices", "--vertices 1000000"));
  }
  out["stages"] = stage_rows(a);
  write_file(a.json_path, out.dump(1));
  write_file(a.markdown_path, markdown(out));
} catch (const std::exception& e) {
  return bench::failed(argv[0], e);
}
