// Edge lengths that a run asks for on the walls of regions.
#pragma once

#include <cstddef>
#include <vector>

#include "features/seeds/requested_lengths.h"
#include "isoshell/surface_source.h"
#include "pipeline/grid/plan.h"

namespace isoshell {

/// Per face the length that the options ask for on the walls of its regions, the shorter one of two, and 0 where they
/// ask for none; empty where they ask for none anywhere. Throws: usage for a region that no face has, or that has two
/// lengths.
std::vector<double> lengths_of_faces_world(const FaceRegions& regions, const std::vector<RegionEdgeLength>& lengths);

/// The lengths that a run aims at on walls, before they are bounded and smoothed. Keeps references to all.
class LengthsOnWalls {
 public:
  LengthsOnWalls(const TriangleSoup& walls, const Plan& plan, const std::vector<double>& of_face_world);

  double vertices() const { return vertices_; }  ///< that have these lengths
  double least_world() const { return scale_ * least_world_; }
  double on_triangle_world(size_t triangle) const { return scale_ * asked_world(triangle); }

 private:
  double asked_world(size_t triangle) const;

  const TriangleSoup& walls_;
  const std::vector<double>& of_face_world_;
  std::vector<double> field_world_;  ///< per vertex; empty: there is none
  double usual_world_, least_world_, vertices_ = 0, scale_ = 1;
};

/// The lattice of a run on walls. The corners of those of voxels are on 1/256 of a voxel, and those are points of it
/// where the run chooses it, steps between voxels are whole multiples of the shortest one, and that is not far finer
/// than edges need; elsewhere it is some times as fine as edges need, and they are near to points of it. What does not
/// intersect before must not on it.
LatticeFrame frame_of_walls(const TriangleSoup& walls, const Plan& plan, const std::vector<double>& of_face_world);

/// What is said where the lengths of faces, or the usual one, are shorter than the grid carries, or longer than others
/// by more than lengths may be; nothing otherwise.
std::vector<std::string> warnings_of_bounds(const RequestedLengths& requested);

}  // namespace isoshell
