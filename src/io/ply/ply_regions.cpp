#include "io/ply/ply_regions.h"

#include <algorithm>
#include <limits>

#include "io/bytes/text_scan.h"

namespace isoshell {
namespace {

bool parse_label(const std::string& word, int32_t& label) {
  int64_t number;
  const char *p = word.data(), *const end = p + word.size();
  if (!parse_integer(p, end, number) || p != end) return false;
  if (number < std::numeric_limits<int32_t>::min() || number > std::numeric_limits<int32_t>::max()) return false;
  label = int32_t(number);
  return true;
}

Attribute* find_labels(std::vector<Attribute>& attributes, const char* name) {
  for (Attribute& a : attributes)
    if (a.name == name && a.domain == AttributeDomain::face && !is_real(a.type)) return &a;
  return nullptr;
}

bool part_labels(const Attribute& inside, const Attribute& outside) {
  constexpr double kMost = std::numeric_limits<int32_t>::max();  // of unsigned ones; all types fit below
  for (size_t f = 0; f < inside.values.size(); ++f)
    if (inside.values[f] > kMost || outside.values[f] > kMost) return false;
  return true;
}

/// The last two corners change places, with what they have.
void turn(TriangleSoup& soup, size_t face) {
  std::swap(soup.triangles[face][1], soup.triangles[face][2]);
  for (Attribute& a : soup.attributes) {
    if (a.domain != AttributeDomain::corner) continue;
    const size_t corner = 3 * face + 1, size = size_t(a.components);
    if (!a.index.empty())
      std::swap(a.index[corner], a.index[corner + 1]);
    else
      std::swap_ranges(&a.values[corner * size], &a.values[corner * size] + size, &a.values[(corner + 1) * size]);
  }
}

void take_notes(const PlyHeader& header, FaceRegions& regions) {
  for (const std::vector<std::string>& note : header.notes) {
    if (note[0] == kBackgroundNote) parse_label(note[1], regions.background);
    int32_t label;
    if (note[0] == kRegionNote && parse_label(note[1], label)) regions.names.push_back({label, note[2]});
  }
  const auto is_before = [](const RegionName& a, const RegionName& b) { return a.label < b.label; };
  const auto is_same = [](const RegionName& a, const RegionName& b) { return a.label == b.label; };
  std::stable_sort(regions.names.begin(), regions.names.end(), is_before);
  regions.names.erase(std::unique(regions.names.begin(), regions.names.end(), is_same), regions.names.end());
}

}  // namespace

void take_regions(const MeshSource& source, const PlyHeader& header, TriangleSoup& soup) {
  const Attribute* const inside = find_labels(soup.attributes, kRegionInside);
  const Attribute* const outside = find_labels(soup.attributes, kRegionOutside);
  if (!inside || !outside || inside->values.empty() || !part_labels(*inside, *outside)) return;
  FaceRegions& regions = soup.regions;
  take_notes(header, regions);
  make_room(source, regions.labels, inside->values.size());
  for (size_t f = 0; f < inside->values.size(); ++f)
    regions.labels.push_back({int32_t(inside->values[f]), int32_t(outside->values[f])});
  const auto is_taken = [](const Attribute& a) {
    return a.domain == AttributeDomain::face && (a.name == kRegionInside || a.name == kRegionOutside);
  };
  soup.attributes.erase(std::remove_if(soup.attributes.begin(), soup.attributes.end(), is_taken),
                        soup.attributes.end());
  for (size_t f = 0; f < regions.labels.size(); ++f) {
    auto& [behind, front] = regions.labels[f];
    if (behind == front || front == regions.background || (behind != regions.background && behind < front)) continue;
    std::swap(behind, front);
    turn(soup, f);
  }
}

}  // namespace isoshell
