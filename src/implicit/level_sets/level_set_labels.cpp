// See level_set_labels.h.
#include "implicit/level_sets/level_set_labels.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <utility>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "geometry/world_vector.h"
#include "implicit/level_sets/distance_blocks.h"
#include "isoshell/error.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

constexpr double kWidestGap = 1;  ///< voxels; between level sets that face each other, so that none is left between
constexpr double kLeastFacing = -0.6;  ///< cosine between slopes: wedges between two that are wider stay open
constexpr double kTouching = 1. / 64;  ///< voxels: of those that touch a voxel between them may be just outside of both
constexpr double kLeastSlope = 0.1;    ///< of a difference of distances; where both are as far, nothing has a normal
constexpr double kDeep = -1.5;         ///< voxels: bands are as wide, or wider
constexpr int32_t kMargin = 2;         ///< voxels around all that is inside: with gaps, and without walls at the sides

WorldPoint vector_of(Voxel v) { return {double(v.x), double(v.y), double(v.z)}; }

/// What a voxel is nearest to.
struct Standing {
  size_t first = 0, second = 0;  ///< numbers of level sets, by their values
  double first_value = INFINITY, second_value = INFINITY;
  double united = INFINITY;  ///< of all with their gaps closed: below 0 in any region

  /// The number of a level set and 1, or 0.
  int32_t label() const { return united < 0 ? int32_t(first) + 1 : 0; }
  /// Distances are the same in planes alone, unless both are what is said beyond bands.
  bool is_undecided() const { return first_value == second_value && first_value < kDeep; }
};

class LevelSetVoxels {
 public:
  /// What is asked of a voxel needs list_sets().
  explicit LevelSetVoxels(const std::vector<DistanceBlocks>& sets) : sets_(sets) { find_box(); }
  void list_sets();

  bool empty() const { return size_.x == 0; }
  Voxel low() const { return low_; }
  Voxel size() const { return size_; }
  int64_t voxels() const { return int64_t(size_.x) * size_.y * size_.z; }

  Standing standing_at(Voxel v) const;
  /// Of the wall between two voxels with these labels, one step along an axis from one another.
  WallCrossing crossing(Voxel near, Voxel far, int32_t near_label, int32_t far_label) const;

 private:
  void find_box();
  size_t block_of(Voxel v) const {
    const Voxel b{(v.x >> 3) - (low_.x >> 3), (v.y >> 3) - (low_.y >> 3), (v.z >> 3) - (low_.z >> 3)};
    return (size_t(b.x) * size_t(blocks_.y) + size_t(b.y)) * size_t(blocks_.z) + size_t(b.z);
  }
  double united_at(Voxel v, const Standing& standing) const;
  /// How much less the first label's value is than the second one's.
  double difference(Voxel v, int32_t label, int32_t other) const;
  WorldPoint slope_of(Voxel v, int32_t label) const {
    return label == 0 ? WorldPoint{0, 0, 0} : sets_[size_t(label) - 1].slope(v);
  }

  const std::vector<DistanceBlocks>& sets_;
  Voxel low_{0, 0, 0}, size_{0, 0, 0}, blocks_{0, 0, 0};
  std::vector<std::vector<uint32_t>> sets_in_;  ///< per block those that hold anything there, ascending
};

void LevelSetVoxels::find_box() {
  Voxel low{INT32_MAX, INT32_MAX, INT32_MAX}, high{INT32_MIN, INT32_MIN, INT32_MIN};
  for (const DistanceBlocks& set : sets_)
    for (const Voxel& v : set.inside_corners()) {
      low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
      high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
    }
  if (low.x > high.x) return;
  low_ = {low.x - kMargin, low.y - kMargin, low.z - kMargin};
  size_ = {high.x - low.x + 1 + 2 * kMargin, high.y - low.y + 1 + 2 * kMargin, high.z - low.z + 1 + 2 * kMargin};
}

void LevelSetVoxels::list_sets() {
  if (empty()) return;
  const auto along = [](int32_t low, int32_t size) { return ((low + size - 1) >> 3) - (low >> 3) + 1; };
  blocks_ = {along(low_.x, size_.x), along(low_.y, size_.y), along(low_.z, size_.z)};
  sets_in_.resize(size_t(blocks_.x) * size_t(blocks_.y) * size_t(blocks_.z));
  for (uint32_t s = 0; s < sets_.size(); ++s)
    sets_[s].for_each_block([&](Voxel block) {
      const Voxel b{block.x - (low_.x >> 3), block.y - (low_.y >> 3), block.z - (low_.z >> 3)};
      if (b.x < 0 || b.y < 0 || b.z < 0 || b.x >= blocks_.x || b.y >= blocks_.y || b.z >= blocks_.z) return;
      sets_in_[block_of({8 * block.x, 8 * block.y, 8 * block.z})].push_back(s);
    });
}

Standing LevelSetVoxels::standing_at(Voxel v) const {
  Standing found;
  for (const uint32_t s : sets_in_[block_of(v)]) {
    const auto value = double(sets_[s].at(v));
    if (value < found.first_value) {
      found.second = std::exchange(found.first, s);
      found.second_value = std::exchange(found.first_value, value);
    } else if (value < found.second_value) {
      found.second = s;
      found.second_value = value;
    }
  }
  found.united = united_at(v, found);
  return found;
}

/// Outside of all: how far from the ball between the nearest points of the two nearest, where their gap is closed.
double LevelSetVoxels::united_at(Voxel v, const Standing& standing) const {
  const double own = standing.first_value;
  if (own < 0 || !(standing.second_value < kWidestGap)) return own;
  const WorldPoint first = normalised(sets_[standing.first].slope(v)),
                   second = normalised(sets_[standing.second].slope(v));
  const WorldPoint to_first = -own * first, to_second = -standing.second_value * second;
  const double gap = length(to_second - to_first);
  if (gap > kWidestGap || dot(first, second) > kLeastFacing) return own;
  return std::min(own, length(.5 * (to_first + to_second)) - gap / 2 - kTouching);
}

/// The background's is 0, but as much more as the closing of a gap lowers the least value.
double LevelSetVoxels::difference(Voxel v, int32_t label, int32_t other) const {
  const auto value = [&](int32_t of) {
    if (of > 0) return double(sets_[size_t(of) - 1].at(v));
    const Standing standing = standing_at(v);
    return standing.united < standing.first_value ? standing.first_value - standing.united : 0.;
  };
  return value(label) - value(other);
}

WallCrossing LevelSetVoxels::crossing(Voxel near, Voxel far, int32_t near_label, int32_t far_label) const {
  WallCrossing found;
  const double from = difference(near, near_label, far_label), to = difference(far, near_label, far_label);
  if (!(from <= 0 && to >= 0 && to > from)) return found;
  const double at = from / (from - to);
  found.at = float(at);
  const auto slope = [&](Voxel v) { return slope_of(v, near_label) - slope_of(v, far_label); };
  const WorldPoint normal = (1 - at) * slope(near) + at * slope(far);
  const auto is_closed = [&](Voxel v) {
    const Standing standing = standing_at(v);
    return standing.united < standing.first_value;
  };
  if (length(normal) < kLeastSlope) return found;
  if ((near_label == 0 || far_label == 0) && (is_closed(near) || is_closed(far))) return found;
  const WorldPoint unit = normalised(normal);
  found.normal = {float(unit.x), float(unit.y), float(unit.z)};
  return found;
}

double voxel_size_world(const ScalarField& field) { return cube_edge(field.to_world); }

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

/// Result: how many are undecided.
int64_t find_labels(const LevelSetVoxels& voxels, LabelVolume& volume, const Context& context) {
  const Voxel size = voxels.size(), low = voxels.low();
  volume.labels.resize(size_t(voxels.voxels()));
  return sum_over_ranges(size.z, 1, [&](int64_t begin, int64_t end) {
    check_cancel(context, "read");
    int64_t undecided = 0;
    int32_t* to = &volume.labels[size_t(begin) * size_t(size.y) * size_t(size.x)];
    for (auto k = int32_t(begin); k < int32_t(end); ++k)
      for (int32_t j = 0; j < size.y; ++j)
        for (int32_t i = 0; i < size.x; ++i) {
          const Standing standing = voxels.standing_at({low.x + i, low.y + j, low.z + k});
          *to++ = standing.label();
          undecided += standing.is_undecided();
        }
    return undecided;
  });
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

void check_same_lattice(const LevelSets& sets) {
  const auto refuse = [](const std::string& text) { throw Error(ErrorCode::usage, "read", text); };
  const ScalarField& first = *sets.fields.front();
  for (const auto& field : sets.fields) {
    if (!(voxel_size_world(*field) > 0))
      refuse(field->title() + " has voxels that are no cubes; level sets that are regions together have cubes");
    if (!(field->background > 0))
      refuse(field->title() +
             " has a background of 0 or less, which says nothing of what lies beyond its band; give it the width of "
             "the band");
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 4; ++j) {
        const double one = first.to_world.at[i][j], other = field->to_world.at[i][j];
        if (std::abs(one - other) <= 1e-6 * voxel_size_world(first)) continue;
        std::ostringstream text;
        text << field->title() << " has another transform than " << first.title() << ": ";
        if (j == 3)
          text << "its voxel (0, 0, 0) lies at "
               << "xyz"[i] << " = " << other << ", not at " << one;
        else
          text << "its steps from voxel to voxel differ, " << other << " from " << one << " along "
               << "xyz"[i];
        text << "; resample one on the lattice of the other, as OpenVDB's resampleToMatch does";
        refuse(text.str());
      }
  }
}

}  // namespace

std::vector<DistanceBlocks> distance_blocks_of(LevelSets sets, const Context& context) {
  check_same_lattice(sets);
  const std::string file = sets.fields.front()->file;
  const double voxel_size = voxel_size_world(*sets.fields.front());
  std::vector<DistanceBlocks> blocks;
  int64_t bytes = 0;
  for (auto& field : sets.fields) {
    check_memory(bytes, file, context);
    blocks.emplace_back(*field, voxel_size, std::max<int64_t>(context.memory_limit_bytes - bytes, 0));
    bytes += blocks.back().bytes();
    field.reset();
  }
  return blocks;
}

LabelsOfLevelSets labels_of_level_sets(LevelSets sets, const Context& context) {
  const std::string file = sets.fields.front()->file;
  const AffineMap map = sets.fields.front()->to_world;
  const std::vector<std::string> names = std::move(sets.names);
  const std::vector<DistanceBlocks> blocks = distance_blocks_of(std::move(sets), context);
  LevelSetVoxels voxels(blocks);
  if (voxels.empty())
    throw Error(ErrorCode::nothing_to_mesh, "read",
                file + ": no value of its level sets is below 0: none has an inside");
  int64_t bytes = 4 * voxels.voxels();
  for (const DistanceBlocks& set : blocks) bytes += set.bytes();
  check_memory(bytes, file, context);
  voxels.list_sets();
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
  for (size_t s = 0; s < names.size(); ++s) volume.names.push_back({int32_t(s) + 1, names[s]});
  made.undecided_vox = find_labels(voxels, volume, context);
  find_crossings(voxels, volume, context);
  return made;
}

}  // namespace isoshell
