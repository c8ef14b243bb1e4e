// with_copied_sides (see periodic_mesh.h).
#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <tuple>

#include "features/walls/periodic_mesh.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

using Kind = RegionVertex::Kind;
using Position = std::tuple<double, double, double>;

Position key(const WorldPoint& p) { return {p.x, p.y, p.z}; }

class SideCopier : public PeriodicMesh {
 public:
  explicit SideCopier(PeriodicMesh mesh) : PeriodicMesh(std::move(mesh)) {}

  void copy_all() {
    for (int axis = 0; axis < 3; ++axis)
      if (sides().has(2 * axis + 1)) copy(axis);
    for (const RegionTriangle& t : triangles())
      if (!t.is_gone() && sides().of_patch(t.patch) > 0)
        for (const uint32_t v : t.corner) fix(v);
  }

 private:
  [[noreturn]] void refuse(const WorldPoint& q8) const {
    const WorldPoint p = cut_.frame.to_world(rounded_down(q8));
    std::ostringstream text;
    text << "--periodic: a vertex at " << p.x << ", " << p.y << ", " << p.z
         << " has none on the opposite side, where triangles would intersect; ask for another number of vertices";
    throw NoRoom("regions", text.str());
  }

  /// Gives the high side of an axis the triangles of the low one.
  void copy(int axis) {
    const int low = 2 * axis + 1;
    const WorldPoint period = sides().period_q8(axis);
    list_vertices();
    std::map<Position, uint32_t> at_position;
    for (uint32_t v = 0; v < vertices().size(); ++v)
      if (is_used(v) && vertex(v).kind != Kind::free) at_position.emplace(key(at(v)), v);
    std::vector<uint32_t> copies;
    for (uint32_t t = 0; t < triangles().size(); ++t)
      if (!triangles()[t].is_gone() && sides().of_patch(triangles()[t].patch) == low) copies.push_back(t);
    std::map<uint32_t, uint32_t> copy_of;  // vertices
    for (const uint32_t t : copies)
      for (const uint32_t v : triangles()[t].corner)
        if (vertex(v).kind != Kind::free && copy_of.count(v) == 0)
          copy_of[v] = vertex_opposite(v, low + 1, at_position);
    const std::map<uint32_t, uint32_t> patches = patches_opposite(copies, copy_of, low + 1);
    for (const uint32_t t : copies) {
      const RegionTriangle& from = triangles()[t];
      const auto patch = patches.find(from.patch);
      if (patch == patches.end()) refuse(at(from.corner[0]));
      for (const uint32_t v : from.corner)
        if (copy_of.count(v) == 0) copy_of[v] = free_copy(v, patch->second, period);
    }
    refuse_without_copy(low + 1, copy_of);
    for (const uint32_t t : copies) add_copy(triangles()[t], patches.at(triangles()[t].patch), copy_of);
  }

  /// Where walls that end on the high side have vertices that the low one lacks.
  void refuse_without_copy(int high_side, const std::map<uint32_t, uint32_t>& copy_of) const {
    std::set<uint32_t> copies;
    for (const auto& [of, copy] : copy_of) copies.insert(copy);
    const auto require = [&](uint32_t v) {
      if (v != kNone && copies.count(v) == 0) refuse(at(v));
    };
    for (uint32_t c = 0; c < cut_.curves.size(); ++c) {
      if (!is_beside(c, high_side)) continue;
      for (const OnCurve& v : on_curve(c)) require(v.vertex);
      if (cut_.curves[c].is_loop) continue;
      require(corner_at(cut_.curves[c].place.front()));
      require(corner_at(cut_.curves[c].place.back()));
    }
  }

  uint32_t vertex_opposite(uint32_t v, int side, std::map<Position, uint32_t>& at_position) {
    const WorldPoint there = at(v) + sides().period_q8((side - 1) / 2);
    if (const auto found = at_position.find(key(there)); found != at_position.end()) return found->second;
    const std::optional<PlaceOnCurve> place = places(side).nearest(there);
    if (!place || is_alive(place->curve)) refuse(at(v));
    RegionVertex made = lookup_.on_curve_at(place->curve, place->at);
    made.position = there;
    add_vertex(made);
    at_position.emplace(key(there), uint32_t(vertices().size() - 1));
    return uint32_t(vertices().size() - 1);
  }

  /// The curve between two neighbours on the high side.
  uint32_t curve_opposite(uint32_t u, uint32_t v) const {
    if (const std::optional<uint32_t> there = curve_between(u, v)) return *there;
    if (vertex(u).kind == Kind::on_curve) return vertex(u).curve;
    if (vertex(v).kind == Kind::on_curve) return vertex(v).curve;
    const uint32_t a = cut_.place[vertex(u).home], b = cut_.place[vertex(v).home];
    for (uint32_t c = 0; c < cut_.curves.size(); ++c) {
      const CutCurve& curve = cut_.curves[c];
      if (curve.is_loop || is_alive(c)) continue;
      const uint32_t first = curve.place.front(), last = curve.place.back();
      if ((first == a && last == b) || (first == b && last == a)) return c;
    }
    return kNone;
  }

  /// Per patch of a low side the one opposite.
  std::map<uint32_t, uint32_t> patches_opposite(const std::vector<uint32_t>& copies,
                                                const std::map<uint32_t, uint32_t>& copy_of, int side) const {
    const std::vector<std::array<int32_t, 2>> labels = labels_of_patches(cut_);
    std::map<uint32_t, uint32_t> found;
    for (const uint32_t t : copies) {
      const RegionTriangle& of = triangles()[t];
      for (size_t i = 0; i < 3 && found.count(of.patch) == 0; ++i) {
        if (of.curve[i] == kNone) continue;
        const uint32_t curve = curve_opposite(copy_of.at(of.corner[i]), copy_of.at(of.corner[(i + 1) % 3]));
        if (curve == kNone) continue;
        for (const uint32_t patch : cut_.curves[curve].patches)
          if (sides().of_patch(patch) == side && labels[patch] == labels[of.patch]) found.emplace(of.patch, patch);
      }
    }
    return found;
  }

  uint32_t free_copy(uint32_t v, uint32_t patch, const WorldPoint& period) {
    RegionVertex made = vertex(v);
    made.position = at(v) + period;
    made.home = lookup_.nearest_from(home_in(patch), made.position);
    made.is_settled = true;
    add_vertex(made);
    return uint32_t(vertices().size() - 1);
  }
  /// A vertex of the surface in a patch.
  uint32_t home_in(uint32_t patch) const {
    const Buffer<uint32_t>& of = cut_.surface.patch;
    return uint32_t(std::lower_bound(of.begin(), of.end(), patch) - of.begin());
  }

  void add_copy(const RegionTriangle& of, uint32_t patch, const std::map<uint32_t, uint32_t>& copy_of) {
    RegionTriangle made;
    made.patch = patch;
    for (size_t i = 0; i < 3; ++i) {  // the other way around
      made.corner[i] = copy_of.at(of.corner[(3 - i) % 3]);
      const size_t edge = 2 - i;  // from corner i of the copy to the next one
      made.curve[i] = kNone;
      if (of.curve[edge] != kNone)
        made.curve[i] = curve_opposite(copy_of.at(of.corner[edge]), copy_of.at(of.corner[(edge + 1) % 3]));
    }
    add(made);
  }
};

}  // namespace

EditableMesh with_copied_sides(PeriodicMesh mesh) {
  SideCopier copier(std::move(mesh));
  copier.copy_all();
  return std::move(static_cast<EditableMesh&>(copier));
}

}  // namespace isoshell
