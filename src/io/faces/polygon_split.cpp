// Polygons into triangles: ear clipping in the polygon's own best plane.
#include "io/faces/polygon_split.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/world_vector.h"

namespace isoshell {

void PolygonSplitter::split(const WorldPoint* vertices, const uint32_t* corners, int64_t count,
                            std::vector<std::array<uint32_t, 3>>& triangles) {
  const int64_t start = std::min_element(corners, corners + count) - corners;
  ids_.assign(corners + start, corners + count);
  ids_.insert(ids_.end(), corners, corners + start);
  if (count == 3) return emit(0, 1, 2, triangles);
  if (!project(vertices)) {
    for (uint32_t i = 1; i + 1 < count; ++i) emit(0, i, i + 1, triangles);
    return;
  }
  if (count == 4 && split_convex_quad(vertices, triangles)) return;
  clip_ears(vertices, triangles);
}

// Onto the plane of Newell's normal, seen so that the polygon turns left. False when there is no such plane.
bool PolygonSplitter::project(const WorldPoint* vertices) {
  const WorldPoint origin = vertices[ids_[0]];
  WorldPoint normal{0, 0, 0};
  for (size_t i = 1; i + 1 < ids_.size(); ++i)
    normal = normal + cross(vertices[ids_[i]] - origin, vertices[ids_[i + 1]] - origin);
  const double length = std::sqrt(dot(normal, normal));
  if (!(length > 0) || !std::isfinite(length)) return false;
  normal = {normal.x / length, normal.y / length, normal.z / length};
  const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
  const WorldPoint axis = x <= y && x <= z ? WorldPoint{1, 0, 0} : y <= z ? WorldPoint{0, 1, 0} : WorldPoint{0, 0, 1};
  const WorldPoint u = cross(axis, normal), v = cross(normal, u);
  at_.clear();
  for (const uint32_t id : ids_) {
    const WorldPoint offset = vertices[id] - origin;
    at_.push_back({dot(offset, u), dot(offset, v)});
  }
  return true;
}

void PolygonSplitter::emit(uint32_t a, uint32_t b, uint32_t c, std::vector<std::array<uint32_t, 3>>& triangles) const {
  const uint32_t i = ids_[a], j = ids_[b], k = ids_[c];
  if (i != j && j != k && k != i) triangles.push_back({i, j, k});
}

bool PolygonSplitter::split_convex_quad(const WorldPoint* vertices,
                                        std::vector<std::array<uint32_t, 3>>& triangles) const {
  for (uint32_t i = 0; i < 4; ++i)
    if (!(turn((i + 3) % 4, i, (i + 1) % 4) > 0)) return false;
  // Corner 0 has the smallest index, so its diagonal wins a tie.
  const bool other =
      distance_sq(vertices[ids_[1]], vertices[ids_[3]]) < distance_sq(vertices[ids_[0]], vertices[ids_[2]]);
  emit(other, other + 1, other + 2, triangles);
  emit(other, other + 2, (other + 3) % 4, triangles);
  return true;
}

bool PolygonSplitter::later(const Ear& a, const Ear& b) {
  if (a.diagonal_sq != b.diagonal_sq) return a.diagonal_sq > b.diagonal_sq;
  if (a.id != b.id) return a.id > b.id;
  return a.corner > b.corner;
}

// A corner that turns left and whose triangle holds no other corner. Only corners that do not turn left can be in it.
bool PolygonSplitter::is_ear(uint32_t corner) const {
  const uint32_t a = previous_[corner], c = next_[corner];
  if (!(turn(a, corner, c) > 0)) return false;
  return !reflex_.any_in({at_[a], at_[corner], at_[c]}, [&](uint32_t i) {
    const auto same = [&](uint32_t j) { return at_[j].u == at_[i].u && at_[j].v == at_[i].v; };
    return !same(a) && !same(corner) && !same(c);  // where a bridge to a hole runs there and back
  });
}

void PolygonSplitter::look_at(const WorldPoint* vertices, uint32_t corner) {
  ++version_[corner];
  if (!is_ear(corner)) return;
  const double diagonal_sq = distance_sq(vertices[ids_[previous_[corner]]], vertices[ids_[next_[corner]]]);
  ears_.push_back({diagonal_sq, ids_[corner], corner, version_[corner]});
  std::push_heap(ears_.begin(), ears_.end(), later);
}

void PolygonSplitter::clip_ears(const WorldPoint* vertices, std::vector<std::array<uint32_t, 3>>& triangles) {
  const uint32_t count = uint32_t(ids_.size());
  previous_.resize(count);
  next_.resize(count);
  version_.assign(count, 0);
  std::vector<uint32_t> reflex;
  ears_.clear();
  for (uint32_t i = 0; i < count; ++i) {
    previous_[i] = (i + count - 1) % count;
    next_[i] = (i + 1) % count;
    if (!(turn(previous_[i], i, next_[i]) > 0)) reflex.push_back(i);
  }
  reflex_.build(std::move(reflex), at_);
  for (uint32_t i = 0; i < count; ++i) look_at(vertices, i);

  uint32_t left = count, somewhere = 0;
  while (left > 3 && !ears_.empty()) {
    std::pop_heap(ears_.begin(), ears_.end(), later);
    const Ear ear = ears_.back();
    ears_.pop_back();
    if (ear.version != version_[ear.corner]) continue;
    const uint32_t a = previous_[ear.corner], c = next_[ear.corner];
    emit(a, ear.corner, c, triangles);
    next_[a] = c;
    previous_[c] = a;
    reflex_.remove(ear.corner);
    ++version_[ear.corner];
    somewhere = a;
    --left;
    look_at(vertices, a);
    look_at(vertices, c);
  }

  uint32_t hub = somewhere;  // the fan over what is left: one triangle, or the part without ears
  for (uint32_t i = next_[somewhere]; i != somewhere; i = next_[i])
    if (ids_[i] < ids_[hub] || (ids_[i] == ids_[hub] && i < hub)) hub = i;
  for (uint32_t i = next_[hub]; next_[i] != hub; i = next_[i]) emit(hub, i, next_[i], triangles);
}

}  // namespace isoshell
