// See outer_walls.h.
#include "repair/regions/outer_walls.h"

#include "core/buckets.h"
#include "geometry/half_edges.h"

namespace isoshell::repair {
namespace {

using Corners = std::array<uint32_t, 3>;

/// To a neighbouring cell, and by how much more its faces wind around that.
struct Step {
  uint32_t to;
  int32_t change;

  bool operator<(const Step& o) const { return to != o.to ? to < o.to : change < o.change; }
};

/// From a wall's front to its back: once more for each face on it that looks to the front.
int32_t change_behind(const Walls& walls, size_t wall) {
  int32_t change = 0;
  for (const FaceOnWall& on : walls.faces_on(wall)) change += on.is_turned ? -1 : 1;
  return change;
}

/// How often faces wind around each cell.
std::vector<int32_t> winding_numbers(const Walls& walls, const Cells& cells) {
  const Buckets<Step> steps =
      sort_into_buckets<Step>(int64_t(cells.count()), int64_t(walls.triangle.size()), [&](int64_t w, auto put) {
        const int32_t change = change_behind(walls, size_t(w));
        const auto [front, behind] = cells.of_wall[size_t(w)];
        put(front, Step{behind, change});
        put(behind, Step{front, -change});
      });
  std::vector<int32_t> number(cells.count(), 0);
  std::vector<uint8_t> is_reached(cells.count(), 0);
  std::vector<uint32_t> open{0};
  is_reached[0] = 1;
  while (!open.empty()) {
    const uint32_t cell = open.back();
    open.pop_back();
    for (const Step& step : steps.in(cell)) {
      if (is_reached[step.to]) continue;
      is_reached[step.to] = 1;
      number[step.to] = number[cell] + step.change;
      open.push_back(step.to);
    }
  }
  return number;
}

std::vector<uint8_t> solid_cells(const Walls& walls, const Cells& cells, SolidRule rule) {
  std::vector<uint8_t> is_solid(cells.count(), rule == SolidRule::enclosed);
  if (rule == SolidRule::winding) {
    const std::vector<int32_t> number = winding_numbers(walls, cells);
    for (size_t c = 0; c < is_solid.size(); ++c) is_solid[c] = number[c] > 0;
  }
  if (rule == SolidRule::seen_from_back)
    for (size_t w = 0; w < walls.triangle.size(); ++w)
      for (const FaceOnWall& on : walls.faces_on(w)) is_solid[cells.of_wall[w][on.is_turned ? 0 : 1]] = 1;
  is_solid[0] = 0;
  return is_solid;
}

}  // namespace

bool have_closed_chains(const Walls& walls) {
  bool is_closed = true;
  for_each_edge(find_edge_sides(walls.triangle, walls.point.size()),
                [&](uint32_t u, uint32_t, View<const EdgeSide> sides) {
                  int32_t sum = 0;
                  for (const EdgeSide& s : sides) {
                    const int32_t change = change_behind(walls, s.half_edge / 3);
                    sum += walls.triangle[s.half_edge / 3][s.half_edge % 3] == u ? change : -change;
                  }
                  is_closed = is_closed && sum == 0;
                });
  return is_closed;
}

OuterWalls find_outer_walls(const Walls& walls, const Cells& cells, SolidRule rule) {
  const std::vector<uint8_t> is_solid = solid_cells(walls, cells, rule);
  OuterWalls out;
  out.point = walls.point;
  for (size_t w = 0; w < walls.triangle.size(); ++w) {
    const auto& [a, b, c] = walls.triangle[w];
    const auto [front, behind] = cells.of_wall[w];
    if (is_solid[front] != is_solid[behind]) {
      out.face.push_back(is_solid[front] ? Corners{a, c, b} : walls.triangle[w]);
      out.source.push_back(walls.faces_on(w)[0].source);
    } else if (is_solid[front] && front != behind &&
               (change_behind(walls, w) == 0 || rule == SolidRule::seen_from_back)) {
      out.touching.push_back({walls.point[a], walls.point[b], walls.point[c]});
    }
  }
  return out;
}

}  // namespace isoshell::repair
