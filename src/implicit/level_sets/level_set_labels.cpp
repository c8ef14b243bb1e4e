// See level_set_labels.h.
#include "implicit/level_sets/level_set_labels.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "implicit/level_sets/level_set_voxels.h"
#include "isoshell/error.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

WorldPoint vector_of(Voxel v) { return {double(v.x), double(v.y), double(v.z)}; }

/// Calls visit(near, far, axis) for the pairs of voxels along which a wall runs whose far one has this z, ascending as
/// WallCrossing::face is. Voxels are those of the volume.
template <class Visit>
void each_wall(const LabelVolume& volume, int32_t z, const Visit& visit) {
  const int32_t nx = volume.size_vox[0], ny = volume.size_vox[1];
  const auto label = [&](int32_t i, int32_t j, int32_t k) {
    return volume.labels[(size_t(k) * size_t(ny) + size_t(j)) * size_t(nx) + size_t(i)];
  };
  for (int32_t j = 0; j < ny; ++j)
    for (int32_t i = 0; i < nx; ++i) {
      const int32_t own = label(i, j, z);
      if (i > 0 && label(i - 1, j, z) != own) visit(Voxel{i - 1, j, z}, Voxel{i, j, z}, 0);
      if (j > 0 && label(i, j - 1, z) != own) visit(Voxel{i, j - 1, z}, Voxel{i, j, z}, 1);
      if (z > 0 && label(i, j, z - 1) != own) visit(Voxel{i, j, z - 1}, Voxel{i, j, z}, 2);
    }
}

/// What is counted as labels are found.
struct Counts {
  std::vector<int64_t> of_set;                             ///< voxels that each level set has
  std::map<std::pair<size_t, size_t>, int64_t> undecided;  ///< by the level sets that are as deep there

  void add(const Counts& other) {
    for (size_t s = 0; s < of_set.size(); ++s) of_set[s] += other.of_set[s];
    for (const auto& [pair, count] : other.undecided) undecided[pair] += count;
  }
};

Counts find_labels(const LevelSetVoxels& voxels, size_t sets, LabelVolume& volume, const Context& context) {
  const Voxel size = voxels.size(), low = voxels.low();
  volume.labels.resize(size_t(voxels.voxels()));
  Counts all{std::vector<int64_t>(sets), {}};
  std::mutex adding;
  for_ranges(size.z, 1, [&](int64_t begin, int64_t end) {
    check_cancel(context, "read");
    Counts counts{std::vector<int64_t>(sets), {}};
    int32_t* to = &volume.labels[size_t(begin) * size_t(size.y) * size_t(size.x)];
    for (auto k = int32_t(begin); k < int32_t(end); ++k)
      for (int32_t j = 0; j < size.y; ++j)
        for (int32_t i = 0; i < size.x;) {
          const Voxel row{low.x + i, low.y + j, low.z + k};
          const std::vector<uint32_t>& sets_around = voxels.sets_around(row);
          const int32_t end_of_block = std::min(size.x, i + kFieldBlock - (row.x & (kFieldBlock - 1)));
          for (; i < end_of_block; ++i) {
            const Standing standing = voxels.standing_at({low.x + i, row.y, row.z}, sets_around);
            *to++ = standing.label();
            if (standing.label() > 0) ++counts.of_set[standing.first];
            if (voxels.is_undecided(standing)) ++counts.undecided[std::minmax(standing.first, standing.second)];
          }
        }
    const std::lock_guard<std::mutex> lock(adding);
    all.add(counts);
  });
  return all;
}

/// Which level set has most of the inside of one that has no voxel.
size_t holder_of(const LevelSetVoxels& voxels, size_t set, size_t sets, const LabelVolume& volume) {
  std::vector<int64_t> counts(sets + 1);
  const std::vector<Voxel>& corners = voxels.set(set).inside_corners();
  const Voxel low = voxels.low(), size = voxels.size();
  for (int32_t z = corners[0].z; z <= corners[1].z; ++z)
    for (int32_t y = corners[0].y; y <= corners[1].y; ++y)
      for (int32_t x = corners[0].x; x <= corners[1].x; ++x)
        if (voxels.set(set).at({x, y, z}) < 0)
          ++counts[size_t(volume.labels[size_t((int64_t(z - low.z) * size.y + y - low.y) * size.x + x - low.x)])];
  return size_t(std::max_element(counts.begin() + 1, counts.end()) - counts.begin()) - 1;
}

/// Of each level set that has no voxel, and of pairs that no values tell apart.
std::vector<std::string> warnings_of(const LevelSetVoxels& voxels, const std::vector<std::string>& names,
                                     const LabelVolume& volume, const Counts& counts) {
  std::vector<std::string> warnings;
  const auto quoted = [&](size_t set) { return '"' + names[set] + '"'; };
  for (size_t s = 0; s < names.size(); ++s) {
    if (counts.of_set[s] > 0) continue;
    if (voxels.set(s).inside_corners().empty())
      warnings.push_back("level set " + quoted(s) +
                         " holds no voxel, as none of its values is below 0: it is no region");
    else
      warnings.push_back("level set " + quoted(s) + " lies within " +
                         quoted(holder_of(voxels, s, names.size(), volume)) +
                         ", which has all its space: it is no region; take it away from the one around it");
  }
  int64_t all = 0, most = 0, pairs = 0;
  std::pair<size_t, size_t> worst;
  for (const auto& [pair, count] : counts.undecided) {
    if (counts.of_set[pair.first] == 0 || counts.of_set[pair.second] == 0) continue;
    all += count;
    ++pairs;
    if (count > most) most = count, worst = pair;
  }
  if (pairs > 0)
    warnings.push_back("level sets " + quoted(worst.first) + " and " + quoted(worst.second) +
                       (pairs > 1 ? ", and " + counted(pairs - 1, "other pair") + "," : "") +
                       " overlap deeper than their bands reach, in " + counted(all, "voxel") +
                       ": there the first one has the space, up to a wall that no values place; make the bands of all "
                       "level sets wider");
  return warnings;
}

void find_crossings(const LevelSetVoxels& voxels, LabelVolume& volume, const Context& context) {
  const Voxel low = voxels.low(), size = voxels.size();
  std::vector<std::vector<WallCrossing>> layers(static_cast<size_t>(size.z));
  const auto index = [&](Voxel v) { return (int64_t(v.z) * size.y + v.y) * size.x + v.x; };
  const auto moved = [&](Voxel v) { return Voxel{low.x + v.x, low.y + v.y, low.z + v.z}; };
  for_each_index(int32_t(0), size.z, [&](int32_t k) {
    check_cancel(context, "read");
    each_wall(volume, k, [&](Voxel near, Voxel far, int axis) {
      WallCrossing crossing = voxels.crossing(moved(near), moved(far), volume.labels[size_t(index(near))],
                                              volume.labels[size_t(index(far))]);
      crossing.face = 3 * index(far) + axis;
      layers[size_t(k)].push_back(crossing);
    });
  });
  for (std::vector<WallCrossing>& layer : layers) {
    volume.crossings.insert(volume.crossings.end(), layer.begin(), layer.end());
    layer = {};
  }
}

void check_memory(int64_t bytes, const std::string& file, const Context& context) {
  if (context.memory_limit_bytes <= 0 || bytes <= context.memory_limit_bytes) return;
  throw Error(ErrorCode::out_of_memory, "read",
              file + ": its level sets as regions would take about " + readable_bytes(bytes) +
                  ", more than the limit of " + readable_bytes(context.memory_limit_bytes) +
                  "; raise --max-memory, or resample them coarser");
}

}  // namespace

LabelsOfLevelSets labels_of_level_sets(const LevelSets& sets, const Context& context) {
  const std::string& file = sets.file;
  const AffineMap& map = sets.to_world;
  const std::vector<std::string>& names = sets.names;
  const LevelSetVoxels voxels(sets.blocks, names, file);
  if (voxels.empty())
    throw Error(ErrorCode::nothing_to_mesh, "read",
                file + ": no value of its level sets is below 0: none has an inside");
  check_memory(4 * voxels.voxels() + sets.bytes(), file, context);
  LabelsOfLevelSets made;
  LabelVolume& volume = made.volume;
  volume.size_vox = {voxels.size().x, voxels.size().y, voxels.size().z};
  const WorldPoint low = vector_of(voxels.low());
  double origin[3];
  for (int i = 0; i < 3; ++i) {
    volume.step_world[size_t(i)] = {map.at[0][i], map.at[1][i], map.at[2][i]};
    origin[i] = map.at[i][0] * low.x + map.at[i][1] * low.y + map.at[i][2] * low.z + map.at[i][3];
  }
  volume.origin_world = {origin[0], origin[1], origin[2]};
  const Counts counts = find_labels(voxels, names.size(), volume, context);
  for (size_t s = 0; s < names.size(); ++s)
    if (counts.of_set[s] > 0) volume.names.push_back({int32_t(s) + 1, names[s]});
  made.warnings = warnings_of(voxels, names, volume, counts);
  find_crossings(voxels, volume, context);
  return made;
}

}  // namespace isoshell
