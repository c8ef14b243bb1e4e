// weld_close and unsettle_named (see insert_contacts.h).
#include <algorithm>

#include "repair/arrangement/insert_contacts.h"

namespace isoshell::repair {
namespace {

/// Per point the one that it becomes: one that stays, so that no chain of points moves far.
std::vector<uint32_t> kept_points(size_t count, const std::vector<Ends>& close) {
  std::vector<Ends> larger_first;
  for (const Ends& e : close) larger_first.push_back({e[1], e[0]});
  std::sort(larger_first.begin(), larger_first.end());
  std::vector<uint32_t> kept(count);
  for (uint32_t v = 0; v < count; ++v) kept[v] = v;
  for (const auto& [v, to] : larger_first)
    if (kept[v] == v && kept[to] == to) kept[v] = to;
  return kept;
}

}  // namespace

void unsettle_named(LatticeFaces& faces, const Contacts& contacts) {
  std::fill(faces.is_unsettled.begin(), faces.is_unsettled.end(), uint8_t(0));
  for (const Contact& c : contacts.found)
    for (const uint32_t f : c.pair) faces.is_unsettled[f] = 1;
  for (const uint32_t f : contacts.near_close) faces.is_unsettled[f] = 1;
  for (const auto& pair : contacts.crossing)
    for (const uint32_t f : pair) faces.is_unsettled[f] = 1;
}

void weld_close(LatticeFaces& faces, const Contacts& contacts) {
  const std::vector<uint32_t> kept = kept_points(faces.point.size(), contacts.close);
  unsettle_named(faces, contacts);
  size_t count = 0;
  for (size_t f = 0; f < faces.face.size(); ++f) {
    Corners corner = faces.face[f];
    for (uint32_t& v : corner) {
      faces.is_unsettled[f] |= kept[v] != v ? 1 : 0;
      v = kept[v];
    }
    if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
    faces.face[count] = corner;
    faces.source[count] = faces.source[f];
    faces.is_unsettled[count++] = faces.is_unsettled[f];
  }
  faces.face.resize(count);
  faces.source.resize(count);
  faces.is_unsettled.resize(count);
}

}  // namespace isoshell::repair
