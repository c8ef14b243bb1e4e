#include "measure/crossings.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>

#include "core/watched.h"
#include "voxel/intersect.h"

namespace isoshell {
namespace {

constexpr size_t kChunk = 1024;

struct BoxedTriangle {
  BoxOfPoints box;
  uint32_t triangle;
};

int32_t along(PointQ8 p, int axis) { return axis == 0 ? p.x : (axis == 1 ? p.y : p.z); }

BoxOfPoints box_of(const CornersOfTriangle& t) {
  BoxOfPoints box{t.at[0], t.at[0]};
  for (const PointQ8& p : t.at) {
    box.lo = {std::min(box.lo.x, p.x), std::min(box.lo.y, p.y), std::min(box.lo.z, p.z)};
    box.hi = {std::max(box.hi.x, p.x), std::max(box.hi.y, p.y), std::max(box.hi.z, p.z)};
  }
  return box;
}

BoxOfPoints common_of(const BoxOfPoints& a, const BoxOfPoints& b) {
  return {{std::max(a.lo.x, b.lo.x), std::max(a.lo.y, b.lo.y), std::max(a.lo.z, b.lo.z)},
          {std::min(a.hi.x, b.hi.x), std::min(a.hi.y, b.hi.y), std::min(a.hi.z, b.hi.z)}};
}

int longest_axis(const std::vector<BoxedTriangle>& boxes) {
  BoxOfPoints all = boxes.front().box;
  for (const BoxedTriangle& b : boxes)
    all = {{std::min(all.lo.x, b.box.lo.x), std::min(all.lo.y, b.box.lo.y), std::min(all.lo.z, b.box.lo.z)},
           {std::max(all.hi.x, b.box.hi.x), std::max(all.hi.y, b.box.hi.y), std::max(all.hi.z, b.box.hi.z)}};
  const int32_t x = all.hi.x - all.lo.x, y = all.hi.y - all.lo.y, z = all.hi.z - all.lo.z;
  return x >= y && x >= z ? 0 : (y >= z ? 1 : 2);
}

}  // namespace

std::vector<std::array<uint32_t, 2>> crossing_pairs(View<const PointQ8> position, View<const TriangleIndices> triangles,
                                                    View<const uint32_t> joined, const std::atomic<bool>& stop) {
  if (triangles.size == 0) return {};
  const auto id = [&](uint32_t v) { return v < joined.size ? joined[v] : v; };
  const auto corners = [&](uint32_t t) {
    const TriangleIndices i = triangles[t];
    return CornersOfTriangle{{id(i.a), id(i.b), id(i.c)}, {position[i.a], position[i.b], position[i.c]}};
  };
  std::vector<BoxedTriangle> boxes(size_t(triangles.size));
  for (uint32_t t = 0; t < boxes.size(); ++t) boxes[t] = {box_of(corners(t)), t};
  const int axis = longest_axis(boxes);
  tbb::parallel_sort(boxes.begin(), boxes.end(), [&](const BoxedTriangle& a, const BoxedTriangle& b) {
    const int32_t u = along(a.box.lo, axis), v = along(b.box.lo, axis);
    return u != v ? u < v : a.triangle < b.triangle;
  });
  std::vector<std::vector<std::array<uint32_t, 2>>> parts((boxes.size() + kChunk - 1) / kChunk);
  tbb::parallel_for(size_t(0), parts.size(), [&](size_t c) {
    if (stop.load(std::memory_order_relaxed)) return;
    for (size_t i = c * kChunk; i < std::min(boxes.size(), (c + 1) * kChunk); ++i)
      for (size_t j = i + 1; j < boxes.size() && along(boxes[j].box.lo, axis) <= along(boxes[i].box.hi, axis); ++j)
        if (boxes_meet(boxes[i].box, boxes[j].box) &&
            triangles_intersect(corners(boxes[i].triangle), corners(boxes[j].triangle)))
          parts[c].push_back({boxes[i].triangle, boxes[j].triangle});
  });
  std::vector<std::array<uint32_t, 2>> found;
  for (const auto& part : parts) found.insert(found.end(), part.begin(), part.end());
  return found;
}

std::vector<BoxOfPoints> find_crossings(View<const PointQ8> position, View<const TriangleIndices> triangles,
                                        Context& context) {
  const auto box = [&](uint32_t t) {
    const TriangleIndices i = triangles[t];
    return box_of({{i.a, i.b, i.c}, {position[i.a], position[i.b], position[i.c]}});
  };
  return run_with_threads(context, [&] {
    std::vector<BoxOfPoints> found;
    for (const auto& [a, b] : crossing_pairs(position, triangles, {}, context.cancel))
      found.push_back(common_of(box(a), box(b)));
    check_cancel(context, "crossings");
    return found;
  });
}

int64_t count_apart(const std::vector<BoxOfPoints>& boxes, const std::vector<BoxOfPoints>& others, int32_t reach_q8) {
  int64_t apart = 0;
  for (const BoxOfPoints& b : boxes) {
    const BoxOfPoints wide{{b.lo.x - reach_q8, b.lo.y - reach_q8, b.lo.z - reach_q8},
                           {b.hi.x + reach_q8, b.hi.y + reach_q8, b.hi.z + reach_q8}};
    if (std::none_of(others.begin(), others.end(), [&](const BoxOfPoints& o) { return boxes_meet(wide, o); })) ++apart;
  }
  return apart;
}

}  // namespace isoshell
