// Seeds that are put into patches, each at a vertex of the surface.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "features/cutting/cut_piece.h"

namespace isoshell {

inline int64_t distance_sq(const PointQ8& a, const PointQ8& b) {
  const int64_t x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
  return x * x + y * y + z * z;
}

class AddedSeeds {
 public:
  AddedSeeds(const CutSurface& cut, const SeedSet& seeds) : cut_(cut), first_(seeds.size()) {}

  bool empty() const { return home_.empty(); }
  /// Number of the new seed, behind those that were there.
  uint32_t add(uint32_t vertex) {
    home_.push_back(vertex);
    position_.push_back(cut_.surface.position[vertex]);
    normal_.push_back(cut_.surface.normal[vertex]);
    return uint32_t(first_ + int64_t(home_.size()) - 1);
  }
  uint32_t home(uint32_t seed) const { return home_[size_t(int64_t(seed) - first_)]; }
  const PointQ8& position(uint32_t seed) const { return position_[size_t(int64_t(seed) - first_)]; }
  bool holds(uint32_t seed) const { return int64_t(seed) >= first_; }

  /// The mesh with these seeds and other triangles, in the order of the surface.
  void give_to(SeededMesh& made, const std::vector<TriangleIndices>& triangles) const {
    made.mesh.triangles = with_more<TriangleIndices>({}, triangles);
    made.mesh.position = with_more(made.mesh.position, position_);
    made.seeds.position = with_more(made.seeds.position, position_);
    made.seeds.normal = with_more(made.seeds.normal, normal_);
    made.seeds.home = with_more(made.seeds.home, home_);
    made = gather_patches(cut_, {{made, vertices_in(cut_, std::vector<char>(patch_count(cut_), 1))}});
  }

 private:
  template <class T>
  static Buffer<T> with_more(const Buffer<T>& old, const std::vector<T>& more) {
    Buffer<T> out(old.size() + int64_t(more.size()));
    std::copy(more.begin(), more.end(), std::copy(old.begin(), old.end(), out.begin()));
    return out;
  }

  const CutSurface& cut_;
  int64_t first_;
  std::vector<PointQ8> position_;
  std::vector<Normal8> normal_;
  std::vector<uint32_t> home_;  ///< vertices of the surface
};

}  // namespace isoshell
