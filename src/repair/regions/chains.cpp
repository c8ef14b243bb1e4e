// See chains.h.
#include "repair/regions/chains.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/watched.h"
#include "geometry/half_edges.h"
#include "geometry/world_vector.h"

namespace isoshell::repair {
namespace {

/// What a part's walls sum up to at an edge, by each way to count them: 0 where the part is closed there.
struct PartAtEdge {
  uint32_t part;
  int32_t oriented, even, present;
};

class ChainFinder {
 public:
  ChainFinder(const Walls& walls, const Parts& parts, const Context& context)
      : walls_(walls), parts_(parts), watch_(context, "regions") {
    out_.part.resize(parts.count());
    flaws_.assign(parts.count(), {0, 0, 0});
    has_side_.assign(parts.count(), 0);
  }

  Chains found() {
    for (size_t w = 0; w < walls_.triangle.size(); ++w) list_parts(w);
    out_.first.push_back(uint32_t(out_.on_wall.size()));
    for_each_edge(find_edge_sides(walls_.triangle, walls_.point.size()),
                  [&](uint32_t u, uint32_t v, View<const EdgeSide> at_edge) { look_at(u, v, at_edge); });
    for (size_t p = 0; p < flaws_.size(); ++p) {
      size_t closing = has_side_[p] != 0 ? 0 : 2;
      while (closing < 3 && flaws_[p][closing] > 0) ++closing;
      out_.part[p].closing = Closing(closing);
    }
    return std::move(out_);
  }

 private:
  void list_parts(size_t wall) {
    watch_.check();
    out_.first.push_back(uint32_t(out_.on_wall.size()));
    std::vector<std::array<uint32_t, 2>> here;  // part, whether it is turned
    for (const FaceOnWall& f : walls_.faces_on(wall)) here.push_back({parts_.of_face[f.source], f.is_turned ? 1u : 0u});
    std::sort(here.begin(), here.end());
    here.erase(std::unique(here.begin(), here.end()), here.end());
    const auto& [a, b, c] = walls_.triangle[wall];
    const double area = triangle_area(walls_.point[a], walls_.point[b], walls_.point[c]);
    for (size_t i = 0; i < here.size(); ++i) {
      const bool is_both = i + 1 < here.size() && here[i + 1][0] == here[i][0];
      const int8_t turns = is_both ? int8_t(0) : here[i][1] != 0 ? int8_t(-1) : int8_t(1);
      out_.on_wall.push_back({here[i][0], turns});
      has_side_[here[i][0]] |= uint8_t(!is_both);
      out_.part[here[i][0]].area_world += area;
      i += is_both ? 1 : 0;
    }
  }

  void look_at(uint32_t u, uint32_t v, View<const EdgeSide> at_edge) {
    watch_.check();
    std::vector<PartAtEdge> here;
    for (const EdgeSide& s : at_edge) {
      const int32_t rises = walls_.triangle[s.half_edge / 3][s.half_edge % 3] == u ? 1 : -1;
      for (const PartOnWall& on : out_.parts_on(s.half_edge / 3)) {
        auto at = std::find_if(here.begin(), here.end(), [&](const PartAtEdge& p) { return p.part == on.part; });
        if (at == here.end()) at = here.insert(here.end(), {on.part, 0, 0, 0});
        at->oriented += rises * on.turns;
        at->even ^= on.turns != 0 ? 1 : 0;
        at->present ^= 1;
      }
    }
    for (const PartAtEdge& p : here) {
      flaws_[p.part][0] += p.oriented != 0;
      flaws_[p.part][1] += p.even;
      flaws_[p.part][2] += p.present;
      PartOutline& outline = out_.part[p.part];
      if (p.present == 0) continue;
      if (outline.open_edges++ == 0) outline.at = .5 * (walls_.point[u] + walls_.point[v]);
      outline.open_edges_world += length(walls_.point[v] - walls_.point[u]);
    }
  }

  const Walls& walls_;
  const Parts& parts_;
  CancelWatch watch_;
  Chains out_;
  std::vector<std::array<int64_t, 3>> flaws_;  ///< per part and way to count: edges where it is open
  std::vector<uint8_t> has_side_;              ///< per part: on some wall it looks to one side alone
};

}  // namespace

Chains find_chains(const Walls& walls, const Parts& parts, const Context& context) {
  return ChainFinder(walls, parts, context).found();
}

}  // namespace isoshell::repair
