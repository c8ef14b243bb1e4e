// surface_of_labels (see isoshell/io/memory_input.h).
#include "implicit/labels/label_surface.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>
#include <utility>

#include "core/parallel_ranges.h"
#include "core/wall_memory.h"
#include "geometry/common_step.h"
#include "geometry/world_vector.h"
#include "implicit/labels/absorb_islands.h"
#include "implicit/labels/count_walls.h"
#include "implicit/labels/fair_walls.h"
#include "implicit/labels/place_walls.h"
#include "implicit/labels/read_progress.h"
#include "isoshell/error.h"
#include "isoshell/io/memory_input.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

constexpr size_t kMostNamed = 10;
constexpr int64_t kBytesPerCrossing = sizeof(WallCrossing) + 8;  ///< with what each face says of it
constexpr int64_t kBytesPerRun = 100;                            ///< while islands are looked for; measured: 40 to 100

[[noreturn]] void refuse_use(const std::string& message) { throw Error(ErrorCode::usage, "read", message); }

bool is_periodic(const LabelVolume& volume) {
  const auto& axes = volume.is_periodic;
  return std::any_of(axes.begin(), axes.end(), [](bool is) { return is; });
}

double spanned_world(const LabelVolume& volume) {
  return dot(volume.step_world[0], cross(volume.step_world[1], volume.step_world[2]));
}

void check_volume(const LabelVolume& volume, const std::string& name) {
  int64_t voxels = 1;
  for (const int32_t n : volume.size_vox) {
    if (n < 1 || n > kMaxResolution)
      refuse_use(name + ": a volume of labels has 1 to " + std::to_string(kMaxResolution) +
                 " voxels along each axis, and this one has " + std::to_string(n));
    voxels *= n;
  }
  if (voxels != int64_t(volume.labels.size()))
    refuse_use(name + ": there are " + std::to_string(volume.labels.size()) + " labels for " + std::to_string(voxels) +
               " voxels; give one a voxel");
  const double smoothing = volume.smoothing_vox;
  if (smoothing != 0 && !(smoothing >= LabelVolume::kLeastSmoothing && smoothing <= 1)) {
    std::ostringstream text;
    text << name << ": smoothing is " << smoothing << " voxels; it must be " << LabelVolume::kLeastSmoothing
         << " to 1, or 0 for the faces of voxels";
    refuse_use(text.str());
  }
  const double spanned = spanned_world(volume);
  if (!std::isfinite(spanned) || spanned == 0 || !std::isfinite(length_sq(volume.origin_world)))
    refuse_use(name + ": its steps from voxel to voxel span no volume; give three finite ones that do");
}

void check_memory(const LabelVolume& volume, int64_t bytes, const char* what, const std::string& name,
                  const Context& context) {
  bytes += 4 * int64_t(volume.labels.size()) + kBytesPerCrossing * int64_t(volume.crossings.size());
  if (context.memory_limit_bytes <= 0 || bytes <= context.memory_limit_bytes) return;
  throw Error(ErrorCode::out_of_memory, "read",
              name + ": " + what + " would take about " + readable_bytes(bytes) + ", more than the limit of " +
                  readable_bytes(context.memory_limit_bytes) + "; raise --max-memory, or make the volume coarser");
}

/// Corner (0, 0, 0) is half a voxel before the first centre.
WorldPoint to_world(const LabelVolume& volume, const PointQ8& p) {
  const auto vox = [](int32_t steps) { return double(steps) / kOneVoxelQ8 - 0.5; };
  return volume.origin_world + vox(p.x) * volume.step_world[0] + vox(p.y) * volume.step_world[1] +
         vox(p.z) * volume.step_world[2];
}

/// See FaceRegions::voxel_size_world.
double voxel_size_world(const LabelVolume& volume) {
  return common_step_world(volume.step_world, {volume.size_vox[0], volume.size_vox[1], volume.size_vox[2]});
}

/// Of a periodic volume, whose axes are those of the world, its sides by these.
std::array<uint8_t, 7> sides_of_world(const LabelVolume& volume) {
  std::array<uint8_t, 7> sides{0};
  for (size_t axis = 0; axis < 3; ++axis) {
    const WorldPoint& step = volume.step_world[axis];
    const size_t world = is_periodic(volume) ? world_axis(step) : axis;
    const bool is_reversed = is_periodic(volume) && coordinate(step, world) < 0;
    for (size_t end = 1; end < 3; ++end) sides[2 * axis + end] = uint8_t(2 * world + (is_reversed ? 3 - end : end));
  }
  return sides;
}
WorldPoint period_world(const LabelVolume& volume) {
  double period[3] = {0, 0, 0};
  for (size_t axis = 0; axis < 3; ++axis)
    if (volume.is_periodic[axis])  // the last layer is the first one again
      period[world_axis(volume.step_world[axis])] = (volume.size_vox[axis] - 1) * length(volume.step_world[axis]);
  return {period[0], period[1], period[2]};
}

/// A translation by a period must be one on the lattice. Once the first layer is repeated.
void check_steps_of_periodic(const LabelVolume& volume, const std::string& name) {
  if (is_periodic(volume) && voxel_size_world(volume) == 0)
    refuse_use(name + ": a periodic volume has voxels along the axes of the world whose sides are whole multiples of " +
               "the shortest one; resample it");
}

void check_periodic(const LabelVolume& volume, const std::string& name) {
  if (!is_periodic(volume)) return;
  if (volume.smoothing_vox == 0)
    refuse_use(name + ": a periodic volume has no walls that are faces of its voxels; give a smoothing above 0");
  for (size_t axis = 0; axis < 3; ++axis)
    if (volume.is_periodic[axis] && volume.size_vox[axis] == kMaxResolution)
      refuse_use(name + ": along a periodic axis a volume has fewer voxels than " + std::to_string(kMaxResolution));
}

/// A region by its label and name.
std::string shown(int32_t label, const LabelVolume& volume) {
  for (const RegionName& region : volume.names)
    if (region.label == label) return std::to_string(label) + " (" + region.name + ")";
  return std::to_string(label);
}

/// Says which islands were absorbed, and which regions no longer touch.
void tell_of(const AbsorbedIslands& absorbed, const LabelVolume& volume, const Tell& tell) {
  if (absorbed.islands == 0 || !tell) return;
  tell(MessageKind::warning, counted(absorbed.islands, "island") + " of fewer than " +
                                 counted(volume.smallest_island_vox, "voxel") + ", " + with_commas(absorbed.voxels) +
                                 " in all, got the label around them");
  if (absorbed.lost_pairs.empty()) return;
  std::string text = "regions that touched in such islands alone touch no more:";
  for (size_t i = 0; i < std::min(absorbed.lost_pairs.size(), kMostNamed); ++i)
    text += (i > 0 ? ", " : " ") + shown(absorbed.lost_pairs[i][0], volume) + " and " +
            shown(absorbed.lost_pairs[i][1], volume);
  if (absorbed.lost_pairs.size() > kMostNamed)
    text += " and " + std::to_string(absorbed.lost_pairs.size() - kMostNamed) + " more pairs";
  tell(MessageKind::warning, text);
}

/// Walls with vertices here, with what of them is no geometry. Walls that are faces of voxels are as those of any mesh.
TriangleSoup soup_of(const LabelWalls& walls, const std::vector<PointQ8>& fair, const LabelVolume& volume) {
  TriangleSoup soup;
  soup.triangles.reserve(2 * walls.faces.size());
  soup.regions.labels.reserve(2 * walls.faces.size());
  const bool is_mirrored = spanned_world(volume) < 0;  // which turns faces around
  soup.regions.side.reserve(2 * walls.faces.size());
  const std::array<uint8_t, 7> side_of_world = sides_of_world(volume);
  for (size_t f = 0; f < walls.faces.size(); ++f) {
    const uint8_t side = side_of_world[walls.side_of(f)];
    each_triangle(walls.faces[f], fair, [&](const TriangleIndices& t) {
      soup.regions.side.push_back(side);
      soup.triangles.push_back(is_mirrored ? std::array{t.a, t.c, t.b} : std::array{t.a, t.b, t.c});
      soup.regions.labels.push_back(walls.labels[f]);
    });
  }
  soup.vertices.resize(fair.size());
  for_each_index(size_t(0), fair.size(), [&](size_t v) { soup.vertices[v] = to_world(volume, fair[v]); });
  soup.regions.background = volume.background;
  if (volume.smoothing_vox > 0) {
    soup.regions.are_of_voxels = true;
    soup.regions.voxel_size_world = voxel_size_world(volume);
    soup.regions.period_world = period_world(volume);
  } else {
    soup.regions.side.clear();
  }
  soup.regions.names = volume.names;
  soup.faces_in_file = int64_t(walls.faces.size());
  return soup;
}

/// Says that the background is no region where it is part of what other labels fill: a grain may have its number.
void tell_of_background(const LabelVolume& volume, const Tell& tell) {
  if (!tell) return;
  const auto& [nx, ny, nz] = volume.size_vox;
  int64_t at_sides = 0, others_at_sides = 0, all = 0;
  auto label = volume.labels.begin();
  for (int32_t k = 0; k < nz; ++k)
    for (int32_t j = 0; j < ny; ++j)
      for (int32_t i = 0; i < nx; ++i, ++label) {
        const bool is_background = *label == volume.background;
        all += is_background;
        if (i > 0 && j > 0 && k > 0 && i + 1 < nx && j + 1 < ny && k + 1 < nz) continue;
        (is_background ? at_sides : others_at_sides) += 1;
      }
  if (all == 0 || at_sides >= others_at_sides) return;
  std::ostringstream percent;
  percent << std::setprecision(2) << 100. * double(all) / double(volume.labels.size());
  tell(MessageKind::warning, percent.str() + " % of its voxels have label " + std::to_string(volume.background) +
                                 ", the background, and are no region; where they are one, give another --background");
}

void repeat_first_layer(size_t axis, LabelVolume& volume) {
  const std::array<int32_t, 3> size = volume.size_vox;
  std::array<int64_t, 3> step{1, size[0], int64_t(size[0]) * size[1]};
  const int64_t run = step[axis] * size[axis];  // labels from one first layer to the next one
  std::vector<int32_t> labels;
  labels.reserve(volume.labels.size() / size_t(size[axis]) * size_t(size[axis] + 1));
  for (auto from = volume.labels.begin(); from != volume.labels.end(); from += run) {
    labels.insert(labels.end(), from, from + run);
    labels.insert(labels.end(), from, from + step[axis]);
  }
  volume.labels = std::move(labels);
  ++volume.size_vox[axis];
}

std::vector<PointQ8> places_of(const LabelWalls& walls, const LabelVolume& volume, const Context& context) {
  if (volume.smoothing_vox == 0) return walls.at_rest();
  return volume.crossings.empty() ? fair_walls(walls, volume.smoothing_vox, context)
                                  : place_walls(walls, volume, context);
}

TriangleSoup soup_of_labels(LabelVolume volume, const std::string& name, const Context& context, const Tell& tell,
                            std::vector<WallCrossing>* of_triangles) {
  if (volume.smallest_island_vox > 1)
    check_memory(volume, kBytesPerRun * count_walls(volume, context).runs, "the search for islands among its labels",
                 name, context);
  AbsorbedIslands absorbed = absorb_islands(volume, context);
  tell_of(absorbed, volume, tell);
  tell_of_background(volume, tell);
  tell_read(context, kIslandsAbsorbed);
  for (size_t axis = 0; axis < 3; ++axis) {
    if (!volume.is_periodic[axis]) continue;
    check_memory(volume, 4 * int64_t(volume.labels.size()) * (volume.size_vox[axis] + 1) / volume.size_vox[axis],
                 "a copy of its labels with the first layer repeated", name, context);
    repeat_first_layer(axis, volume);
  }
  check_steps_of_periodic(volume, name);
  const WallCount count = count_walls(volume, context);
  check_memory(volume, bytes_to_make_walls(count.triangles(), count.vertices()), "the walls between its labels", name,
               context);
  const LabelWalls walls = find_label_walls(volume, context);
  volume.labels = {};
  if (walls.faces.empty())
    throw Error(
        ErrorCode::nothing_to_mesh, "read",
        name + ": all its voxels are background, " + std::to_string(volume.background) + "; regions have other labels");
  tell_read(context, kWallsFound);
  const std::vector<PointQ8> places = places_of(walls, volume, context);
  TriangleSoup soup = soup_of(walls, places, volume);
  for (size_t f = 0; of_triangles && f < walls.crossed.size(); ++f)
    each_triangle(walls.faces[f], places,
                  [&](const TriangleIndices&) { of_triangles->push_back(crossing_of(volume, walls.crossed[f])); });
  soup.absorbed_walls = std::move(absorbed.lost_pairs);
  return soup;
}

}  // namespace

TriangleSoup surface_of_labels(LabelVolume volume, const std::string& name, const Context& context, const Tell& tell) {
  return surface_of_labels(std::move(volume), name, context, tell, nullptr);
}

TriangleSoup surface_of_labels(LabelVolume volume, const std::string& name, const Context& context, const Tell& tell,
                               std::vector<WallCrossing>* of_triangles) {
  check_volume(volume, name);
  check_periodic(volume, name);
  tell_read(context, 0);
  TriangleSoup soup =
      run_with_threads(context, [&] { return soup_of_labels(std::move(volume), name, context, tell, of_triangles); });
  tell_read(context, 1);
  return soup;
}

TriangleSoup surface_of_labels(LabelVolume volume, const std::string& name, int64_t memory_limit_bytes,
                               const Tell& tell) {
  Context context;
  context.memory_limit_bytes = memory_limit_bytes;
  return surface_of_labels(std::move(volume), name, context, tell);
}

}  // namespace isoshell
