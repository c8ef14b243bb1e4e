// Scalar fields from functions, for tests of the surfaces that are made of them.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include "implicit/volumes/scalar_field.h"
#include "isoshell/surface_source.h"

namespace isoshell {

/// A field of blocks given by a function, and of tiles.
class MadeField : public ScalarField {
 public:
  using Value = std::function<float(Voxel)>;
  MadeField(int32_t from, int32_t to, Value value, double outside) : value_(std::move(value)) {
    background = outside;
    for (int32_t x = from; x < to; x += 8)
      for (int32_t y = from; y < to; y += 8)
        for (int32_t z = from; z < to; z += 8) blocks_.push_back({x, y, z});
  }

  std::vector<Voxel> blocks() const override { return blocks_; }
  std::vector<FieldTile> tiles() const override { return made_tiles; }
  void copy(Voxel o, const int size[3], float* to) const override {
    const bool held = std::find(blocks_.begin(), blocks_.end(), o) != blocks_.end();
    float other = float(background);
    for (const FieldTile& t : made_tiles)
      if (o.x >= t.origin.x && o.y >= t.origin.y && o.z >= t.origin.z && o.x < t.origin.x + t.size &&
          o.y < t.origin.y + t.size && o.z < t.origin.z + t.size)
        other = t.value;
    copy_block(size, to, [&](int i) {
      return held ? value_({o.x + (i >> 6), o.y + (i >> 3 & 7), o.z + (i & 7)}) : other;
    });
  }

  std::vector<FieldTile> made_tiles;

 private:
  std::vector<Voxel> blocks_;
  Value value_;
};

/// Every directed edge has its opposite, once.
inline bool is_closed_2_manifold_by_edges(const TriangleSoup& soup) {
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (const auto& t : soup.triangles)
    for (int i = 0; i < 3; ++i) ++edges[{t[size_t(i)], t[size_t((i + 1) % 3)]}];
  return std::all_of(edges.begin(), edges.end(), [&](const auto& e) {
    const auto opposite = edges.find({e.first.second, e.first.first});
    return e.second == 1 && opposite != edges.end() && opposite->second == 1;
  });
}

}  // namespace isoshell
