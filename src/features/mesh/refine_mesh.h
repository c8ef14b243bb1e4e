// A mesh with short edges, and with vertices where its curves get seeds.
#pragma once

#include <cmath>

#include "features/mesh/curve_paths.h"
#include "isoshell/advanced/lattice.h"
#include "isoshell/backend.h"

namespace isoshell {

/// Edges that one of the result is as long as, at least; walls of voxels are finer than edges anyway.
constexpr double kPartsOfEdge = 3, kPartsOfRoughEdge = 2;

/// Triangles and paths on lattice positions that are not rounded yet, in 1/256 voxel.
struct FineMesh {
  std::vector<WorldPoint> position;
  std::vector<double> edge_length;  ///< per vertex that of the result to aim at there
  MeshTriangles triangles;
  std::vector<uint32_t> source_face;  ///< per triangle, as in FeatureMesh; empty: not known
  std::vector<CurvePath> paths;
  double parts_of_edge = kPartsOfEdge;
};

/// To the nearest whole steps.
inline PointQ8 rounded(const WorldPoint& p) {
  const auto nearest = [](double steps) { return int32_t(std::floor(steps + 0.5)); };
  return {nearest(p.x), nearest(p.y), nearest(p.z)};
}

/// Cuts every edge into equal parts of at most a third of the edge length there, or as mesh.parts_of_edge says, the
/// mean of that at its ends; that of a path at its seeds first, and into parts of at most three quarters of that. Then
/// fills each triangle between the parts of its edges. Result: edges are at most half again as long as these parts;
/// seeds of paths are at vertices. What becomes of a triangle depends on its corners only. Cost: a sort of the edges,
/// then O(fine triangles); of a long thin triangle these are as many as its edges have parts. Throws: usage when that
/// is far more than the area needs, or than the memory limit allows. `only`: keys of the edges off paths that are
/// cut, ascending; null: all.
FineMesh refine_mesh(FineMesh mesh, Context& context, const std::vector<uint64_t>* only = nullptr);

}  // namespace isoshell
