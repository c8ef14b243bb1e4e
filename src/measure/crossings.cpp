#include "measure/crossings.h"

#include <algorithm>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "voxel/intersect.h"

namespace isoshell {
namespace {

constexpr size_t kChunk = 1024;

BoxOfPoints box_of(const CornersOfTriangle& t) {
  BoxOfPoints box{t.at[0], t.at[0]};
  for (const PointQ8& p : t.at) {
    box.lo = {std::min(box.lo.x, p.x), std::min(box.lo.y, p.y), std::min(box.lo.z, p.z)};
    box.hi = {std::max(box.hi.x, p.x), std::max(box.hi.y, p.y), std::max(box.hi.z, p.z)};
  }
  return box;
}

}  // namespace

BoxOfPoints common_box(View<const PointQ8> position, View<const TriangleIndices> triangles,
                       const std::array<uint32_t, 2>& pair) {
  const auto box = [&](uint32_t t) {
    const TriangleIndices i = triangles[t];
    return box_of({{i.a, i.b, i.c}, {position[i.a], position[i.b], position[i.c]}});
  };
  const BoxOfPoints a = box(pair[0]), b = box(pair[1]);
  return {{std::max(a.lo.x, b.lo.x), std::max(a.lo.y, b.lo.y), std::max(a.lo.z, b.lo.z)},
          {std::min(a.hi.x, b.hi.x), std::min(a.hi.y, b.hi.y), std::min(a.hi.z, b.hi.z)}};
}

std::vector<std::array<uint32_t, 2>> crossing_pairs(View<const PointQ8> position, View<const TriangleIndices> triangles,
                                                    View<const uint32_t> joined, const std::atomic<bool>& stop) {
  if (triangles.size == 0) return {};
  const auto id = [&](uint32_t v) { return v < joined.size ? joined[v] : v; };
  const auto corners = [&](uint32_t t) {
    const TriangleIndices i = triangles[t];
    return CornersOfTriangle{{id(i.a), id(i.b), id(i.c)}, {position[i.a], position[i.b], position[i.c]}};
  };
  std::vector<BoxOfPoints> boxes(size_t(triangles.size));
  for (uint32_t t = 0; t < boxes.size(); ++t) boxes[t] = box_of(corners(t));
  const BoxTree tree(boxes);
  std::vector<std::vector<std::array<uint32_t, 2>>> parts((boxes.size() + kChunk - 1) / kChunk);
  for_each_index(size_t(0), parts.size(), [&](size_t c) {
    for (size_t t = c * kChunk; t < std::min(boxes.size(), (c + 1) * kChunk); ++t) {
      if (stop.load(std::memory_order_relaxed)) return;
      const CornersOfTriangle here = corners(uint32_t(t));
      tree.for_all_meeting(boxes[t], [&](uint32_t other) {
        if (other > t && triangles_intersect(here, corners(other))) parts[c].push_back({uint32_t(t), other});
        return true;
      });
    }
    std::sort(parts[c].begin(), parts[c].end());
  });
  std::vector<std::array<uint32_t, 2>> found;
  for (const auto& part : parts) found.insert(found.end(), part.begin(), part.end());
  return found;
}

std::vector<BoxOfPoints> find_crossings(View<const PointQ8> position, View<const TriangleIndices> triangles,
                                        Context& context) {
  return run_with_threads(context, [&] {
    std::vector<BoxOfPoints> found;
    for (const auto& pair : crossing_pairs(position, triangles, {}, context.cancel))
      found.push_back(common_box(position, triangles, pair));
    check_cancel(context, "crossings");
    return found;
  });
}

std::vector<size_t> which_apart(const std::vector<BoxOfPoints>& boxes, const std::vector<BoxOfPoints>& others,
                                int32_t reach_q8) {
  const BoxTree tree(others);
  std::vector<size_t> apart;
  for (size_t i = 0; i < boxes.size(); ++i) {
    const BoxOfPoints& b = boxes[i];
    const BoxOfPoints wide{{b.lo.x - reach_q8, b.lo.y - reach_q8, b.lo.z - reach_q8},
                           {b.hi.x + reach_q8, b.hi.y + reach_q8, b.hi.z + reach_q8}};
    if (tree.for_all_meeting(wide, [](uint32_t) { return false; })) apart.push_back(i);
  }
  return apart;
}

}  // namespace isoshell
