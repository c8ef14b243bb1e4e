// Signed distances from the sides that points of a sharp body lie on.
#pragma once

#include "implicit/points/indicator_grid.h"

namespace isoshell {

/// A function of points that is about 1 inside, 0 outside, and its value at the surface.
struct Indicator {
  const GridShape& shape;
  const std::vector<float>& value;
  double level;
};

/// Distances in voxels, below 0 inside, at the lattice points of the indicator's grid: within three voxels of a point
/// those from the sides near it, else a value with the indicator's sign, and zeros where it has its level.
///
/// Points near a lattice point whose normals agree are a side, whose distance is the mean of theirs: half of what their
/// own planes say and half of what the mean plane does, which is right where a side is round. Of two sides that meet in
/// a convex crease the farther one decides, of two in a hollow crease the nearer one; the distance is that from the
/// nearest place of a plane, a crease or a corner of all sides that lies on the surface, as in a level set.
/// `points` have the normals of their sides (see flat_normals.h). Cost: 4 bytes a voxel of the blocks near the surface.
class PointDistances : public ScalarField {
 public:
  PointDistances(const OrientedPoints& points, const Indicator& indicator);
  std::vector<Voxel> blocks() const override { return blocks_; }
  std::vector<FieldTile> tiles() const override { return tiles_; }
  void copy(Voxel origin, const int size[3], float* to) const override;

 private:
  std::vector<Voxel> blocks_;  // sorted
  std::vector<FieldTile> tiles_;
  std::vector<std::vector<float>> value_;  // per block
};

}  // namespace isoshell
