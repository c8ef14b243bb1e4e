// The surface of a clean input: its own triangles on the lattice, refined, and cut open along its curves.
#pragma once

#include <array>
#include <memory>

#include "features/mesh/feature_mesh.h"
#include "features/seeds/requested_lengths.h"
#include "isoshell/advanced/lattice.h"
#include "isoshell/advanced/surface_mesh.h"
#include "isoshell/backend.h"
#include "isoshell/regions.h"
#include "isoshell/remesh.h"

namespace isoshell {

/// A curve between two corners, or a loop, in fine points. A curve of the network at whose inner vertices the border
/// turns back is several of these.
struct CutCurve {
  uint32_t curve = 0;  ///< of the network
  CurveKind kind = CurveKind::crease;
  bool is_loop = false;         ///< the last place is beside the first, which is not repeated
  std::vector<uint32_t> place;  ///< along it; an open one begins and ends with corners, which may be the same one
  std::vector<double> at_q8;    ///< per place the arclength from the first one
  double length_q8 = 0;
  int64_t least_segments = 1;     ///< that keep edges of the result apart
  std::vector<size_t> seeds;      ///< ascending: which of the places are seeds; both ends of an open curve are
  std::vector<uint32_t> patches;  ///< beside it, ascending
};

struct CutSource;
struct FineMesh;

/// A surface cut open along curves. A place is a point of a curve, of which every fan of triangles around it has a
/// copy: a border vertex of its own. First come the corners, then what is inside of the curves, by curve, then along
/// it.
struct CutSurface {
  SurfaceMesh surface;  ///< cut into patches, with triangles that may have no area: they were thinner than a step
  LatticeFrame frame;
  double longest_edge_q8 = 0;                            ///< aimed at
  bool is_requested = false;                             ///< lengths vary as was asked for
  std::shared_ptr<const FaceRegions> regions = nullptr;  ///< that patches part, by fine->source_face: every curve stays
  std::vector<CutCurve> curves;
  int64_t corner_count = 0;
  std::vector<uint32_t> place;              ///< per vertex of the surface; kNone off borders
  std::vector<int64_t> copies_first;        ///< per place, and one more: offsets into copies
  std::vector<uint32_t> copies;             ///< border vertices, ascending per place
  std::shared_ptr<const FineMesh> fine;     ///< what it was cut from: curve c is its path c
  std::vector<uint32_t> corner;             ///< per corner of a triangle of that its vertex
  int64_t seeds = 0;                        ///< that it is cut for, copies at a place counted once; 0: any number
  std::shared_ptr<const CutSource> source;  ///< of who cuts it
};

inline size_t patch_count(const CutSurface& cut) {
  return size_t(cut.surface.patch[cut.surface.vertex_count() - 1]) + 1;  // vertices are in order of their patches
}

/// Per patch the regions that it parts: the one behind it, and the one in front. Only where there are some.
std::vector<std::array<int32_t, 2>> labels_of_patches(const CutSurface& cut);

struct CutOptions {
  double edge_length_world = 0;         ///< aimed at, everywhere the same
  int64_t vertices = 0;                 ///< above 0: lengths vary, and so many vertices have them (see edge_lengths.h)
  RequestedLengths requested = {};      ///< in proportion to these, or with 0 vertices these
  bool is_rough = false;                ///< turns, of curves too, are no bends: it is made of voxels
  WorldPoint period_world{0, 0, 0};     ///< along axes on which a volume goes on with its other side; 0 along others
  std::vector<WorldPoint> before = {};  ///< vertices of another mesh, which stay seeds of curves where they lie on one
};

/// Snaps a mesh to the lattice, with edges cut into thirds of the edge length aimed at and a vertex wherever a seed
/// of a curve belongs, and cuts it along every edge of the network: each component of triangles is a patch. Vertices
/// are snapped last, and what falls together then keeps its triangles, without area: so a patch stays the manifold that
/// it is in the input. Result: independent of the order of triangles. Cost: sorts of the fine edges. Throws: usage
/// where the network lacks a border or non-manifold edge, or triangles are too long and thin.
CutSurface cut_surface(const FeatureMesh& mesh, const CurveNetwork& network, const LatticeFrame& frame,
                       const CutOptions& options, Context& context);

/// The edge length of a mesh with so many vertices, where it is the same everywhere (see vertices_of_lengths).
double edge_length_for(const FeatureMesh& mesh, const CurveNetwork& network, int64_t vertices);

}  // namespace isoshell
