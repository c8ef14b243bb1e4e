// Curves of a surface that cannot be cut along them itself are laid onto its sheet.
#pragma once

#include "features/embed_lines.h"
#include "isoshell/sheet.h"

namespace isoshell {

struct LaidCurves {
  FeatureMesh mesh;                ///< the sheet, cut into more triangles; vertices of curves are where the curves are
  EdgeList creases, seams, lines;  ///< its edges, ascending
  std::vector<double> length_world;  ///< per curve of the network, of what was laid
};

/// Lays the creases, seams and lines of a mesh onto the sheet that was made of it, in host memory. What is farther from
/// the sheet than its triangles are wide is left out: there the sheet closes a gap, or goes around what is inside.
/// Borders and edges of more than two triangles are no part of a closed surface. Cost: a search of the nearest triangle
/// every two voxels of curve, and O(sheet).
LaidCurves lay_curves(const FeatureMesh& mesh, const CurveNetwork& network, const Sheet& sheet);

}  // namespace isoshell
