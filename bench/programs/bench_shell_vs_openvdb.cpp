// Our shell against OpenVDB's unsigned distance field of the same mesh at the same voxel size. JSON on standard output.
//   bench_shell_vs_openvdb MESH [--resolution R] [--band D] [--threads T] [--repeats N]
// Every run is a process of its own, ours and theirs in turn, so that neither memory nor caches mix. Half-width is D
// voxels for both. Ours is exact and knows the closest site of every voxel; theirs measures to the triangles.
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <sys/resource.h>
#include <tbb/global_control.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "bench/programs/program.h"
#include "isoshell/isoshell.h"

using namespace isoshell;
using nlohmann::json;

namespace {

struct Arguments {
  std::string mesh, only;  ///< only: "ours" or "openvdb" runs that one here
  int32_t resolution = 1024, band_vox = 3;
  int threads = 2, repeats = 5;
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  a.mesh = bench::read_arguments(argc, argv, "bench_shell_vs_openvdb MESH", 1,
                                 {{"--only", "ours|openvdb", &a.only},
                                  {"--resolution", "R", &a.resolution},
                                  {"--band", "D", &a.band_vox},
                                  {"--threads", "T", &a.threads},
                                  {"--repeats", "N", &a.repeats}})[0];
  return a;
}

/// Of all threads, user and system: says more than the time on the wall on a busy machine.
double cpu_now_ms() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return double(use.ru_utime.tv_sec + use.ru_stime.tv_sec) * 1e3 +
         double(use.ru_utime.tv_usec + use.ru_stime.tv_usec) / 1e3;
}

json run_ours(const Arguments& args) {
  bench::BackendContext context(Backend::cpu, args.threads);
  const TriangleSoup soup = read_mesh(args.mesh);
  const LatticeFrame frame = bench::frame_of(soup, args.resolution);
  const bench::PeakMemory memory;
  const double cpu_before_ms = cpu_now_ms();
  const bench::Watch all;
  const LatticeSurface surface = snap_surface(soup, frame, context);
  const double snapped = all.ms();
  const SiteSet sites = voxelize(surface, context);
  const double voxelized = all.ms();
  ShellOptions options;
  options.band_vox = args.band_vox;
  const Shell shell = build_shell(sites, options, context);
  const double done = all.ms();
  return {{"ms", done},
          {"cpu_ms", cpu_now_ms() - cpu_before_ms},
          {"snap_ms", snapped},
          {"voxelize_ms", voxelized - snapped},
          {"shell_ms", done - voxelized},
          {"peak_mb", memory.mb()},
          {"sites", sites.voxels.voxel_count()},
          {"leaves", shell.voxels.leaf_count()},
          {"active", shell.voxels.voxel_count()}};
}

json run_openvdb(const Arguments& args) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(args.threads));
  openvdb::initialize();
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  const std::vector<openvdb::Vec4I> quads;
  openvdb::math::Transform::Ptr transform;
  {
    const TriangleSoup soup = read_mesh(args.mesh);
    const LatticeFrame frame = bench::frame_of(soup, args.resolution);
    for (const WorldPoint& p : soup.vertices) points.emplace_back(float(p.x), float(p.y), float(p.z));
    for (const auto& t : soup.triangles) triangles.emplace_back(t[0], t[1], t[2]);
    transform = openvdb::math::Transform::createLinearTransform(frame.voxel_size);
    transform->postTranslate({frame.origin.x, frame.origin.y, frame.origin.z});
  }
  const bench::PeakMemory memory;
  const double cpu_before_ms = cpu_now_ms();
  const bench::Watch all;
  const auto grid = openvdb::tools::meshToUnsignedDistanceField<openvdb::FloatGrid>(*transform, points, triangles,
                                                                                    quads, float(args.band_vox));
  const double done = all.ms();
  return {{"ms", done},
          {"cpu_ms", cpu_now_ms() - cpu_before_ms},
          {"peak_mb", memory.mb()},
          {"leaves", grid->tree().leafCount()},
          {"active", grid->activeVoxelCount()}};
}

/// Runs this program for one measurement and reads its JSON.
json in_own_process(const Arguments& args, const std::string& only) {
  char self[4096] = {};
  if (readlink("/proc/self/exe", self, sizeof self - 1) < 0) std::exit(1);
  std::string quoted = "'";
  for (char c : args.mesh) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  const std::string command = std::string(self) + " " + quoted + "' --only " + only + " --resolution " +
                              std::to_string(args.resolution) + " --band " + std::to_string(args.band_vox) +
                              " --threads " + std::to_string(args.threads);
  std::FILE* pipe = popen(command.c_str(), "r");
  std::string text;
  for (int c; pipe && (c = std::fgetc(pipe)) != EOF;) text += char(c);
  if (!pipe || pclose(pipe) != 0) std::exit(1);
  return json::parse(text);
}

/// Smallest, median and largest of every number over the runs; a single number where they agree.
json summary(const std::vector<json>& runs) {
  json out;
  for (const auto& [key, first] : runs.front().items()) {
    std::vector<double> values;
    for (const json& run : runs) values.push_back(run[key].get<double>());
    const bench::Spread s = bench::spread_of(values);
    if (s.least == s.most)
      out[key] = first;
    else
      out[key] = {{"min", s.least}, {"median", s.median}, {"max", s.most}};
  }
  return out;
}

}  // namespace

int main(int argc, char** argv) try {
  const Arguments args = parse(argc, argv);
  if (!args.only.empty()) {
    std::printf("%s\n", (args.only == "ours" ? run_ours(args) : run_openvdb(args)).dump().c_str());
    return 0;
  }
  std::vector<json> ours, theirs;
  for (int i = 0; i < args.repeats; ++i) {
    ours.push_back(in_own_process(args, "ours"));
    theirs.push_back(in_own_process(args, "openvdb"));
  }
  bench::print_result({{"mesh", bench::file_name(args.mesh)},
                       {"resolution", args.resolution},
                       {"band_vox", args.band_vox},
                       {"threads", args.threads},
                       {"repeats", args.repeats},
                       {"ours", summary(ours)},
                       {"openvdb_version", openvdb::getLibraryVersionString()},
                       {"openvdb", summary(theirs)}});
  return 0;
} catch (const std::exception& e) {
  return bench::failed(argv[0], e);
}
