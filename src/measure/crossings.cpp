#include "measure/crossings.h"

#include <algorithm>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "voxel/intersect.h"

namespace isoshell {
namespace {

constexpr size_t kGroupsOfTask = 128;

}  // namespace

BoxQ8 common_box(View<const PointQ8> position, View<const TriangleIndices> triangles,
                 const std::array<uint32_t, 2>& pair) {
  const auto box = [&](uint32_t t) {
    const TriangleIndices i = triangles[t];
    return box_of(position[i.a], position[i.b], position[i.c]);
  };
  const BoxQ8 a = box(pair[0]), b = box(pair[1]);
  return {largest_of(a.min, b.min), smallest_of(a.max, b.max)};
}

std::vector<std::array<uint32_t, 2>> crossing_pairs(View<const PointQ8> position, View<const TriangleIndices> triangles,
                                                    View<const uint32_t> joined, const std::atomic<bool>& stop) {
  if (triangles.size == 0) return {};
  const auto id = [&](uint32_t v) { return v < joined.size ? joined[v] : v; };
  const auto corners = [&](uint32_t t) {
    const TriangleIndices i = triangles[t];
    return CornersOfTriangle{{id(i.a), id(i.b), id(i.c)}, {position[i.a], position[i.b], position[i.c]}};
  };
  const BoxTree tree(size_t(triangles.size), [&](uint32_t t) {
    const TriangleIndices i = triangles[t];
    return box_of(position[i.a], position[i.b], position[i.c]);
  });
  std::vector<std::vector<std::array<uint32_t, 2>>> parts((tree.groups() + kGroupsOfTask - 1) / kGroupsOfTask);
  for_each_index(size_t(0), parts.size(), [&](size_t p) {
    for (size_t g = p * kGroupsOfTask; g < std::min(tree.groups(), (p + 1) * kGroupsOfTask); ++g) {
      if (stop.load(std::memory_order_relaxed)) return;
      tree.for_pairs_of(g, [&](uint32_t s, uint32_t t) {
        if (triangles_intersect_apart(corners(s), corners(t))) parts[p].push_back({std::min(s, t), std::max(s, t)});
      });
    }
  });
  std::vector<std::array<uint32_t, 2>> found;
  for (const auto& part : parts) found.insert(found.end(), part.begin(), part.end());
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<BoxQ8> find_crossings(View<const PointQ8> position, View<const TriangleIndices> triangles,
                                  Context& context) {
  return run_with_threads(context, [&] {
    std::vector<BoxQ8> found;
    for (const auto& pair : crossing_pairs(position, triangles, {}, context.cancel))
      found.push_back(common_box(position, triangles, pair));
    check_cancel(context, "crossings");
    return found;
  });
}

std::vector<size_t> which_apart(const std::vector<BoxQ8>& boxes, const std::vector<BoxQ8>& others, int32_t reach_q8) {
  const BoxTree tree(others);
  std::vector<size_t> apart;
  for (size_t i = 0; i < boxes.size(); ++i) {
    if (tree.for_all_meeting(widened(boxes[i], reach_q8), [](uint32_t) { return false; })) apart.push_back(i);
  }
  return apart;
}

}  // namespace isoshell
