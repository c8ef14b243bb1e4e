#include "io/mesh/region_pairs.h"

#include <algorithm>
#include <map>

#include "io/bytes/text_scan.h"

namespace isoshell {
namespace {

std::string word_of(int32_t label, const FaceRegions& regions) {
  const auto named = std::lower_bound(regions.names.begin(), regions.names.end(), label,
                                      [](const RegionName& region, int32_t l) { return region.label < l; });
  std::string word = named != regions.names.end() && named->label == label ? named->name : std::to_string(label);
  std::replace_if(
      word.begin(), word.end(), [](char c) { return is_blank(c) || c == '\n' || c == '\r'; }, '_');
  return word;
}

}  // namespace

RegionPairs pairs_of(const FaceRegions& regions) {
  RegionPairs pairs;
  pairs.labels = regions.labels;
  std::sort(pairs.labels.begin(), pairs.labels.end());
  pairs.labels.erase(std::unique(pairs.labels.begin(), pairs.labels.end()), pairs.labels.end());
  for (const std::array<int32_t, 2>& labels : regions.labels)
    pairs.of_face.push_back(
        uint32_t(std::lower_bound(pairs.labels.begin(), pairs.labels.end(), labels) - pairs.labels.begin()));
  return pairs;
}

std::vector<std::string> names_of(const RegionPairs& pairs, const FaceRegions& regions) {
  std::vector<std::string> names;
  std::map<std::string, int> uses;
  for (const auto& [inside, outside] : pairs.labels) {
    names.push_back(word_of(inside, regions) + "_" + word_of(outside, regions));
    ++uses[names.back()];
  }
  for (size_t p = 0; p < names.size(); ++p)
    if (uses[names[p]] > 1) names[p] = std::to_string(pairs.labels[p][0]) + "_" + std::to_string(pairs.labels[p][1]);
  return names;
}

Attribute groups_of_regions(const FaceRegions& regions, const Attribute* groups) {
  const RegionPairs pairs = pairs_of(regions);
  const std::vector<std::string> names = names_of(pairs, regions);
  Attribute both{kGroupName, NumberType::i32, 1, {}, AttributeDomain::face};
  std::map<std::pair<int64_t, uint32_t>, size_t> numbers;  // of a group, -1 being none, and a pair
  for (size_t f = 0; f < pairs.of_face.size(); ++f)
    numbers[{groups ? int64_t(groups->values[f]) : -1, pairs.of_face[f]}];
  for (auto& [group_and_pair, number] : numbers) {
    const auto [group, pair] = group_and_pair;
    number = both.labels.size();
    both.labels.push_back(group < 0 ? names[pair] : groups->labels[size_t(group)] + " " + names[pair]);
  }
  for (size_t f = 0; f < pairs.of_face.size(); ++f)
    both.values.push_back(double(numbers.at({groups ? int64_t(groups->values[f]) : -1, pairs.of_face[f]})));
  return both;
}

}  // namespace isoshell
