// See tied_sides.h.
#include "implicit/labels/tied_sides.h"

#include <algorithm>
#include <utility>

#include "isoshell/advanced/voxel_set.h"
#include "voxel/union_find.h"

namespace isoshell {
namespace {

using Place = std::array<int32_t, 3>;

/// A corner of a face by the middle of that and by itself, but along the axis: a face has four corners there.
struct CornerOfSide {
  Place face, corner;
  uint32_t vertex;

  bool operator<(const CornerOfSide& o) const {
    return face != o.face ? face < o.face : corner != o.corner ? corner < o.corner : vertex < o.vertex;
  }
};

Place place(const Voxel& v, int axis) {
  Place out{v.x, v.y, v.z};
  out[size_t(axis)] = 0;
  return out;
}

std::vector<CornerOfSide> corners_of_side(const LabelWalls& walls, int axis, int side) {
  std::vector<CornerOfSide> out;
  for (size_t f = 0; f < walls.faces.size(); ++f) {
    if (walls.side_of(f) != side) continue;
    Place sum{0, 0, 0};
    for (const uint32_t v : walls.faces[f])
      for (size_t i = 0; i < 3; ++i) sum[i] += place(walls.rest_quarters[v], axis)[i];
    for (const uint32_t v : walls.faces[f]) out.push_back({sum, place(walls.rest_quarters[v], axis), v});
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

void tie_sides(const std::array<bool, 3>& is_periodic, LabelWalls& walls) {
  if (std::none_of(is_periodic.begin(), is_periodic.end(), [](bool is) { return is; })) return;
  std::vector<uint32_t> parent(walls.rest_quarters.size()), members;
  const View<uint32_t> sets{parent.data(), int64_t(parent.size())};
  for (uint32_t v = 0; v < parent.size(); ++v) parent[v] = v;
  for (int axis = 0; axis < 3; ++axis) {
    if (!is_periodic[size_t(axis)]) continue;
    const std::vector<CornerOfSide> low = corners_of_side(walls, axis, 2 * axis + 1),
                                    high = corners_of_side(walls, axis, 2 * axis + 2);
    for (size_t i = 0; i < low.size(); ++i) {  // the same faces, and no edge beside them is parted
      join(sets, low[i].vertex, high[i].vertex);
      members.insert(members.end(), {low[i].vertex, high[i].vertex});
    }
  }
  std::sort(members.begin(), members.end());
  members.erase(std::unique(members.begin(), members.end()), members.end());
  std::vector<std::pair<uint32_t, uint32_t>> by_root;
  for (const uint32_t v : members) {
    PointAtRoot{sets}(v);
    by_root.push_back({parent[v], v});
  }
  std::sort(by_root.begin(), by_root.end());
  for (size_t i = 0; i < by_root.size(); ++i) {
    if (i == 0 || by_root[i].first != by_root[i - 1].first) walls.tied.emplace_back();
    walls.tied.back().push_back(by_root[i].second);
  }
  for (const std::vector<uint32_t>& group : walls.tied) {
    const bool is_thin = std::any_of(group.begin(), group.end(), [&](uint32_t v) { return walls.is_thin[v] != 0; });
    for (const uint32_t v : group) walls.is_thin[v] = is_thin;
  }
}

}  // namespace isoshell
