// See labels.h.
#include "repair/regions/labels.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>

namespace isoshell::repair {
namespace {

constexpr double kWithin = .99;  ///< of a part's volume, and at most of the other's: copies of one part overlap

/// Parts that a cell is inside of, ascending, with how often they wind around it.
using Winding = std::vector<std::pair<uint32_t, int32_t>>;

/// Of a part, from the cells around which it winds: its faces need not agree about the outside.
struct PartVolume {
  double enclosed_world = 0;
  double signed_world = 0;  ///< each cell as often as the part winds around it: below 0 of one that looks inward
};

class CellWalk {
 public:
  CellWalk(const Walls& walls, const Cells& cells, const Chains& chains)
      : walls_(walls),
        cells_(cells),
        chains_(chains),
        winding_(cells.count()),
        volume_(chains.part.size()),
        parent_(chains.part.size(), kNoPart) {
    walk();
    for (size_t cell = 0; cell < cells_.count(); ++cell)
      for (const auto& [part, times] : winding_[cell]) {
        volume_[part].enclosed_world += cells_.volume_world[cell];
        volume_[part].signed_world += times * cells_.volume_world[cell];
      }
  }

  void find_hollows() {
    std::vector<uint8_t> is_done(chains_.part.size(), 0);
    for (size_t w = 0; w < walls_.triangle.size(); ++w)
      for (const PartOnWall& on : chains_.parts_on(w)) {
        const bool looks_inward =
            chains_.part[on.part].closing == Closing::oriented && volume_[on.part].signed_world < 0;
        if (is_done[on.part] || !looks_inward || on.turns == 0) continue;
        is_done[on.part] = 1;
        parent_[on.part] = smallest_around(winding_[cells_.of_wall[w][on.turns > 0 ? 1 : 0]]);
      }
  }

  CellParts parts() const {
    CellParts out;
    out.of_cell.assign(cells_.count(), kNoPart);
    out.volume_world.assign(chains_.part.size(), 0);
    PairVolumes shared;
    for (size_t cell = 0; cell < cells_.count(); ++cell) {
      const std::vector<uint32_t> inside = parts_around(cell);
      for (size_t i = 0; i < inside.size(); ++i) {
        out.volume_world[inside[i]] += cells_.volume_world[cell];
        for (size_t j = 0; j < i; ++j) shared[{inside[j], inside[i]}] += cells_.volume_world[cell];
      }
    }
    const auto is_within = [&](uint32_t part, uint32_t other) {
      const auto both = shared.find({std::min(part, other), std::max(part, other)});
      return both != shared.end() && both->second >= kWithin * out.volume_world[part] &&
             out.volume_world[part] < kWithin * out.volume_world[other];
    };
    std::map<std::pair<uint32_t, uint32_t>, double> overlaps;
    for (size_t cell = 0; cell < cells_.count(); ++cell) {
      const std::vector<uint32_t> inside = parts_around(cell);
      const auto has_none_within = [&](uint32_t part) {
        return std::none_of(inside.begin(), inside.end(), [&](uint32_t other) { return is_within(other, part); });
      };
      const auto keeper = std::find_if(inside.begin(), inside.end(), has_none_within);
      if (keeper == inside.end()) continue;
      out.of_cell[cell] = *keeper;
      for (auto other = keeper + 1; other != inside.end(); ++other)
        if (!is_within(*keeper, *other)) overlaps[{*keeper, *other}] += cells_.volume_world[cell];
    }
    for (const auto& [parts, volume] : overlaps) out.overlaps.push_back({parts.first, parts.second, volume});
    return out;
  }

 private:
  using PairVolumes = std::map<std::pair<uint32_t, uint32_t>, double>;

  /// Parts that a cell is inside of, ascending; for hollows those that have them.
  std::vector<uint32_t> parts_around(size_t cell) const {
    std::map<uint32_t, int32_t> times_inside;
    for (const auto& [part, times] : winding_[cell])
      times_inside[parent_[part] == kNoPart ? part : parent_[part]] += times;
    std::vector<uint32_t> inside;
    for (const auto& [part, times] : times_inside)
      if (times != 0) inside.push_back(part);
    return inside;
  }

  /// From the outside through all walls.
  void walk() {
    std::vector<std::vector<uint32_t>> walls_of(cells_.count());
    for (uint32_t w = 0; w < cells_.of_wall.size(); ++w) {
      const auto& [front, back] = cells_.of_wall[w];
      if (front == back) continue;
      walls_of[front].push_back(w);
      walls_of[back].push_back(w);
    }
    std::vector<uint8_t> is_seen(cells_.count(), 0);
    std::vector<uint32_t> open = {0};
    is_seen[0] = 1;
    for (size_t next = 0; next < open.size(); ++next)
      for (const uint32_t w : walls_of[open[next]]) {
        const auto& [front, back] = cells_.of_wall[w];
        const bool is_inward = open[next] == front;
        const uint32_t to = is_inward ? back : front;
        if (is_seen[to]) continue;
        is_seen[to] = 1;
        winding_[to] = beyond(winding_[open[next]], w, is_inward);
        open.push_back(to);
      }
  }

  Winding beyond(const Winding& before, size_t wall, bool is_inward) const {
    std::map<uint32_t, int32_t> times(before.begin(), before.end());
    for (const PartOnWall& on : chains_.parts_on(wall)) {
      const Closing closing = chains_.part[on.part].closing;
      int32_t& t = times[on.part];
      if (closing == Closing::oriented) t += is_inward ? on.turns : -on.turns;
      if (closing == Closing::even && on.turns != 0) t ^= 1;
      if (closing == Closing::present) t ^= 1;
    }
    Winding after;
    for (const auto& [part, t] : times)
      if (t != 0) after.push_back({part, t});
    return after;
  }

  uint32_t smallest_around(const Winding& winding) const {
    uint32_t smallest = kNoPart;
    for (const auto& [part, times] : winding)
      if (times > 0 && (smallest == kNoPart || volume_[part].enclosed_world < volume_[smallest].enclosed_world))
        smallest = part;
    return smallest;
  }

  const Walls& walls_;
  const Cells& cells_;
  const Chains& chains_;
  std::vector<Winding> winding_;  ///< per cell
  std::vector<PartVolume> volume_;
  std::vector<uint32_t> parent_;  ///< per part the one whose hollow it is
};

}  // namespace

CellParts find_parts_of_cells(const Walls& walls, const Cells& cells, const Chains& chains, bool have_hollows) {
  CellWalk walk(walls, cells, chains);
  if (have_hollows) walk.find_hollows();
  return walk.parts();
}

}  // namespace isoshell::repair
