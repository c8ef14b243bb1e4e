// count_walls (see count_walls.h).
#include "implicit/labels/count_walls.h"

#include <array>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "implicit/labels/label_rows.h"
#include "implicit/labels/wall_corner.h"

namespace isoshell {
namespace {

bool is_parted(int32_t a, int32_t b, int32_t c, int32_t d) {
  return (a == c || b == d) && a != b && WallEdge({a, b, c, d}).is_parted;
}

/// At the corner nearest to the origin of each voxel of a row, or beyond the last one: its three faces and edges there.
WallCount count_row(const LabelRows& labels, int32_t y, int32_t z) {
  WallCount count;
  const int32_t background = labels.background();
  const int32_t* const rows[4] = {labels.row(y - 1, z - 1), labels.row(y, z - 1), labels.row(y - 1, z),
                                  labels.row(y, z)};
  std::array<int32_t, 4> near{background, background, background, background}, far = near;
  for (int32_t x = 0; x <= labels.size(0); ++x) {
    const bool is_inside = x < labels.size(0);
    for (size_t k = 0; k < 4; ++k) far[k] = is_inside ? rows[k][x] : background;
    count.runs += near[3] != far[3] ? 1 : 0;
    bool is_used = false;
    for (size_t k = 0; k < 4; ++k) is_used |= far[k] != near[0] || near[k] != near[0];
    if (is_used) {
      ++count.corners;
      count.faces += (near[3] != far[3] ? 1 : 0) + (far[2] != far[3] ? 1 : 0) + (far[1] != far[3] ? 1 : 0);
      count.parted_edges += is_parted(far[0], far[1], far[3], far[2]) + is_parted(near[1], far[1], far[3], near[3]) +
                            is_parted(near[2], far[2], far[3], near[3]);
    }
    near = far;
  }
  return count;
}

}  // namespace

WallCount count_walls(const LabelVolume& volume, const Context& context) {
  const LabelRows labels(volume);
  WallCount all;
  for_ranges(int64_t(labels.size(2)) + 1, 1, [&](int64_t begin, int64_t end) {
    WallCount count;
    for (int64_t z = begin; z < end; ++z) {
      check_cancel(context, "read");
      for (int32_t y = 0; y <= labels.size(1); ++y) {
        const WallCount row = count_row(labels, y, int32_t(z));
        count.faces += row.faces;
        count.corners += row.corners;
        count.parted_edges += row.parted_edges;
        count.runs += row.runs;
      }
    }
    const auto add = [](int64_t& sum, int64_t more) { __atomic_fetch_add(&sum, more, __ATOMIC_RELAXED); };
    add(all.faces, count.faces);
    add(all.corners, count.corners);
    add(all.parted_edges, count.parted_edges);
    add(all.runs, count.runs);
  });
  return all;
}

}  // namespace isoshell
