// The boundary of one region, taken out of a mesh whose faces part several.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/index_sets.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// Throws: usage unless the mesh has regions, a pair of labels a face; for a triangle that names no vertex.
void require_regions(const TriangleMesh& mesh);

/// Of the regions that faces bound, ascending; sheets bound none.
std::vector<int32_t> region_labels(const TriangleMesh& mesh);

/// Empty: it has none.
std::string region_name(const FaceRegions& regions, int32_t label);

struct RegionSurface {
  std::vector<uint32_t> face;                      ///< of the whole mesh, ascending
  std::vector<uint8_t> is_turned;                  ///< per face, against the whole mesh
  std::vector<uint32_t> vertex;                    ///< of the whole mesh, ascending
  std::vector<std::array<uint32_t, 3>> triangles;  ///< outward, of `vertex`; each begins at the corner that it began at
};

/// Corner `i` of a triangle is that corner of the triangle that it was.
inline size_t corner_before_turn(size_t i, bool is_turned) { return is_turned ? (3 - i) % 3 : i; }

/// `faces`: all that bound the region, ascending.
RegionSurface surface_of_region(const TriangleMesh& mesh, int32_t label, std::vector<uint32_t> faces);

/// How the faces of such a surface hang together. Where the region touches itself along an edge, which then has four of
/// its faces or more, those with a piece of it between them do: it is as if the edge were there once for each piece.
struct RegionComplex {
  IndexSets fans;                                             ///< of corners 3 t + i, around their vertex through edges
  IndexSets parts;                                            ///< of faces, through edges
  int64_t edges = 0, open_edges = 0, inconsistent_edges = 0;  ///< as in RegionCounts

  bool closed() const { return edges > 0 && open_edges == 0 && inconsistent_edges == 0; }
};

/// `points`: of the whole mesh.
RegionComplex complex_of(const RegionSurface& surface, const std::vector<WorldPoint>& points);

}  // namespace isoshell
