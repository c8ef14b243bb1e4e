// surface_of_labels (see isoshell/io/memory_input.h).
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "geometry/world_vector.h"
#include "implicit/labels/absorb_islands.h"
#include "implicit/labels/fair_walls.h"
#include "isoshell/error.h"
#include "isoshell/io/memory_input.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

constexpr size_t kMostNamed = 10;
constexpr int64_t kBytesPerWall = 340;  ///< measured at the peak, over the faces between voxels; of noise a fifth more

[[noreturn]] void refuse_use(const std::string& message) { throw Error(ErrorCode::usage, "read", message); }

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
  const double spanned = spanned_world(volume);
  if (!std::isfinite(spanned) || spanned == 0 || !std::isfinite(length_sq(volume.origin_world)))
    refuse_use(name + ": its steps from voxel to voxel span no volume; give three finite ones that do");
}

/// Faces between voxels of different labels, those at the array's sides left out: O(voxels).
int64_t count_walls(const LabelVolume& volume) {
  const int64_t nx = volume.size_vox[0], ny = volume.size_vox[1], nz = volume.size_vox[2];
  const int32_t* const labels = volume.labels.data();
  return sum_over_ranges(nz, 1, [&](int64_t begin, int64_t end) {
    int64_t count = 0;
    for (int64_t z = begin; z < end; ++z)
      for (int64_t y = 0; y < ny; ++y) {
        const int32_t* const row = labels + (z * ny + y) * nx;
        for (int64_t x = 0; x + 1 < nx; ++x) count += row[x] != row[x + 1];
        if (y + 1 < ny)
          for (int64_t x = 0; x < nx; ++x) count += row[x] != row[x + nx];
        if (z + 1 < nz)
          for (int64_t x = 0; x < nx; ++x) count += row[x] != row[x + nx * ny];
      }
    return count;
  });
}

void check_memory(const LabelVolume& volume, const std::string& name, int64_t limit) {
  if (limit <= 0) return;
  const int64_t bytes = kBytesPerWall * count_walls(volume) + 4 * int64_t(volume.labels.size());
  if (bytes <= limit) return;
  throw Error(ErrorCode::out_of_memory, "read",
              name + ": the walls between its labels would take about " + std::to_string(bytes >> 20) +
                  " MiB, more than the limit of " + std::to_string(limit >> 20) +
                  " MiB; raise --max-memory, or make the volume coarser");
}

/// Corner (0, 0, 0) is half a voxel before the first centre.
WorldPoint to_world(const LabelVolume& volume, const PointQ8& p) {
  const auto vox = [](int32_t steps) { return double(steps) / kOneVoxelQ8 - 0.5; };
  return volume.origin_world + vox(p.x) * volume.step_world[0] + vox(p.y) * volume.step_world[1] +
         vox(p.z) * volume.step_world[2];
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

}  // namespace

TriangleSoup surface_of_labels(LabelVolume volume, const std::string& name, int64_t memory_limit_bytes,
                               const Tell& tell) {
  check_volume(volume, name);
  check_memory(volume, name, memory_limit_bytes);
  AbsorbedIslands absorbed = absorb_islands(volume);
  tell_of(absorbed, volume, tell);
  const LabelWalls walls = find_label_walls(volume);
  if (walls.faces.empty())
    throw Error(
        ErrorCode::nothing_to_mesh, "read",
        name + ": all its voxels are background, " + std::to_string(volume.background) + "; regions have other labels");
  const std::vector<PointQ8> fair = fair_walls(walls);
  const CutFaces cut = cut_faces(walls.faces, fair);
  TriangleSoup soup;
  soup.triangles.resize(cut.triangles.size());
  const bool is_mirrored = spanned_world(volume) < 0;  // which turns faces around
  for_each_index(size_t(0), cut.triangles.size(), [&](size_t t) {
    const auto& [a, b, c] = cut.triangles[t];
    soup.triangles[t] = is_mirrored ? std::array{a, c, b} : std::array{a, b, c};
  });
  soup.vertices.resize(fair.size());
  for_each_index(size_t(0), fair.size(), [&](size_t v) { soup.vertices[v] = to_world(volume, fair[v]); });
  soup.regions.labels.resize(cut.face.size());
  for_each_index(size_t(0), cut.face.size(), [&](size_t t) { soup.regions.labels[t] = walls.labels[cut.face[t]]; });
  soup.regions.background = volume.background;
  soup.regions.are_of_voxels = true;
  soup.regions.names = volume.names;
  soup.absorbed_walls = std::move(absorbed.lost_pairs);
  soup.faces_in_file = int64_t(walls.faces.size());
  return soup;
}

}  // namespace isoshell
