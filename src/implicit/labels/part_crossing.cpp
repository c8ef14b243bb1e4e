// part_crossing (see part_crossing.h).
#include "implicit/labels/part_crossing.h"

#include <algorithm>

#include "core/watched.h"
#include "implicit/labels/cut_faces.h"
#include "isoshell/advanced/voxel_set.h"
#include "measure/box_tree.h"
#include "measure/crossings.h"

namespace isoshell {
namespace {

constexpr int kHalvings = 4;
constexpr int kMostRounds = 24;
constexpr size_t kFacesOfTask = 8192;

using Faces = std::vector<std::array<uint32_t, 4>>;

/// Of triangles that intersect, ascending.
std::vector<uint32_t> crossing_vertices(const Faces& faces, const std::vector<PointQ8>& position,
                                        const Context& context) {
  const std::vector<TriangleIndices> triangles = triangles_of_faces(faces, position);
  std::vector<uint32_t> found;
  for (const auto& pair : crossing_pairs({position.data(), int64_t(position.size())},
                                         {triangles.data(), int64_t(triangles.size())}, {}, context.cancel))
    for (const uint32_t t : pair) found.insert(found.end(), {triangles[t].a, triangles[t].b, triangles[t].c});
  check_cancel(context, "read");
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

/// The faces that may intersect those at vertices that moved, and these.
Faces faces_near(const LabelWalls& walls, const Buckets<uint32_t>& faces_at, const std::vector<uint32_t>& moved,
                 const std::vector<PointQ8>& position) {
  const auto box = [&](uint32_t f) {
    const auto& [a, b, c, d] = walls.faces[f];
    const BoxQ8 of_three = box_of(position[a], position[b], position[c]);
    return d == kNone ? of_three : joined(of_three, box_of(position[a], position[c], position[d]));
  };
  std::vector<BoxQ8> boxes(moved.size());
  for_each_index(size_t(0), moved.size(), [&](size_t i) {
    const View<const uint32_t> at = faces_at.in(int64_t(moved[i]));
    boxes[i] = box(at[0]);
    for (const uint32_t f : at) boxes[i] = joined(boxes[i], box(f));
  });
  const BoxTree tree(boxes);
  std::vector<Faces> parts((walls.faces.size() + kFacesOfTask - 1) / kFacesOfTask);
  for_each_index(size_t(0), parts.size(), [&](size_t p) {
    for (size_t f = p * kFacesOfTask; f < std::min(walls.faces.size(), (p + 1) * kFacesOfTask); ++f)
      if (!tree.for_all_meeting(box(uint32_t(f)), [](uint32_t) { return false; })) parts[p].push_back(walls.faces[f]);
  });
  Faces near;
  for (const Faces& part : parts) near.insert(near.end(), part.begin(), part.end());
  return near;
}

/// With those that are one with some of these; ascending.
std::vector<uint32_t> with_tied(const LabelWalls& walls, std::vector<uint32_t> vertices) {
  const size_t count = vertices.size();
  for (const std::vector<uint32_t>& group : walls.tied)
    if (std::any_of(group.begin(), group.end(), [&](uint32_t v) {
          return std::binary_search(vertices.begin(), vertices.begin() + int64_t(count), v);
        }))
      vertices.insert(vertices.end(), group.begin(), group.end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

}  // namespace

void part_crossing(const LabelWalls& walls, const Buckets<uint32_t>& faces_at, const std::vector<PointQ8>& parted,
                   std::vector<PointQ8>& position, const Context& context) {
  std::vector<uint8_t> rounds(position.size(), 0);
  std::vector<uint32_t> back = with_tied(walls, crossing_vertices(walls.faces, position, context));
  for (int round = 0; !back.empty(); ++round) {
    if (round == kMostRounds) {
      position = parted;
      return;
    }
    for (const uint32_t v : back) {
      const bool is_last = ++rounds[v] > kHalvings;
      const auto between = [&](int32_t at, int32_t to) { return is_last ? to : to + (at - to) / 2; };
      const PointQ8 &at = position[v], &to = parted[v];
      position[v] = {between(at.x, to.x), between(at.y, to.y), between(at.z, to.z)};
    }
    back = with_tied(walls, crossing_vertices(faces_near(walls, faces_at, back, position), position, context));
  }
}

}  // namespace isoshell
