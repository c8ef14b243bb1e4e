// Curves of a surface that cannot be cut along them itself are laid onto its sheet.
#pragma once

#include "features/mesh/embed_lines.h"
#include "isoshell/advanced/sheet.h"

namespace isoshell {

/// A piece of a curve of the network, and the edges that it was laid onto.
struct LaidPiece {
  uint32_t curve;
  double length_world;
  EdgeList edges;
};

struct LaidCurves {
  FeatureMesh mesh;  ///< the sheet, cut into more triangles; vertices of curves are where the curves are
  std::vector<WorldPoint> on_sheet;  ///< per vertex its place on the sheet
  std::vector<uint8_t> is_back;      ///< per vertex whether it was taken back there
  EdgeList creases, seams, lines;    ///< edges of the mesh, ascending
  std::vector<LaidPiece> pieces;

  /// Of so many curves of the network what was laid, and whose vertices are where the curve is.
  std::vector<double> lengths_world(size_t curves) const;
  /// Moves a vertex to its place on the sheet. Result: whether it was elsewhere.
  bool take_back(uint32_t vertex);
  /// The same of the vertices of triangles that are turned over, until none is: near walls, in crevices.
  void take_back_turned();
};

/// Lays the creases, seams and lines of a mesh onto the sheet that was made of it, in host memory. What is farther from
/// the sheet than its triangles are wide is left out: there the sheet closes a gap, or goes around what is inside.
/// Edges of more than two triangles become creases where the sheet turns: what stands there is inside, or no wall.
/// Borders are no part of a closed surface. Where triangles would turn over, vertices stay on the sheet. Cost: a search
/// of the nearest triangle every two voxels of curve, and O(sheet).
LaidCurves lay_curves(const FeatureMesh& mesh, const CurveNetwork& network, const Sheet& sheet);

}  // namespace isoshell
