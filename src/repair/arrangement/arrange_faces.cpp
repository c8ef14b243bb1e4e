// See arrange_faces.h.
#include "repair/arrangement/arrange_faces.h"

#include "core/watched.h"
#include "geometry/box.h"
#include "geometry/triangle_list.h"
#include "geometry/weld.h"
#include "measure/box_tree.h"
#include "repair/arrangement/find_contacts.h"
#include "repair/arrangement/insert_contacts.h"
#include "repair/arrangement/step_frame.h"

namespace isoshell::repair {
namespace {

// What is bent through points within reach may come into reach of others, and again, where many surfaces are nearly
// one. After some rounds only what meets is cut, and what is bent then is bent by as little as points are rounded by;
// what still meets then, by more from round to round. Where contacts grow in number instead, faces cross at small
// angles: all is begun again, with only what meets.
constexpr double kReachSteps = 128 * kFine;
constexpr double kMostReachSteps = kFine * (1 << 24);  // a 16th of the longest side; boxes are numbers of 32 bits
constexpr int kNearEdgeRounds = 3, kFullRounds = 6;  // in which edges and faces that are near, but do not meet, are cut
constexpr int kMostRounds = 32;
constexpr int kFirstRounds = 4;      // in which parts that lie on each other have most of their contacts
constexpr size_t kFewContacts = 64;  // these may grow in number
constexpr double kReachGrowth = 4;   // from round to round, of what meets

// Of all attempts together: half of what is left for each, and the rest for the last one. Parts that touch or overlap
// take up to 40 pairs and two contacts a triangle; soups in one plane would take thousands of times that.
constexpr int64_t kLeastWork = 1 << 27, kWorkOfTriangle = 1 << 13;

LatticeFaces snapped(const TriangleSoup& soup, const WeldedVertices& welded, const StepFrame& frame) {
  LatticeFaces faces;
  faces.point.reserve(welded.position.size());
  for (const WorldPoint& p : welded.position) faces.point.push_back(frame.from(p));
  for (uint32_t t = 0; t < soup.triangles.size(); ++t) {
    Corners corner = soup.triangles[t];
    for (uint32_t& v : corner) v = welded.place[v];
    if (repeats_corner(corner)) continue;
    faces.face.push_back(corner);
    faces.source.push_back(t);
  }
  faces.is_unsettled.assign(faces.face.size(), 1);
  return faces;
}

BoxOf<StepPoint> box_of_face(const LatticeFaces& faces, size_t f) {
  const Corners& c = faces.face[f];
  return box_of(faces.point[c[0]], faces.point[c[1]], faces.point[c[2]]);
}

bool is_of_first(const LatticeFaces& faces, size_t f, size_t first_of_second) {
  return faces.source[f] < first_of_second;
}

/// Of two groups the faces whose boxes meet some of the other one are unsettled, and no others. Result: whether any
/// are.
bool unsettle_near(LatticeFaces& faces, size_t first_of_second) {
  const auto box = [&](size_t f) { return coarse(widened(box_of_face(faces, f), int64_t(faces.weld_steps()))); };
  std::fill(faces.is_unsettled.begin(), faces.is_unsettled.end(), uint8_t(0));
  std::array<std::optional<BoxQ8>, 2> around;
  for (size_t f = 0; f < faces.face.size(); ++f) {
    std::optional<BoxQ8>& of = around[is_of_first(faces, f, first_of_second) ? 0 : 1];
    of = of ? joined(*of, box(f)) : box(f);
  }
  if (!around[0] || !around[1] || !boxes_meet(*around[0], *around[1])) return false;
  std::vector<uint32_t> of_first;
  for (uint32_t f = 0; f < faces.face.size(); ++f)
    if (is_of_first(faces, f, first_of_second) && boxes_meet(box(f), *around[1])) of_first.push_back(f);
  const BoxTree tree(of_first.size(), [&](uint32_t i) { return box(of_first[i]); });
  bool is_any = false;
  for (size_t f = 0; f < faces.face.size(); ++f) {
    if (is_of_first(faces, f, first_of_second) || !boxes_meet(box(f), *around[0])) continue;
    tree.for_all_meeting(box(f), [&](uint32_t i) {
      faces.is_unsettled[f] = faces.is_unsettled[of_first[i]] = 1;
      return true;
    });
    is_any |= faces.is_unsettled[f] != 0;
  }
  return is_any;
}

/// Faces that are settled though they meet outside of what they share are unsettled then.
void unsettle_crossing(LatticeFaces& faces, const std::vector<uint8_t>& is_checked, const Context& context) {
  LatticeFaces settled;
  for (uint32_t f = 0; f < faces.face.size(); ++f) {
    if (faces.is_unsettled[f]) continue;
    settled.face.push_back(faces.face[f]);
    settled.source.push_back(f);
    settled.is_unsettled.push_back(is_checked.empty() || !is_checked[faces.source[f]]);
  }
  settled.point = faces.point;
  unsettle_crossing(settled, context);
  for (size_t i = 0; i < settled.face.size(); ++i) faces.is_unsettled[settled.source[i]] = settled.is_unsettled[i];
}

StepPoint place_of(const LatticeFaces& faces, const std::array<uint32_t, 2>& pair) {
  return largest_of(box_of_face(faces, pair[0]).min, box_of_face(faces, pair[1]).min);
}

ArrangedFaces result_of(LatticeFaces faces, const TriangleSoup& soup, const WeldedVertices& welded,
                        const WorldBox& box) {
  const StepFrame frame(box);
  ArrangedFaces result;
  result.box = box;
  std::vector<uint32_t> number(faces.point.size(), kNoFace);
  for (const Corners& c : faces.face)
    for (const uint32_t v : c) number[v] = 0;
  for (size_t v = 0; v < number.size(); ++v) {
    if (number[v] == kNoFace) continue;
    number[v] = uint32_t(result.point.size());
    result.point.push_back(v < welded.position.size() ? welded.position[v] : frame.to_world(faces.point[v]));
  }
  result.is_cut.assign(soup.triangles.size(), 0);
  for (size_t f = 0; f < faces.face.size(); ++f) {
    const auto& corner = soup.triangles[faces.source[f]];
    bool is_same = true;
    for (size_t i = 0; i < 3; ++i) is_same = is_same && faces.face[f][i] == welded.place[corner[i]];
    if (!is_same) result.is_cut[faces.source[f]] = 1;
  }
  for (Corners& c : faces.face)
    for (uint32_t& v : c) v = number[v];
  result.face = std::move(faces.face);
  result.source = std::move(faces.source);
  return result;
}

/// None, and a place where faces cross, when rounds do not come to an end, or take more work than they may.
std::optional<LatticeFaces> cut_all(LatticeFaces faces, int64_t& work_left, StepPoint& failed_at,
                                    const Context& context) {
  std::array<size_t, 2> contacts_before{};  // of the last round and the one before that, while what is near is cut
  for (int round = 0; round < kMostRounds; ++round) {
    if (round == kNearEdgeRounds) faces.leaves_near_edges = true;
    if (round == kFullRounds && !faces.leaves_near) {
      faces.reach_steps = kLateReachSteps;
      faces.leaves_near = true;
    }
    Contacts contacts = find_contacts(faces, work_left, context);
    if (!contacts.found.empty()) failed_at = faces.point[faces.face[contacts.found.front().pair[0]][0]];
    work_left -= contacts.work();
    if (work_left < 0) return {};
    if (!faces.leaves_near) {
      const size_t count = contacts.found.size() + contacts.close.size();
      size_t& before = contacts_before[size_t(round % 2)];
      if (round >= kFirstRounds && count > std::max(before, kFewContacts)) return {};
      before = count;
    } else if (round > 0) {
      faces.reach_steps = std::min(kReachSteps, kReachGrowth * faces.reach_steps);
    }
    if (!contacts.close.empty()) {
      weld_close(faces, contacts);
    } else if (!contacts.found.empty()) {
      cut_at_contacts(faces, std::move(contacts), context);
    } else if (!contacts.crossing.empty()) {
      unsettle_named(faces, contacts);
      failed_at = place_of(faces, contacts.crossing.front());
    } else {
      return faces;
    }
  }
  return {};
}

std::optional<ArrangedFaces> arrange(const TriangleSoup& soup, WorldPoint& failed_at, const Context& context,
                                     const ArrangedGroups& groups) {
  const WeldedVertices welded = weld_vertices(soup.vertices, soup.triangles);
  const WorldBox box = groups.box ? *groups.box : box_of(welded.position);
  const StepFrame frame(box);
  LatticeFaces whole = snapped(soup, welded, frame);
  whole.reach_steps = std::clamp(frame.steps(groups.near_world), kReachSteps, kMostReachSteps);
  if (groups.first_of_second > 0 && !unsettle_near(whole, groups.first_of_second)) {
    ArrangedFaces apart = result_of(std::move(whole), soup, welded, box);
    apart.is_near = false;
    return apart;
  }
  unsettle_crossing(whole, groups.is_checked, context);
  int64_t work_left = kLeastWork + kWorkOfTriangle * int64_t(soup.triangles.size());
  std::vector<double> reaches = {kReachSteps, kLateReachSteps};
  if (whole.reach_steps > kReachSteps) reaches.insert(reaches.begin(), whole.reach_steps);
  for (const double reach_steps : reaches) {
    LatticeFaces faces = whole;
    faces.reach_steps = reach_steps;
    faces.leaves_near = reach_steps == kLateReachSteps;
    const int64_t for_others = faces.leaves_near ? 0 : work_left / 2;
    int64_t left = work_left - for_others;
    StepPoint at{0, 0, 0};
    std::optional<LatticeFaces> cut = cut_all(std::move(faces), left, at, context);
    if (cut) {
      ArrangedFaces result = result_of(std::move(*cut), soup, welded, box);
      result.is_as_wanted = reach_steps == whole.reach_steps;
      return result;
    }
    work_left = for_others + std::max<int64_t>(0, left);
    if (reach_steps == whole.reach_steps) failed_at = frame.to_world(at);
  }
  return {};
}

}  // namespace

std::optional<ArrangedFaces> arrange_faces(const TriangleSoup& soup, WorldPoint& failed_at, const Context& context,
                                           const ArrangedGroups& groups) {
  return run_with_threads(context, [&] { return arrange(soup, failed_at, context, groups); });
}

}  // namespace isoshell::repair
