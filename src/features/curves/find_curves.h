// Where a mesh is not smooth: its borders, non-manifold edges and creases, as curves between corners.
#pragma once

#include <vector>

#include "features/curves/edge_chains.h"

namespace isoshell {

struct PreviousFrame;

enum class CreaseMode : uint8_t {
  off,        ///< borders and non-manifold edges only
  automatic,  ///< edges that are sharp beside the surface next to them; none on scans
  threshold,  ///< every edge whose triangles turn by so many degrees or more
  given,      ///< those that are given
};

struct CurveOptions {
  CreaseMode mode = CreaseMode::automatic;
  double degrees = 40;           ///< of mode threshold, above 0 and at most 180
  double edge_length_world = 0;  ///< h, the edge length that the result aims at; above 0
  EdgeList seams = {};           ///< ends of edges that are curves, too; others are passed over
  EdgeList lines = {};           ///< likewise
  EdgeList interfaces = {};      ///< likewise, but only where any number of vertices may be on curves
  EdgeList creases = {};         ///< likewise; of mode given
  EdgeList smooth = {};          ///< ends of edges that are no creases, however sharp they are
  /// Of mode automatic: the frame before, where this one has other faces. What a simulation meshes anew has sharp edges
  /// here and there for a moment, so unless nearly all that looks like a crease is one, none come, and those that were
  /// there stay while they are the rule on the whole surface. Null where every crease may come.
  const PreviousFrame* before = nullptr;
  double most_vertices = 0;  ///< on all curves, at edges of that length, if leaving creases out can do that: the least
                             ///< go first, by turn times length; 0: any number
};

/// What was decided about creases.
struct CreaseReport {
  double candidate_length_world = 0;  ///< before anything was dropped
  double kept_length_world = 0;
  int64_t components_with_candidates = 0;
  int64_t components_without_creases = 0;  ///< of those, taken for a scan or an organic shape as a whole
};

/// The creases of a mesh, before seams and lines join them and small ones are dropped.
struct FoundCreases {
  MeshEdges edges;
  std::vector<CurveEdge> curve_edges;  ///< with borders and non-manifold edges, ascending
  CreaseReport report;                 ///< without the length that is kept
};

/// Of the options only the mode, the edge length and what the mode asks for matter. Throws: usage.
FoundCreases find_creases(const FeatureMesh& mesh, const CurveOptions& options);

/// Result: every border and non-manifold edge, the seams and lines, and the creases of the mode, less dangling and
/// looping ones shorter than 2 h. A seam or line at a crease is a crease, a line at a seam is a seam. Corners are
/// vertices with another number of curve edges than two or edges of two kinds, and those where a curve turns by more
/// than 45 degrees between chords of .7 h. An open curve runs from its smaller corner (from the smaller edge of two at
/// the same corner); a loop from its smallest vertex along the smaller edge. Throws: usage.
CurveNetwork find_curves(const FeatureMesh& mesh, const CurveOptions& options, CreaseReport* report = nullptr);
/// The same from the creases that were found with these options.
CurveNetwork find_curves(const FeatureMesh& mesh, const CurveOptions& options, const FoundCreases& found,
                         CreaseReport* report = nullptr);

}  // namespace isoshell
