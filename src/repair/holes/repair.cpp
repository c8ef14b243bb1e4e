#include "isoshell/repair.h"

#include <algorithm>

#include "core/index_sets.h"
#include "geometry/world_vector.h"
#include "repair/holes/missing_faces.h"
#include "repair/holes/open_soup.h"
#include "repair/holes/repair_holes.h"
#include "repair/holes/repair_patches.h"
#include "repair/holes/repair_tubes.h"

namespace isoshell {
namespace {

using namespace repair;

/// Patches that caps join, with the volume that they enclose.
class Bodies {
 public:
  Bodies(const RepairMesh& mesh, const Patches& patches, const std::vector<Cap>& caps)
      : mesh_(mesh), patches_(patches), sets_(patches.count), body_(patches.count) {
    for (const Cap& cap : caps)
      for (uint32_t h : cap.loop) sets_.unite(patches.of[cap.loop[0] / 3], patches.of[h / 3]);
    for (uint32_t f = 0; f < mesh.face_count(); ++f)
      if (mesh.is_live(f)) {
        Body& b = of_face(f);
        (mesh.is_turned(f) ? b.has_turned : b.has_others) = true;
        add(b, mesh.face[f]);
      }
    for (const Cap& cap : caps)
      for (const Corners& c : cap.face) add(of_face(cap.loop[0] / 3), c);
  }

  /// Faces of the body disagreed, and as they are now they look inward.
  bool is_inward(uint32_t f) {
    const Body& b = of_face(f);
    return b.has_turned && b.has_others && b.six_volume < 0;
  }

 private:
  struct Body {
    bool has_turned = false, has_others = false, has_origin = false;
    WorldPoint origin = {0, 0, 0};
    double six_volume = 0;
  };
  Body& of_face(uint32_t f) { return body_[sets_.root(patches_.of[f])]; }

  void add(Body& b, const Corners& c) {
    if (!b.has_origin) b.origin = mesh_.position[c[0]];
    b.has_origin = true;
    const WorldPoint p = mesh_.position[c[0]] - b.origin, q = mesh_.position[c[1]] - b.origin,
                     r = mesh_.position[c[2]] - b.origin;
    b.six_volume += dot(p, cross(q, r));
  }

  const RepairMesh& mesh_;
  const Patches& patches_;
  IndexSets sets_;
  std::vector<Body> body_;
};

void turn_outward(RepairMesh& mesh, const Patches& patches, std::vector<Cap>& caps) {
  Bodies bodies(mesh, patches, caps);
  for (Cap& cap : caps)
    if (bodies.is_inward(cap.loop[0] / 3))
      for (Corners& c : cap.face) std::swap(c[1], c[2]);
  for (uint32_t f = 0; f < mesh.face_count(); ++f)
    if (mesh.is_live(f) && bodies.is_inward(f)) mesh.turn(f);
}

Joins find_joins(const RepairMesh& mesh) {
  const std::vector<Loop> loops = closed_loops(mesh);
  Joins joins;
  joins.faces = find_missing_faces(mesh, loops);
  joins.tubes = find_tubes(mesh, loops_but(mesh, joins.faces, loops));
  return joins;
}

/// Pairs of faces whose patches joins make one.
std::vector<std::array<uint32_t, 2>> faces_that_join(const Joins& joins) {
  std::vector<std::array<uint32_t, 2>> faces;
  for (const std::vector<Cap>* caps : {&joins.faces, &joins.tubes})
    for (const Cap& cap : *caps)
      for (const uint32_t h : cap.loop) faces.push_back({cap.loop.front() / 3, h / 3});
  return faces;
}

/// Those whose surface was dropped as an island.
void forget_dropped(const RepairMesh& mesh, Joins& joins) {
  const auto is_dropped = [&](const Cap& cap) { return !mesh.is_live(cap.loop[0] / 3); };
  for (std::vector<Cap>* caps : {&joins.faces, &joins.tubes})
    caps->erase(std::remove_if(caps->begin(), caps->end(), is_dropped), caps->end());
}

/// The soup's own triangles in their order, then the caps.
TriangleSoup repaired_soup(const TriangleSoup& soup, const RepairMesh& mesh, const std::vector<Cap>& caps) {
  std::vector<uint32_t> face_of(soup.triangles.size(), kNoFace);
  for (uint32_t f = 0; f < mesh.face_count(); ++f)
    if (mesh.is_live(f)) face_of[mesh.source[f]] = f;
  TriangleSoup repaired;
  repaired.vertices = mesh.position;
  repaired.faces_in_file = soup.faces_in_file;
  repaired.dirt = soup.dirt;
  for (uint32_t f : face_of)
    if (f != kNoFace) repaired.triangles.push_back(mesh.face[f]);
  if (!caps.empty()) repaired.first_cap = uint32_t(repaired.triangles.size());
  for (const Cap& cap : caps) repaired.triangles.insert(repaired.triangles.end(), cap.face.begin(), cap.face.end());
  return repaired;
}

TriangleSoup repaired(const TriangleSoup& soup, const Closing& closing, bool may_drop_islands, RepairReport& report) {
  report = {};
  RepairMesh mesh(soup);
  report.joined_vertices = mesh.joined_vertices();
  report.repeated_faces = mesh.repeats();
  drop_fins(mesh, report);
  orient_patches(mesh);
  Joins joins;
  if (closing.holes) joins = find_joins(mesh);
  if (may_drop_islands) drop_islands(mesh, faces_that_join(joins), report);
  forget_dropped(mesh, joins);
  const Patches patches = find_patches(mesh);
  std::vector<Cap> caps = cap_holes(mesh, std::move(joins), closing, report);
  turn_outward(mesh, patches, caps);
  for (uint32_t f = 0; f < mesh.face_count(); ++f) report.turned_faces += mesh.is_live(f) && mesh.is_turned(f);
  return report.changed_anything() ? repaired_soup(soup, mesh, caps) : soup;
}

}  // namespace

TriangleSoup repair_soup(const TriangleSoup& soup, const RepairOptions& options, RepairReport& report) {
  return repaired(soup, {options.cap_loops, 0}, true, report);
}

TriangleSoup repair::repair_open_soup(const TriangleSoup& soup, double widest_gap_world, RepairReport& report) {
  return repaired(soup, {false, widest_gap_world}, false, report);
}

}  // namespace isoshell
