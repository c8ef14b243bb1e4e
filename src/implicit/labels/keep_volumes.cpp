// VolumeKeeper (see keep_volumes.h).
#include "implicit/labels/keep_volumes.h"

#include <algorithm>
#include <cmath>

#include "geometry/wall_pressures.h"
#include "implicit/labels/cut_faces.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

constexpr double kMostOffset_q8 = 64;  ///< where walls cannot go far enough, pressures grow without bounds
constexpr int64_t kFacesOfTask = 8192;

struct Vector {
  int64_t x, y, z;
};
Vector between(const PointQ8& a, const PointQ8& b) { return {b.x - a.x, b.y - a.y, b.z - a.z}; }
Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

uint64_t spanned(const std::array<uint32_t, 4>& face, const std::vector<PointQ8>& position) {
  const auto of = [&](int i, int j, int k) {
    return spanned_volume(position[face[size_t(i)]], position[face[size_t(j)]], position[face[size_t(k)]]);
  };
  if (face[3] == kNone) return of(0, 1, 2);
  return is_cut_from_first(face, position) ? of(0, 1, 2) + of(0, 2, 3) : of(0, 1, 3) + of(1, 2, 3);
}

/// Along the normal, as long as twice the area.
WorldPoint normal_of(const std::array<uint32_t, 4>& face, const std::vector<PointQ8>& position) {
  const auto& [a, b, c, d] = face;
  const Vector n = cross(between(position[a], position[c]), between(position[b], position[d == kNone ? a : d]));
  return {double(n.x), double(n.y), double(n.z)};
}

}  // namespace

VolumeKeeper::VolumeKeeper(const LabelWalls& walls, const Buckets<uint32_t>& faces_at)
    : walls_(walls), faces_at_(faces_at) {
  number_pairs();
  const std::vector<PointQ8> rest = walls.at_rest();
  add_by_pair([&](const std::array<uint32_t, 4>& face, Pair& sum) { sum.rest += spanned(face, rest); });
}

void VolumeKeeper::number_pairs() {
  const auto& labels = walls_.labels;
  std::vector<std::array<int32_t, 2>> found;
  for (size_t f = 0; f < labels.size(); ++f)
    if (f == 0 || labels[f] != labels[f - 1]) found.push_back(labels[f]);
  std::vector<int32_t> regions;
  const auto leave_once = [](auto& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  };
  leave_once(found);
  for (const auto& pair : found) regions.insert(regions.end(), pair.begin(), pair.end());
  leave_once(regions);
  regions_ = regions.size();
  const auto number = [](const auto& list, const auto& item) {
    return uint32_t(std::lower_bound(list.begin(), list.end(), item) - list.begin());
  };
  for (const auto& [inside, outside] : found) pairs_.push_back({{number(regions, inside), number(regions, outside)}});
  pair_of_face_.resize(labels.size());
  for_ranges(int64_t(labels.size()), kFacesOfTask, [&](int64_t begin, int64_t end) {
    for (auto f = size_t(begin); f < size_t(end); ++f)
      pair_of_face_[f] =
          f > size_t(begin) && labels[f] == labels[f - 1] ? pair_of_face_[f - 1] : number(found, labels[f]);
  });
}

/// Calls add(face, sum) for all faces, and adds the sums to those of their pairs.
template <class Add>
void VolumeKeeper::add_by_pair(const Add& add) {
  const auto put = [&](Pair& pair, const Pair& sum) {
    __atomic_fetch_add(&pair.rest, sum.rest, __ATOMIC_RELAXED);
    __atomic_fetch_add(&pair.now, sum.now, __ATOMIC_RELAXED);
    __atomic_fetch_add(&pair.doubled_area, sum.doubled_area, __ATOMIC_RELAXED);
  };
  for_ranges(int64_t(walls_.faces.size()), kFacesOfTask, [&](int64_t begin, int64_t end) {
    Pair sum{};
    for (auto f = size_t(begin); f < size_t(end); ++f) {
      add(walls_.faces[f], sum);
      if (f + 1 < size_t(end) && pair_of_face_[f + 1] == pair_of_face_[f]) continue;
      put(pairs_[pair_of_face_[f]], sum);
      sum = {};
    }
  });
}

std::vector<double> VolumeKeeper::lacking_volumes() const {
  std::vector<uint64_t> lacking(regions_, 0);
  for (const Pair& pair : pairs_) {
    lacking[pair.region[0]] += pair.rest - pair.now;
    lacking[pair.region[1]] -= pair.rest - pair.now;
  }
  std::vector<double> out;
  for (const uint64_t of : lacking) out.push_back(double(int64_t(of)));
  return out;
}

double VolumeKeeper::find_offsets(const std::vector<PointQ8>& position) {
  for (Pair& pair : pairs_) pair.now = 0, pair.doubled_area = 0;
  add_by_pair([&](const std::array<uint32_t, 4>& face, Pair& sum) {
    sum.now += spanned(face, position);
    sum.doubled_area += std::llround(length(normal_of(face, position)));
  });
  std::vector<WallsBetween> areas;
  for (const Pair& pair : pairs_)
    areas.push_back({pair.region, 3 * double(pair.doubled_area)});  // of volumes six times
  const std::vector<double> pressure = pressures_of_regions(areas, lacking_volumes());
  double largest = 0;
  for (Pair& pair : pairs_) {
    pair.offset_q8 = std::clamp(pressure[pair.region[0]] - pressure[pair.region[1]], -kMostOffset_q8, kMostOffset_q8);
    largest = std::max(largest, std::abs(pair.offset_q8));
  }
  return largest;
}

WorldPoint VolumeKeeper::way_of(size_t vertex, const std::vector<PointQ8>& position) const {
  WorldPoint way{0, 0, 0};
  double area = 0;
  for (const uint32_t f : faces_at_.in(int64_t(vertex))) {
    const WorldPoint normal = normal_of(walls_.faces[f], position);
    way = way + pairs_[pair_of_face_[f]].offset_q8 * normal;
    area += length(normal);
  }
  return area > 0 ? (1 / (area * kOneVoxelQ8)) * way : way;
}

}  // namespace isoshell
