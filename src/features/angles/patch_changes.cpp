// How changes come into a mesh of patches (see patch_mesh.h).
#include <algorithm>

#include "features/angles/patch_mesh.h"

namespace isoshell {

CornersOfTriangle PatchMesh::corners(const RegionTriangle& t) const {
  CornersOfTriangle out;
  for (size_t i = 0; i < 3; ++i) {
    const WorldPoint& p = vertices_[t.corner[i]].position;
    out.id[i] = t.corner[i];
    out.at[i] = {int32_t(p.x), int32_t(p.y), int32_t(p.z)};
  }
  return out;
}

void PatchMesh::fill_space() {
  if (space_) return;
  space_.emplace(cut_->longest_edge_q8, triangles_.size());
  for (uint32_t t = 0; t < triangles_.size(); ++t)
    if (!triangles_[t].is_gone()) space_->put(t, corners(triangles_[t]));
}

/// Whether what has changed of a region meets nothing.
bool PatchMesh::is_free(const Cutout& cutout, const MeshRegion& region) const {
  std::vector<CornersOfTriangle> made;
  std::vector<uint32_t> replaced;
  for (size_t i = 0; i < region.triangles().size(); ++i) {
    if (!region.has_changed(i)) continue;
    if (i < cutout.triangles.size()) replaced.push_back(cutout.triangles[i]);
    const RegionTriangle& t = region.triangles()[i];
    if (t.is_gone()) continue;
    CornersOfTriangle& corner = made.emplace_back();
    for (size_t k = 0; k < 3; ++k) {
      const RegionVertex& v = region.vertices()[t.corner[k]];
      corner.id[k] = v.number != RegionVertex::kNoOne ? v.number : uint32_t(vertices_.size() + t.corner[k]);
      corner.at[k] = {int32_t(v.position.x), int32_t(v.position.y), int32_t(v.position.z)};
    }
  }
  return space_->are_free(made, replaced);
}

/// A triangle without corners where there is none before, or is none any more.
void PatchMesh::replace(uint32_t triangle, const RegionTriangle& by) {
  RegionTriangle& t = triangles_[triangle];
  const auto note_change = [&] {
    for (const uint32_t v : t.corner)
      if (v < replaced_at_.size()) replaced_at_[v] = clock_;
  };
  if (!t.is_gone()) {
    for (const uint32_t v : t.corner)
      around_[v].erase(std::lower_bound(around_[v].begin(), around_[v].end(), triangle));
    note_change();
  }
  space_->take(triangle);
  t = by;
  if (t.is_gone()) return;
  for (const uint32_t v : t.corner)
    around_[v].insert(std::lower_bound(around_[v].begin(), around_[v].end(), triangle), triangle);
  space_->put(triangle, corners(t));
  note_change();
  is_hopeless_[triangle] = 0;
}

/// Whether that was done.
bool PatchMesh::put_back(const Cutout& cutout, const MeshRegion& region) {
  if (!is_free(cutout, region)) return false;
  std::vector<uint32_t> number;
  for (const RegionVertex& v : region.vertices()) {
    const bool is_new = v.number == RegionVertex::kNoOne;
    number.push_back(is_new ? uint32_t(vertices_.size()) : v.number);
    if (is_new) vertices_.emplace_back(), around_.emplace_back();
    vertices_[number.back()] = v;
  }
  for (size_t i = 0; i < region.triangles().size(); ++i) {
    if (i >= cutout.triangles.size()) triangles_.push_back({{}, {}, 0}), is_hopeless_.push_back(0);
    const uint32_t t = i < cutout.triangles.size() ? cutout.triangles[i] : uint32_t(triangles_.size() - 1);
    if (!region.has_changed(i)) continue;
    RegionTriangle made = region.triangles()[i];
    if (!made.is_gone())
      for (uint32_t& v : made.corner) v = number[v];
    replace(t, made);
  }
  count_ += int64_t(region.vertices().size()) - int64_t(cutout.region.vertices().size());
  count_ -= std::count_if(number.begin(), number.end(), [&](uint32_t v) { return around_[v].empty(); });
  return true;
}

}  // namespace isoshell
