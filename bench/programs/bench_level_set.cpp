// The level set of a broken surface against the whole one, and against OpenVDB's meshToVolume. JSON on standard output.
//   bench_level_set WHOLE BROKEN [--resolution R] [--band D] [--threads T] [--samples N]
// WHOLE is closed and oriented, BROKEN is the same surface with faults. Signs of the broken one are compared with those
// of the whole one in every voxel that both have. At about N voxels drawn at random, values and signs of the whole one,
// ours and OpenVDB's, are compared with the nearest of all triangles and the winding number. CPU times are of all
// threads: ours of the preparation and the level set of the broken one, OpenVDB's of meshToVolume of the whole one.
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <sys/resource.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "bench/programs/program.h"
#include "isoshell/advanced/level_set.h"
#include "isoshell/io/vdb_file.h"
#include "isoshell/isoshell.h"

using namespace isoshell;
using nlohmann::json;

namespace {

struct Arguments {
  std::string whole, broken;
  int32_t resolution = 512, band_vox = 3, samples = 2000;
  int threads = 1;
};

double cpu_now_ms() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return double(use.ru_utime.tv_sec + use.ru_stime.tv_sec) * 1e3 +
         double(use.ru_utime.tv_usec + use.ru_stime.tv_usec) / 1e3;
}

struct Timed {
  openvdb::FloatGrid::Ptr grid;  ///< as OpenVDB reads it from the file
  double prepare_cpu_ms, cpu_ms;
};

openvdb::FloatGrid::Ptr through_file(const LevelSet& set) {
  const std::string path = "bench_level_set." + std::to_string(getpid()) + ".vdb";
  save_level_set(path, set);
  openvdb::io::File file(path);
  file.open(false);
  auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("surface"));
  file.close();
  std::remove(path.c_str());
  return grid;
}

Timed level_set_of(const TriangleSoup& soup, const Arguments& args) {
  bench::BackendContext context(Backend::cpu, args.threads);
  RemeshOptions options;
  options.vertices = 4000;
  options.resolution = args.resolution;
  options.features = {Features::Creases::off, 0};
  options.level_set_band_vox = 3;
  options.want_samples = false;
  const double before_ms = cpu_now_ms();
  const Prepared prepared = prepare(soup, options, context);
  const double prepared_ms = cpu_now_ms();
  const LevelSet set = level_set(prepared, args.band_vox, context);
  const double done_ms = cpu_now_ms();
  return {through_file(set), prepared_ms - before_ms, done_ms - prepared_ms};
}

using openvdb::Vec3d;

Vec3d vector_of(const WorldPoint& p) { return {p.x, p.y, p.z}; }

Vec3d nearest_on_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const double along = (p - a).dot(b - a) / std::max((b - a).lengthSqr(), 1e-300);
  return a + std::clamp(along, 0., 1.) * (b - a);
}

double distance_sq(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d n = (b - a).cross(c - a);
  const bool is_over = n.dot((b - a).cross(p - a)) >= 0 && n.dot((c - b).cross(p - b)) >= 0 &&
                       n.dot((a - c).cross(p - c)) >= 0 && n.lengthSqr() > 0;
  if (is_over) return std::pow(n.dot(p - a), 2) / n.lengthSqr();
  return std::min({(p - nearest_on_segment(p, a, b)).lengthSqr(), (p - nearest_on_segment(p, b, c)).lengthSqr(),
                   (p - nearest_on_segment(p, c, a)).lengthSqr()});
}

/// Distance in voxels, negative inside by the winding number.
double exact(const TriangleSoup& soup, const Vec3d& p, double voxel) {
  double least_sq = INFINITY, angle = 0;
  for (const auto& t : soup.triangles) {
    const Vec3d a = vector_of(soup.vertices[t[0]]), b = vector_of(soup.vertices[t[1]]),
                c = vector_of(soup.vertices[t[2]]), u = a - p, v = b - p, w = c - p;
    least_sq = std::min(least_sq, distance_sq(p, a, b, c));
    const double lu = u.length(), lv = v.length(), lw = w.length();
    angle += 2 * std::atan2(u.dot(v.cross(w)), lu * lv * lw + u.dot(v) * lw + v.dot(w) * lu + w.dot(u) * lv);
  }
  const double distance = std::sqrt(least_sq) / voxel;
  return angle > 2 * M_PI ? -distance : distance;
}

struct Errors {
  int64_t looked_at = 0, wrong_sign = 0, wrong_sign_beyond_a_voxel = 0, off = 0;
  double worst_vox = 0;

  void add(double value, double truth) {
    ++looked_at;
    const double error = std::abs(std::abs(value) - std::abs(truth));
    worst_vox = std::max(worst_vox, error);
    off += error > 1e-4 ? 1 : 0;
    if ((value < 0) == (truth < 0) || std::abs(truth) < 1e-5) return;
    ++wrong_sign;
    wrong_sign_beyond_a_voxel += std::abs(truth) > 1 ? 1 : 0;
  }
  json to_json() const {
    return {{"looked_at", looked_at},
            {"wrong_sign", wrong_sign},
            {"wrong_sign_beyond_a_voxel", wrong_sign_beyond_a_voxel},
            {"off_by_more_than_1e-4", off},
            {"worst_vox", worst_vox}};
  }
};

openvdb::FloatGrid::Ptr by_openvdb(const TriangleSoup& soup, const openvdb::FloatGrid& ours, const Arguments& args,
                                   double& cpu_ms) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(args.threads));
  std::vector<openvdb::Vec3s> points;
  for (const WorldPoint& p : soup.vertices) points.emplace_back(ours.worldToIndex(vector_of(p)));
  std::vector<openvdb::Vec3I> triangles;
  for (const auto& t : soup.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> mesh(points, triangles);
  const auto band = float(args.band_vox);
  const double before_ms = cpu_now_ms();
  auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(mesh, ours.transform(), band, band,
                                                               openvdb::tools::DISABLE_RENORMALIZATION);
  cpu_ms = cpu_now_ms() - before_ms;
  return grid;
}

}  // namespace

int main(int argc, char** argv) try {
  Arguments args;
  const std::vector<std::string> names = bench::read_arguments(argc, argv, "bench_level_set WHOLE BROKEN", 2,
                                                               {{"--resolution", "R", &args.resolution},
                                                                {"--band", "D", &args.band_vox},
                                                                {"--threads", "T", &args.threads},
                                                                {"--samples", "N", &args.samples}});
  openvdb::initialize();
  const TriangleSoup whole_soup = read_mesh(names[0]), broken_soup = read_mesh(names[1]);
  const Timed whole = level_set_of(whole_soup, args), broken = level_set_of(broken_soup, args);
  const openvdb::FloatGrid& grid = *whole.grid;
  double openvdb_cpu_ms = 0;
  const openvdb::FloatGrid::Ptr theirs = by_openvdb(whole_soup, grid, args, openvdb_cpu_ms);

  Errors of_broken, ours, of_openvdb;
  const double voxel = grid.voxelSize()[0];
  const auto of_the_broken = broken.grid->getConstAccessor(), of_theirs = theirs->getConstAccessor();
  std::mt19937_64 random(1);
  for (auto value = grid.cbeginValueOn(); value; ++value) {
    const openvdb::Coord at = value.getCoord();
    if (of_the_broken.isValueOn(at)) of_broken.add(of_the_broken.getValue(at) / voxel, *value / voxel);
    if (random() % grid.activeVoxelCount() >= uint64_t(args.samples)) continue;
    const double truth = exact(whole_soup, grid.indexToWorld(at), voxel);
    ours.add(*value / voxel, truth);
    of_openvdb.add(of_theirs.getValue(at) / voxel, truth);
  }
  bench::print_result({{"resolution", args.resolution},
                       {"active", grid.activeVoxelCount()},
                       {"active_openvdb", theirs->activeVoxelCount()},
                       {"broken_against_whole", of_broken.to_json()},
                       {"whole_against_exact", ours.to_json()},
                       {"openvdb_against_exact", of_openvdb.to_json()},
                       {"prepare_cpu_ms", broken.prepare_cpu_ms},
                       {"level_set_cpu_ms", broken.cpu_ms},
                       {"openvdb_cpu_ms", openvdb_cpu_ms}});
  return 0;
} catch (const std::exception& error) {
  return bench::failed(argv[0], error);
}
