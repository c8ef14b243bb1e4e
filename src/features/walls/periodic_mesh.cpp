// PeriodicMesh, and what is done with it (see periodic_mesh.h and periodic_sides.h).
#include "features/walls/periodic_mesh.h"

#include "features/walls/periodic_sides.h"

namespace isoshell {

PeriodicMesh::PeriodicMesh(const CutLookup& lookup, EditableMesh mesh)
    : EditableMesh(std::move(mesh)), lookup_(lookup), cut_(lookup.cut()), sides_(cut_) {
  for (int side = 1; side <= 6; ++side) places_.emplace_back(cut_, sides_, side);
  keep_apart(cut_.longest_edge_q8);
}

bool PeriodicMesh::is_on_side(uint32_t v, int side) const {
  return find_around(v, [&](const RegionTriangle& t) { return t.has(v) && sides_.of_patch(t.patch) == side; }) != kNone;
}

bool PeriodicMesh::is_end(uint32_t curve, size_t at) const {
  return !cut_.curves[curve].is_loop && (at == 0 || at + 1 == cut_.curves[curve].place.size());
}

bool PeriodicMesh::is_beside(uint32_t curve, int side) const {
  const std::vector<uint32_t>& beside = cut_.curves[curve].patches;
  return std::any_of(beside.begin(), beside.end(), [&](uint32_t p) { return sides_.of_patch(p) == side; });
}

bool PeriodicMesh::is_alive(uint32_t curve) const {
  const std::vector<uint32_t>& beside = cut_.curves[curve].patches;
  return !std::all_of(beside.begin(), beside.end(), [&](uint32_t p) { return sides_.is_high(p); });
}

void PeriodicMesh::list_vertices() {
  on_curve_.assign(cut_.curves.size(), {});
  at_corner_.clear();
  for (uint32_t v = 0; v < vertices().size(); ++v) {
    if (!is_used(v)) continue;
    if (vertex(v).kind == RegionVertex::Kind::on_curve) on_curve_[vertex(v).curve].push_back({vertex(v).at, v, at(v)});
    if (vertex(v).kind == RegionVertex::Kind::corner) at_corner_[cut_.place[vertex(v).home]] = v;
  }
  for (std::vector<OnCurve>& list : on_curve_) std::sort(list.begin(), list.end());
}

uint32_t PeriodicMesh::corner_at(uint32_t place) const {
  const auto found = at_corner_.find(place);
  return found != at_corner_.end() ? found->second : kNone;
}

void PeriodicMesh::note_put_in(uint32_t curve, const OnCurve& v) {
  std::vector<OnCurve>& list = on_curve_[curve];
  list.insert(std::lower_bound(list.begin(), list.end(), v), v);
}

void PeriodicMesh::note_taken_away(uint32_t curve, uint32_t v) {
  std::vector<OnCurve>& list = on_curve_[curve];
  list.erase(std::find_if(list.begin(), list.end(), [&](const OnCurve& on) { return on.vertex == v; }));
}

bool has_periodic_sides(const CutSurface& cut) { return cut.regions && cut.regions->is_periodic(); }

EditableMesh with_same_sides(const CutLookup& lookup, EditableMesh mesh) {
  return with_copied_sides(with_matched_curves(PeriodicMesh(lookup, std::move(mesh))));
}

}  // namespace isoshell
