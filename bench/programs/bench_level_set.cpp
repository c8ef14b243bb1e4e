// The level set of a broken surface against the whole one, and against OpenVDB's meshToVolume. JSON on standard output.
//   bench_level_set WHOLE BROKEN [--resolution R] [--band D] [--threads T] [--samples N]
// WHOLE is closed and oriented, BROKEN is the same surface with faults. Signs of the broken one are compared with those of
// the whole one in every voxel that both have. At N voxels drawn at random, values and signs of the whole one, ours and
// OpenVDB's, are compared with the nearest of all triangles and the winding number. CPU times are of all threads: ours of
// the preparation and the level set of the broken one, OpenVDB's of meshToVolume of the whole one.
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <sys/resource.h>
#include <tbb/global_control.h>

#include <cmath>
#include <random>

#include "bench/programs/program.h"
#include "geometry/triangle_search.h"
#include "isoshell/isoshell.h"
#include "voxel/leaf.h"

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
  LevelSet set;
  double prepare_cpu_ms, cpu_ms;
};

Timed level_set_of(const TriangleSoup& soup, const Arguments& args) {
  bench::BackendContext context(Backend::cpu, args.threads);
  RemeshOptions options;
  options.vertices = 4000;
  options.resolution = args.resolution;
  options.features = {Features::Creases::off, 0};
  options.want_level_set = true;
  options.want_samples = false;
  const double before_ms = cpu_now_ms();
  const Prepared prepared = prepare(soup, options, context);
  const double prepared_ms = cpu_now_ms();
  LevelSet set = level_set(prepared, args.band_vox, context);
  return {std::move(set), prepared_ms - before_ms, cpu_now_ms() - prepared_ms};
}

/// Distance in voxels, negative inside by the winding number.
double exact(const TriangleSoup& soup, WorldPoint p, double voxel) {
  double least_sq = INFINITY, angle = 0;
  for (const auto& t : soup.triangles) {
    const WorldPoint &a = soup.vertices[t[0]], &b = soup.vertices[t[1]], &c = soup.vertices[t[2]];
    least_sq = std::min(least_sq, nearest_of_triangle(p, a, b, c).distance_sq);
    const WorldPoint u = a - p, v = b - p, w = c - p;
    const double lu = length(u), lv = length(v), lw = length(w);
    angle += 2 * std::atan2(dot(u, cross(v, w)), lu * lv * lw + dot(u, v) * lw + dot(v, w) * lu + dot(w, u) * lv);
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

WorldPoint centre_of(const LatticeFrame& f, Voxel v) {
  return {f.origin.x + (v.x + .5) * f.voxel_size, f.origin.y + (v.y + .5) * f.voxel_size,
          f.origin.z + (v.z + .5) * f.voxel_size};
}

/// In the lattice of a level set, whose voxel (0,0,0) is index (0,0,0).
openvdb::FloatGrid::Ptr by_openvdb(const TriangleSoup& soup, const LatticeFrame& frame, const Arguments& args,
                                   double& cpu_ms) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(args.threads));
  std::vector<openvdb::Vec3s> points;
  for (const WorldPoint& p : soup.vertices)
    points.emplace_back(float((p.x - frame.origin.x) / frame.voxel_size - .5),
                        float((p.y - frame.origin.y) / frame.voxel_size - .5),
                        float((p.z - frame.origin.z) / frame.voxel_size - .5));
  std::vector<openvdb::Vec3I> triangles;
  for (const auto& t : soup.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> mesh(points, triangles);
  const double before_ms = cpu_now_ms();
  const auto transform = openvdb::math::Transform::createLinearTransform(1);
  auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(mesh, *transform, float(args.band_vox),
                                                               float(args.band_vox),
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
    const LatticeFrame& frame = whole.set.frame;
    double openvdb_cpu_ms = 0;
    const openvdb::FloatGrid::Ptr theirs = by_openvdb(whole_soup, frame, args, openvdb_cpu_ms);

    Errors of_broken, ours, of_openvdb;
    const VoxelSetView voxels = whole.set.voxels.view(), other = broken.set.voxels.view();
    for (int64_t i = 0; i < whole.set.distance_vox.size(); ++i)
      if (const int64_t j = find_voxel(other, voxel_of_index(voxels, i)); j >= 0)
        of_broken.add(broken.set.distance_vox[j], whole.set.distance_vox[i]);
    std::mt19937_64 random(1);
    const auto values = theirs->getConstAccessor();
    for (int32_t n = 0; n < args.samples; ++n) {
      const auto i = int64_t(random() % uint64_t(whole.set.distance_vox.size()));
      const Voxel v = voxel_of_index(voxels, i);
      const double truth = exact(whole_soup, centre_of(frame, v), frame.voxel_size);
      ours.add(whole.set.distance_vox[i], truth);
      of_openvdb.add(values.getValue({v.x, v.y, v.z}), truth);
    }
    bench::print_result({{"resolution", args.resolution},
                {"active", whole.set.distance_vox.size()},
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
