// The stages, each a function from products to the next product. Their order is the order of this file. What a stage
// changes it takes by moving, and returns; all else it leaves as it is. When it throws, what was moved into it is still
// valid, and nothing more can be said of it.
//
// What takes a SurfaceMesh takes one with borders too, unless it says that it needs a closed one: then it throws usage.
// Where a surface is cut into patches, a vertex is in the cell of the nearest seed of its own patch; where there are
// fixed seeds, a vertex on a border is in the cell that FixedSeeds says, and relaxation leaves them as they are.
#pragma once

#include <vector>

#include "isoshell/advanced/lattice_surface.h"
#include "isoshell/advanced/seed_set.h"
#include "isoshell/advanced/sheet.h"
#include "isoshell/advanced/shell.h"
#include "isoshell/advanced/site_set.h"
#include "isoshell/advanced/voronoi_labels.h"
#include "isoshell/backend.h"
#include "isoshell/surface_source.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

struct SoupTopology {
  InputTopology topology;
  DirtCounts dirt;  ///< what a reader counted, and what was found: degenerate and duplicate faces, edges
};
/// Welds and measures a soup. Faces with fewer than three distinct positions, and repeats in the same orientation, are
/// left out of the topology. Independent of any lattice and of the order of vertices and faces. Cost: sorts of the
/// vertices, faces and edges.
SoupTopology measure_topology(const TriangleSoup& soup, Context& context);

/// Smallest and largest coordinates of the vertices that triangles use. Throws: nothing_to_mesh without triangles.
WorldBox bounding_box(const TriangleSoup& soup);

/// Snaps the soup to the lattice (see LatticeSurface). Throws: nothing_to_mesh when no triangle is left.
LatticeSurface snap_surface(const TriangleSoup& soup, const LatticeFrame& frame, Context& context);

/// Triangles on the lattice to make a surface of. No triangle has a corner twice, or vertices of two patches.
struct SurfaceTriangles {
  std::vector<PointQ8> position;  ///< per vertex; every vertex has a triangle
  std::vector<TriangleIndices> triangles;
  std::vector<uint32_t> patch;  ///< per vertex; empty: one patch
  int32_t extent_vox[3] = {};   ///< positions are 0 to 256 times this
};
struct MadeSurface {
  SurfaceMesh surface;
  std::vector<uint32_t> number;  ///< per vertex as given the vertex that it became
};
/// A surface from triangles that do not come from a sheet. Result: vertices in the order of (patch, leaf key, x, y, z,
/// number as given), triangles from their smallest corner on, sorted; a block is what a patch has in a leaf, and
/// normals are sums of the triangles' area vectors. Triangles without area stay. In host memory. Cost: a sort of the
/// vertices, the triangles and the edges. Throws: usage where the triangles are no oriented manifold, or reach 28
/// voxels or more beyond a corner's leaf.
MadeSurface make_surface_mesh(const SurfaceTriangles& from, Context& context);

/// Voxelization(O, res) of the paper: sites of a snapped surface. Cost: proportional to the voxels tested; 64 B a leaf.
SiteSet voxelize(const LatticeSurface& surface, Context& context);

/// Which triangles each site sees, and its sample.
SiteSamples sample_sites(const LatticeSurface& surface, const SiteSet& sites, Context& context);

struct ShellOptions {
  int32_t band_vox = 2;  ///< d, 1 to kMaxBandVox
};
/// ShellSpaceConstruction(M, res, d) of the paper, section 3.1. Cost: O(leaves * d); 6 bytes an active voxel.
Shell build_shell(const SiteSet& sites, const ShellOptions& options, Context& context);

constexpr int64_t kNoGenus = -1;       ///< of an open surface: no handle is cut
constexpr int64_t kUnknownGenus = -2;  ///< of closed surfaces through each other: handles are cut but through material
struct SheetOptions {
  int32_t closing_vox = 0;             ///< r: gaps up to 2 r voxels are bridged; 0 to kMaxClosingVox
  int64_t min_component_area_q16 = 0;  ///< smaller sheet components are dropped; voxel^2 / 65536
  int64_t genus = kNoGenus;            ///< of a closed and oriented surface: more handles are cut
  bool move_in = true;                 ///< a coarse proxy goes to where the surface is on average
};
/// Closes the sites by r, floods from outside, repairs the solid until it is well-composed, and lays its boundary onto
/// the surface. Handles beyond `genus` are cut where their thinnest part lies farthest outside: the solid is grown anew
/// by simple points, from inside to outside, and what can not be added is left out. That needs closing_vox 0 and a box
/// around the sites of at most 2^29 voxels, 1.5 bytes each; in larger ones handles stay. Throws: nothing_to_mesh when
/// no component is left, out_of_memory when the box passes the CPU's limit.
Sheet build_sheet(const LatticeSurface& surface, const SiteSet& sites, const SiteSamples& samples,
                  const SheetOptions& options, Context& context);
/// The same where nothing reads the samples afterwards: they may be freed before the sheet takes most memory.
Sheet build_sheet(const LatticeSurface& surface, const SiteSet& sites, SiteSamples&& samples,
                  const SheetOptions& options, Context& context);

/// Sites of the lattice with voxels of twice the edge: those that hold a site. The same as voxelize on that lattice.
SiteSet coarsen_sites(const SiteSet& sites, Context& context);

/// The sheet of the sites alone, smoothed and, unless told not to, moved in to where the surface is on average, but not
/// laid onto it: within about a voxel. What coarse levels of seeds relax on, and what stands for an open surface whose
/// two sides would lie on each other.
Sheet build_proxy(const SiteSet& sites, const LatticeFrame& frame, const SheetOptions& options, Context& context);

/// Six times the volume inside a surface, in whole voxels, rounded down once. Needs a closed surface.
int64_t six_volume_vox(const SurfaceMesh& surface, Context& context);

constexpr int64_t kMostLengthSlopeQ16 = int64_t(1) << 24;

/// Edge lengths for a surface to aim at: the largest that are nowhere above `raw`, one a vertex in 1/256 voxel, and
/// grow by at most slope_q16 / 65536 of every edge's length. They are unique. Throws: usage.
EdgeLengths limit_edge_lengths(const SurfaceMesh& surface, Buffer<uint32_t> raw, int64_t slope_q16, Context& context);
/// After so many rounds in which every length becomes the mean of its own and its neighbours', rounded. Throws: usage.
EdgeLengths smooth_edge_lengths(const SurfaceMesh& surface, EdgeLengths&& lengths, int32_t rounds, Context& context);
/// Doubled area of the surface, that of each triangle over the square of its length, the least length being 1; q16.
int64_t seed_shares_q16(const SurfaceMesh& surface, Context& context);
/// Lengths for a coarse proxy from the surface it stands for, those of the nearest vertices. `halvings`: how many times
/// the edge of its voxels was doubled. Throws: usage for a surface without lengths.
EdgeLengths transfer_edge_lengths(const SurfaceMesh& from, int halvings, const SurfaceMesh& to, Context& context);
/// Per vertex how much normals turn a voxel, in 1/65536: the root of the mean square over its edges, of normals that
/// became the mean of their neighbours' in so many rounds, and smoothed in two thirds as many.
Buffer<uint32_t> measure_curvature(const SurfaceMesh& surface, int32_t rounds, Context& context);

struct SeedOptions {
  int64_t count = 0;  ///< k
  uint64_t seed = 0;  ///< start of the counter-based generator

  bool operator==(const SeedOptions& o) const { return count == o.count && seed == o.seed; }
};
/// k seeds spread over the surface, one at random in each of k strata of equal area along the order of its triangles.
/// Throws: usage when k is below 4 or above half the surface's vertices.
SeedSet place_seeds(const SurfaceMesh& surface, const SeedOptions& options, Context& context);
/// The same. Throws: usage when k is below 4 a component, too; names the resolution that would do.
SeedSet place_seeds(const Sheet& sheet, const SeedOptions& options, Context& context);
/// The same for method shell: one site at random in each of k strata of equal count.
SeedSet place_seeds(const SiteSet& sites, const SiteSamples& samples, const SeedOptions& options, Context& context);

struct RelaxOptions {
  int32_t max_passes = 100;
  int32_t tolerance_ppb = 10000;  ///< stop when the energy falls by less than this part in 10^9 a pass, over 5 passes
  int32_t max_step_q8 = 0;        ///< u, bound of a seed's move in a pass; 0 chooses (sheet: 0.4 h; shell: 1 voxel)

  bool operator==(const RelaxOptions& o) const {
    return max_passes == o.max_passes && tolerance_ppb == o.tolerance_ppb && max_step_q8 == o.max_step_q8;
  }
};
/// Energy of every pass: integer units of that method, comparable within one run.
struct RelaxReport {
  std::vector<double> energy;
  int32_t passes = 0;
  bool converged = false;
  /// Times the energy gives the paper's normalised CVT energy of method shell: mean squared distance of a voxel to its
  /// seed over the sites per seed, without dimension. 0 where the method has none.
  double normalised_energy_factor = 0;
};
struct RelaxedSeeds {
  SeedSet seeds;  ///< with the ids they had
  RelaxReport report;
};
/// Centroidal Voronoi tessellation of the surface with clipped cells and momentum. Seeds stay in their patches; fixed
/// ones keep position, normal and home, and their cells count in the energy. Throws: usage when a patch has no seed, or
/// fixed seeds are not of this surface.
RelaxedSeeds relax_on_sheet(const SurfaceMesh& surface, SeedSet&& seeds, const RelaxOptions& options, Context& context);
/// The paper's Lloyd loop over the active voxels of the shell, sections 3.2 and 3.3.
RelaxedSeeds relax_in_shell(const Shell& shell, const SiteSet& sites, const SiteSamples& samples, SeedSet&& seeds,
                            const RelaxOptions& options, Context& context);

/// Moves seeds onto a surface: its nearest point, its home vertex and outward normal. `halvings`: how many times the
/// voxels of the seeds' lattice must be halved to give the surface's; above 0 seeds come from a coarse proxy, from
/// half a voxel of theirs outside of it. A seed comes into the patch of its new home. Throws: usage for fixed seeds,
/// which sit on vertices of one surface.
SeedSet attach_to_sheet(const SurfaceMesh& surface, SeedSet&& seeds, int halvings, Context& context);

/// ShellFlooding(P, S) of the paper, section 3.4: labels spread through the shell only, so seeds that are close in
/// space but far along the shell never share a cell. Result: a seed starts in its voxel, or in the active voxel of the
/// smallest (squared distance to its centre, index) when that is not active; of several seeds in a voxel the one of the
/// smallest (squared distance from the centre, id) starts. Then in synchronous rounds every voxel without a label
/// takes, among the labels that its 26 neighbours got in earlier rounds, the one of the smallest (squared distance from
/// its centre to the seed, seed id). First come, first served: a voxel keeps its label even if a nearer seed arrives a
/// round later. Voxels of components without a seed hold kNone. Cost: O(active voxels), plus 1.4 KB a leaf.
VoronoiLabels flood_shell(const Shell& shell, const SeedSet& seeds, Context& context);

/// Connectivity of the result while positions are still on the lattice.
struct DualMesh {
  Buffer<PointQ8> position;           ///< per seed
  Buffer<TriangleIndices> triangles;  ///< smallest index first, sorted, outward
};
/// A mesh and the seeds that its vertices are.
struct SeededMesh {
  DualMesh mesh;
  SeedSet seeds;
};
struct DualReport {
  int64_t inserted_seeds = 0;       ///< appended to the seeds, in every round; a run may drop others afterwards
  int64_t relabelled_vertices = 0;  ///< in disconnected pieces that joined a neighbouring cell
  int64_t repair_rounds = 0;
  int64_t failed_cells = 0;  ///< left after the last round; 0 means the guarantee holds
};
struct DualOptions {
  int32_t max_repair_rounds = 64;  ///< 0 only checks
  bool keep_cells = false;         ///< fills Triangulation::cell
};
struct Triangulation : SeededMesh {
  Buffer<uint32_t> cell;  ///< per vertex of the surface the seed whose cell it is in; only where asked for
  DualReport report;
};
/// DualTriangulation(V_k) on the surface: a triangle whose vertices carry three labels is a face. Four checks
/// (cells in one piece, cells are disks, pairs meet in one arc, four cells a component) are repaired by splitting
/// cells; ids are kept, and a seed that owns nothing moves to the next split before seeds are appended. Result: when
/// report.failed_cells is 0, a closed orientable 2-manifold homeomorphic to the surface that uses every seed. Cost:
/// labels, then O(surface) and O(split cells) a round; 14 bytes a vertex of the surface. Needs a closed surface, or
/// borders with three fixed seeds or more each. Then the result is homeomorphic to the surface, with the edges between
/// successive fixed seeds as its borders; fixed seeds stay as they are, new ones are free, and no edge is there twice
/// once patches are joined. Throws: usage when there are no seeds or more than vertices.
Triangulation triangulate_dual(const SurfaceMesh& surface, SeedSet&& seeds, const DualOptions& options,
                               Context& context);

/// Seeds of the next finer level: the given ones, the middles of the dual's edges (the longest, if there are more than
/// needed) in canonical order, then the middles of the largest triangles. `target` seeds in all, at most
/// seeds + edges + triangles. Needs a closed surface, and a closed mesh.
SeedSet subdivide_seeds(const SurfaceMesh& surface, const DualMesh& mesh, const SeedSet& seeds, int64_t target,
                        Context& context);

struct CollapseOptions {
  int64_t target = 0;     ///< vertices to be left, every copy of a fixed one counted
  bool keep_ids = false;  ///< ids below the vertices left stay, and what stays of the others takes the ids set free
};
/// Takes vertices out of a closed mesh, with their seeds, until `target` are left: makes one vertex of the two ends of
/// an edge, short edges first (beside the lengths there), rather those whose loss makes valences more even. The
/// topology stays, and no triangle turns over; so more than `target` may be left. Ids close up, or are kept. Cost: a
/// sort of the edges a round, then one step for each looked at. Fixed vertices and the edges of borders stay: an edge
/// that has one fixed end is taken into that. Throws: usage when surface or mesh have a border without fixed seeds.
SeededMesh collapse_edges(const SurfaceMesh& surface, SeededMesh&& mesh, const CollapseOptions& options,
                          Context& context);

struct UntangledSheet {
  Sheet sheet;
  SeedSet seeds;
  int64_t self_intersections = 0;  ///< pairs of triangles that still intersect after the last round
};
/// Takes the vertices of a sheet's triangles that intersect back towards their lattice corners, where no triangles do,
/// half of the way a round and in the end all of it. Seeds keep their homes; where those moved, seeds go along.
UntangledSheet untangle_sheet(Sheet&& sheet, SeedSet&& seeds, Context& context);

/// Where vertices of the result lie.
enum class Fit {
  balanced,  ///< where the mesh straddles the surface: least distance on average and at tips, for its shapes
  surface,   ///< on the sheet, that is on the input
};
struct OptimizeOptions {
  int32_t flip_rounds = 6;       ///< independent sets each time
  int32_t smoothing_steps = 80;  ///< 0 leaves vertices where they are: flips only
  int32_t search_rounds = 10;    ///< independent sets of vertices of poor triangles
  Fit fit = Fit::balanced;
  bool uniform_area = false;  ///< triangles of even size rather than of the best shape
  bool for_seeds = false;     ///< ends with flips and smoothing: the vertices are to be seeds again
  int32_t mesh_passes = 0;    ///< of Lloyd relaxation on the mesh, before all else; only with for_seeds
  double noise_edges = 0;     ///< of these passes at first: how far noise moves vertices, in edges
  bool keep_apart = false;    ///< no flip that makes triangles intersect where vertices began, and no relocation
};
struct OptimizeReport {
  int64_t flips = 0;
  int64_t undone_vertices = 0;     ///< went back because of intersections; counted each time
  int64_t self_intersections = 0;  ///< pairs of triangles that still intersect; not looked for when the vertices
                                   ///< stay in place or are to be seeds
};
struct OptimizedMesh : SeededMesh {
  OptimizeReport report;
};
/// Valence flips, shape matching, a fit to the surface and searches around the worst triangles of a closed mesh whose
/// vertices are the seeds; homes and positions of the seeds follow. Where triangles intersect in the end, exactly
/// tested, the vertices around go back to where they were on the surface, then to where they began. Result: still
/// closed and 2-manifold, same genus. Fixed vertices stay where they are, with the edges of their borders; they are to
/// have as many triangles as their angle holds, and copies count as one vertex where intersections are looked for.
/// A closed component of at most 32 triangles bounds a volume of the same sign as the surface's component that it is
/// on. Passes on the mesh move vertices whatever the smoothing steps, and their flips are not counted; one costs
/// O(vertices), and they hold 300 bytes a vertex meanwhile. Throws: usage
/// when surface or mesh have a border without fixed seeds, and for passes on a mesh whose vertices are not for seeds.
OptimizedMesh optimize_mesh(const SurfaceMesh& surface, SeededMesh&& mesh, const OptimizeOptions& options,
                            Context& context);

struct JoinedMesh {
  DualMesh mesh;
  Buffer<uint32_t> vertex_of;  ///< per vertex of the mesh that was cut into patches its vertex in the joined one
};
/// Makes one vertex of all copies of a fixed seed (see FixedSeeds): where patches met the mesh is closed again.
/// Vertices keep their order, that of the first copy of each. In host memory.
JoinedMesh join_patches(const DualMesh& mesh, const FixedSeeds& fixed);

/// Final positions in the world.
TriangleMesh to_world(const DualMesh& mesh, const LatticeFrame& frame);

}  // namespace isoshell
