// What can be counted and measured of the regions that the faces of a mesh part: the regions of a certificate, and each
// of them as a mesh of its own.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/surface_source.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// The boundary of a region: the faces that it lies behind, and turned around those that it is in front of.
struct RegionCounts {
  int32_t label = 0;
  std::string name;  ///< empty: it has none
  int64_t faces = 0, vertices = 0;
  int64_t components = 0;          ///< of its faces, connected through edges; hollows are some
  int64_t genus = -1;              ///< sum over the components; -1 unless closed
  int64_t open_edges = 0;          ///< with another number of its faces than two, but where it touches itself
  int64_t inconsistent_edges = 0;  ///< with two of its faces that pass it in the same direction
  int64_t touching_vertices = 0;   ///< fans of its faces around vertices, beyond the first one of each
  bool closed = false;      ///< every edge has two of its faces, which pass it in opposite directions, or pairs of
                            ///< such faces, each with a piece of the region between them
  double volume_world = 0;  ///< signed, about the middle of the bounding box
  double area_world = 0;

  bool is_inside_out() const { return closed && volume_world < 0; }
};

/// The faces between two regions, or one and the background; or of the sheets in one of them.
struct RegionWall {
  std::array<int32_t, 2> labels;  ///< the smaller one first; the same twice of sheets
  int64_t faces = 0;
  double area_world = 0;
};

/// What is known of the regions of a surface before it is meshed.
struct SurfaceRegions {
  std::vector<RegionWall> walls;                       ///< ascending
  std::map<int32_t, double> volume_world;              ///< by label; of what faces do not close it means nothing
  std::vector<std::array<int32_t, 2>> absorbed_walls;  ///< as in TriangleSoup
  std::vector<RegionName> names;                       ///< ascending by label
};

/// Nothing of a surface without regions. Result: the same for every number of threads. Cost: a sort of the faces.
SurfaceRegions regions_of_surface(const TriangleSoup& surface);

struct RegionCensus {
  int32_t background = 0;             ///< is no region
  std::vector<RegionCounts> regions;  ///< that faces bound, ascending; sheets bound none
  std::vector<RegionWall> walls;      ///< ascending
  int64_t curve_edges = 0;            ///< with three faces or more: regions meet there
  int64_t corners = 0;                ///< vertices of these where one of them ends, or more than two meet
  int64_t duplicate_faces = 0;        ///< with the corners of another one, in any order, beyond the first: walls that
                                      ///< regions do not share. By positions, so copies of vertices hide none
  int64_t coincident_vertices = 0;    ///< at the position of another one, beyond the first
  int64_t intersecting_pairs = 0;     ///< of triangles, as in MeshCensus
  int64_t inside_out_regions = 0;     ///< closed ones of negative volume
  bool every_region_closed = false;   ///< or all faces are of sheets

  /// Whether each region lies in a closed surface that it shares with those beside it, and no two faces meet but where
  /// they share corners.
  bool is_sound() const {
    return every_region_closed && duplicate_faces == 0 && inside_out_regions == 0 && intersecting_pairs == 0;
  }
};

/// `intersecting_pairs`: where they were counted already. Result: the same for every number of threads; sums run in the
/// order of faces. Cost: sorts of corners, edges and faces, region by region side by side; a search for intersections.
/// Throws: usage for a mesh without regions, labels that are not one pair a face, and a triangle that
/// names a vertex that is not there or not finite; interrupted.
RegionCensus take_region_census(const TriangleMesh& mesh, Context& context,
                                std::optional<int64_t> intersecting_pairs = {});

/// Of a region of the surface, and of the mesh.
struct RegionVolumes {
  static constexpr double kNotablePct = 2;  ///< what is more is told

  RegionName region;
  double before_world = 0, after_world = 0;

  double change_pct() const { return 100 * (after_world / before_world - 1); }
  bool has_changed() const { return std::abs(change_pct()) > kNotablePct; }
};

/// What of the regions of a surface a mesh of it has not, or has beyond. Names are empty where there is none.
struct RegionChanges {
  std::vector<RegionName> lost;                       ///< regions, ascending
  std::vector<std::array<RegionName, 2>> lost_walls;  ///< pairs that share none any more, ascending
  std::vector<std::array<RegionName, 2>> new_walls;   ///< pairs that shared none before
  /// Pairs of a volume of labels that touched in absorbed islands alone: no loss, as that is asked for.
  std::vector<std::array<RegionName, 2>> absorbed_walls;
  std::vector<RegionVolumes> volumes;  ///< of regions that the mesh closes and that had a volume before, ascending

  bool any() const { return !lost.empty() || !lost_walls.empty() || !new_walls.empty(); }
};

/// Of walls without area none counts. The background is called so.
RegionChanges find_region_changes(const SurfaceRegions& before, const RegionCensus& after);

/// A region by itself: its faces without its sheets, in their order, turned outward, and their vertices, in theirs.
/// Where it touches itself in a vertex or along an edge, each fan of faces has a vertex of its own, one behind the
/// other: the result is a closed 2-manifold where the region is closed. Positions are the same bytes. Attributes go
/// along, normals turned with their faces; patches, curves and regions do not. Cost: a look at all faces, a sort of the
/// region's corners and edges. Throws: usage as take_region_census does, but for positions that are not finite, and for
/// a label of no region that faces bound.
TriangleMesh region_of(const TriangleMesh& mesh, int32_t label);

}  // namespace isoshell
