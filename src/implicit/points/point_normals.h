// Normals of points: found from neighbours where the file has none, and turned to agree.
#pragma once

#include <vector>

#include "implicit/points/point_tree.h"

namespace isoshell {

/// The points with what belongs to each of them.
struct OrientedPoints {
  std::vector<WorldPoint> position, normal;  ///< normals of length 1, outward; 0 where there is none
  std::vector<double> area;                  ///< of the surface that a point stands for
  double spacing = 0;                        ///< median distance of neighbours
  bool as_given = false;                     ///< normals are the file's own, with their sides
  bool turned = false;                       ///< normals disagreed and were turned along a spanning tree
  bool ignored = false;                      ///< given normals had nothing to do with the points; found anew
};

/// `normal` is empty or has one a position. Positions are different from one another.
OrientedPoints orient_points(std::vector<WorldPoint> position, std::vector<WorldPoint> normal, const PointTree& tree);

}  // namespace isoshell
