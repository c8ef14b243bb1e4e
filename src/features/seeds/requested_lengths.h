// Edge lengths that a user asks for, on a fine mesh.
#pragma once

#include "features/mesh/vertex_graph.h"
#include "isoshell/advanced/lattice.h"
#include "isoshell/sizing.h"

namespace isoshell {

/// What is asked for beside a number of vertices. World units.
struct RequestedLengths {
  const SizingField* field = nullptr;
  std::vector<double> of_face_world = {};  ///< per face of the source what holds there before all else, 0: nothing does
  double usual_world = 0;                  ///< where the field says nothing
  double shortest_world = 0;               ///< none is shorter
  double adaptivity = 0;                   ///< part of the vertices that goes by curvature
  double growth = 0.2;                     ///< most that a length grows, over the way

  bool vary() const { return are_places() || adaptivity > 0; }
  bool are_places() const { return field || !of_face_world.empty(); }  ///< each has its length, whatever is there
};

/// Most that lengths differ by: what EdgeLengthsView::mass has room for.
constexpr double kMostLengthRatio = 16;
constexpr double kLeastDensity = 1.0 / 16;  ///< of vertices where nothing is curved, over the mean

/// Gives the vertices the lengths asked for: those of the field, on faces that have lengths the shortest around, by
/// curvature off the paths, and at most sixteen times the shortest; above 0 vertices in proportion, so that about so
/// many have them. `e`: the length the mesh was cut at.
void ask_for_lengths(FineMesh& mesh, const VertexGraph& graph, const LatticeFrame& frame,
                     const RequestedLengths& requested, int64_t vertices, double e);

}  // namespace isoshell
