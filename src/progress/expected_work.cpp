// See expected_work.h. Seconds are of a thread of a 3-GHz processor: medians of runs of 10,000 to 100,000 vertices on
// scans, machine parts, damaged files, level sets and labels. Other machines and more threads change the whole, which
// the meter sees, more than the ratios.
#include "progress/expected_work.h"

namespace isoshell {
namespace {

constexpr double kMicro = 1e-6;

/// Seconds in millionths: for each face of the input, for each vertex of the result, and for each voxel of the surface.
struct Row {
  const char *step, *stage;
  double of_face, of_vertex, of_voxel;
};

// Of any run; later tables replace rows of earlier ones.
constexpr Row kAlways[] = {
    {"read", "", .3, 0, 0},     {"prepare", "topology", .3, 0, 0}, {"triangulate", "dual", 0, 4, 0},
    {"measure", "", 0, 2.2, 0}, {"write", "", 0, .5, 0},
};

// On a grid. Whether there are curves to keep is not known yet: what is between.
constexpr Row kOnGrid[] = {
    {"prepare", "snap", .05, 0, 0}, {"prepare", "voxelize", 0, 0, .05}, {"prepare", "samples", 0, 0, .12},
    {"prepare", "sheet", 0, 0, .6}, {"prepare", "features", .3, 15, 0}, {"risks", "", .05, 0, .05},
    {"relax", "", 0, 110, 0},       {"triangulate", "post", 0, 55, 0},
};

constexpr Row kWithoutCurves[] = {
    {"relax", "", 0, 90, 0},
    {"triangulate", "post", 0, 43, 0},
};

// Some patches are meshed more than once.
constexpr Row kWithCurves[] = {
    {"relax", "", 0, 165, 0},
    {"triangulate", "post", 0, 110, 0},
    {"triangulate", "coarsen", 0, 50, 0},
    {"triangulate", "features", 0, 5, 0},
    {"triangulate", "relax", 0, 10, 0},
    {"triangulate", "", 0, 10, 0},
};

constexpr Row kOfRegions[] = {
    {"prepare", "features", .5, 40, 0},
    {"relax", "", 0, 150, 0},
    {"triangulate", "post", 0, 65, 0},
    {"triangulate", "angles", 0, 5, 0},
    {"triangulate", "coarsen", 0, 8, 0},
    {"triangulate", "", 0, 10, 0},
    {"measure", "", 0, 6, 0},
};

constexpr Row kOfVoxels[] = {
    {"prepare", "features", 0, 28, 0},
    {"relax", "", 0, 300, 0},
    {"triangulate", "volumes", 0, 8, 0},
};

constexpr Row kDistances[] = {{"distance", "", .2, 15, 0}};

}  // namespace

std::vector<ExpectedWork> expected_work(const RunSize& size) {
  std::vector<ExpectedWork> work;
  const auto add = [&](const auto& rows) {
    for (const Row& row : rows)
      work.push_back(
          {row.step, row.stage,
           kMicro / size.speed *
               (row.of_face * size.faces + row.of_vertex * size.vertices + row.of_voxel * size.surface_voxels)});
  };
  add(kAlways);
  if (size.has_regions)
    add(kOfRegions);
  else
    add(kOnGrid);
  if (size.are_of_voxels) add(kOfVoxels);
  if (size.has_curves && !size.has_regions) *size.has_curves ? add(kWithCurves) : add(kWithoutCurves);
  if (size.measures_distance) add(kDistances);
  return work;
}

std::vector<ExpectedWork> expected_work_of_info(double faces, double reference_faces) {
  std::vector<ExpectedWork> work{{"read", "", kMicro * .3 * (faces + reference_faces)},
                                 {"census", "", kMicro * 3 * faces}};
  if (reference_faces > 0) work.push_back({"distance", "", kMicro * (8 * (faces + reference_faces)) + .3});
  return work;
}

}  // namespace isoshell
