// See insert_contacts.h.
#include "repair/arrangement/insert_contacts.h"

#include <algorithm>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "geometry/triangle_list.h"
#include "repair/arrangement/cut_face.h"
#include "repair/arrangement/new_points.h"
#include "repair/arrangement/shared_lines.h"

namespace isoshell::repair {
namespace {

constexpr double kMostJitterSteps = 8;  // which parts four points of a circle, and moves none over an edge

class Cutter {
 public:
  Cutter(LatticeFaces& faces, Contacts contacts, const Context& context)
      : faces_(faces), contacts_(std::move(contacts)), context_(context) {}

  void cut() {
    number_new_points(faces_, contacts_.found);
    spread_over_low_faces(faces_, contacts_.found);
    ContactPoints points(faces_, contacts_.found);
    const std::vector<FaceLine> lines = shared_lines(faces_, contacts_.found, points);
    const std::vector<uint32_t> touched = points.touched_faces();
    std::vector<std::vector<Corners>> pieces(touched.size());
    for_each_index(size_t(0), touched.size(), [&](size_t i) {
      check_cancel(context_, "regions");
      pieces[i] = cut_face(faces_.point, cut_of(touched[i], points, lines));
    });
    // What is not cut though it has a contact is looked at again.
    unsettle_named(faces_, contacts_);
    replace(touched, pieces);
  }

 private:
  FaceCut cut_of(uint32_t f, const ContactPoints& points, const std::vector<FaceLine>& lines) const {
    FaceCut cut;
    cut.corner = faces_.face[f];
    cut.jitter_steps = int(std::min(faces_.reach_steps / 16, kMostJitterSteps));
    for (size_t i = 0; i < 3; ++i) cut.border[i] = points.on_edge(cut.corner[i], cut.corner[(i + 1) % 3]);
    cut.inside = points.inside(f);
    auto line = std::lower_bound(lines.begin(), lines.end(), FaceLine{f, {0, 0}});
    for (; line != lines.end() && line->face == f; ++line) cut.lines.push_back(line->ends);
    return cut;
  }

  void replace(const std::vector<uint32_t>& touched, const std::vector<std::vector<Corners>>& pieces) {
    LatticeFaces next;
    next.point = std::move(faces_.point);
    next.reach_steps = faces_.reach_steps;
    next.leaves_near_edges = faces_.leaves_near_edges;
    next.leaves_near = faces_.leaves_near;
    next.face.reserve(faces_.face.size() + touched.size());
    next.source.reserve(faces_.face.size() + touched.size());
    size_t i = 0;
    for (uint32_t f = 0; f < faces_.face.size(); ++f) {
      if (i == touched.size() || touched[i] != f) {
        next.face.push_back(faces_.face[f]);
        next.source.push_back(faces_.source[f]);
        next.is_unsettled.push_back(faces_.is_unsettled[f]);
        continue;
      }
      next.face.insert(next.face.end(), pieces[i].begin(), pieces[i].end());
      next.source.resize(next.face.size(), faces_.source[f]);
      next.is_unsettled.resize(next.face.size(), 1);
      ++i;
    }
    faces_ = std::move(next);
  }

  LatticeFaces& faces_;
  Contacts contacts_;
  const Context& context_;
};

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

void cut_at_contacts(LatticeFaces& faces, Contacts contacts, const Context& context) {
  Cutter(faces, std::move(contacts), context).cut();
}

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
    if (repeats_corner(corner)) continue;
    faces.face[count] = corner;
    faces.source[count] = faces.source[f];
    faces.is_unsettled[count++] = faces.is_unsettled[f];
  }
  faces.face.resize(count);
  faces.source.resize(count);
  faces.is_unsettled.resize(count);
}

}  // namespace isoshell::repair
