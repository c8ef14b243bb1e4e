// How changes come into a mesh of patches (see patch_mesh.h).
#include <algorithm>

#include "features/angles/patch_mesh.h"

namespace isoshell {

/// Says that triangles are about to be replaced, or have replaced others.
void PatchMesh::note(const std::vector<uint32_t>& triangles) {
  for (const uint32_t t : triangles)
    for (const uint32_t v : this->triangles()[t].corner)
      if (v < replaced_at_.size()) replaced_at_[v] = clock_;
}

/// Whether that was done: what has changed of the region meets nothing.
bool PatchMesh::put_back(const Cutout& cutout, const MeshRegion& region) {
  std::vector<uint32_t> number;
  for (const RegionVertex& v : region.vertices()) {
    const bool is_new = v.number == kNone;
    number.push_back(is_new ? uint32_t(vertices().size()) : v.number);
    if (is_new)
      add_vertex(v);
    else
      place(v.number, v);
  }
  MeshChange change;
  for (size_t i = 0; i < region.triangles().size(); ++i) {
    if (!region.has_changed(i)) continue;
    const uint32_t t = i < cutout.triangles.size() ? cutout.triangles[i] : kNone;
    if (t != kNone) change.replaced.push_back(t);
    RegionTriangle made = region.triangles()[i];
    if (made.is_gone()) continue;
    for (uint32_t& v : made.corner) v = number[v];
    change.made.push_back(made);
    change.number.push_back(t);
  }
  note(change.replaced);
  if (!commit(change)) {
    for (const RegionVertex& v : cutout.region.vertices()) place(v.number, v);
    for (const RegionVertex& v : region.vertices())
      if (v.number == kNone) drop_last_vertex();
    return false;
  }
  note(change.number);
  is_hopeless_.resize(triangles().size(), 0);
  for (const uint32_t t : change.number) is_hopeless_[t] = 0;
  return true;
}

}  // namespace isoshell
