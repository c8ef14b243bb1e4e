// find_region_changes (see isoshell/region_census.h).
#include <algorithm>
#include <iterator>
#include <set>

#include "isoshell/region_census.h"

namespace isoshell {
namespace {

using Pair = std::array<int32_t, 2>;

std::set<Pair> pairs_of(const std::vector<RegionWall>& walls) {
  std::set<Pair> pairs;
  for (const RegionWall& wall : walls)
    if (wall.area_world > 0) pairs.insert(wall.labels);
  return pairs;
}

class Namer {
 public:
  Namer(const std::vector<RegionName>& names, int32_t background) : names_(names), background_(background) {}

  RegionName operator()(int32_t label) const {
    if (label == background_) return {label, "background"};
    const auto at = std::lower_bound(names_.begin(), names_.end(), label,
                                     [](const RegionName& name, int32_t of) { return name.label < of; });
    return at != names_.end() && at->label == label ? *at : RegionName{label, ""};
  }

  /// Those of `from` that `without` has not.
  std::vector<std::array<RegionName, 2>> difference(const std::set<Pair>& from, const std::set<Pair>& without) const {
    std::vector<Pair> pairs;
    std::set_difference(from.begin(), from.end(), without.begin(), without.end(), std::back_inserter(pairs));
    std::vector<std::array<RegionName, 2>> named;
    for (const auto& [a, b] : pairs) named.push_back({(*this)(a), (*this)(b)});
    return named;
  }

 private:
  const std::vector<RegionName>& names_;
  int32_t background_;
};

std::set<int32_t> labels_of(const std::set<Pair>& pairs) {
  std::set<int32_t> labels;
  for (const Pair& pair : pairs) labels.insert(pair.begin(), pair.end());
  return labels;
}

}  // namespace

RegionChanges find_region_changes(const SurfaceRegions& before, const RegionCensus& after) {
  const Namer named(before.names, after.background);
  const std::set<Pair> then = pairs_of(before.walls), now = pairs_of(after.walls);
  const std::set<int32_t> left = labels_of(now);
  RegionChanges changes;
  for (const int32_t label : labels_of(then))
    if (left.count(label) == 0 && label != after.background) changes.lost.push_back(named(label));
  changes.lost_walls = named.difference(then, now);
  changes.new_walls = named.difference(now, then);
  changes.absorbed_walls = named.difference({before.absorbed_walls.begin(), before.absorbed_walls.end()}, {});
  for (const RegionCounts& region : after.regions)
    if (const auto was = before.volume_world.find(region.label);
        region.closed && was != before.volume_world.end() && was->second > 0)
      changes.volumes.push_back({named(region.label), was->second, region.volume_world});
  return changes;
}

}  // namespace isoshell
