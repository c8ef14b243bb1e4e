// The call most people need: a surface in, an isotropic closed mesh out. And the same in three steps, for those who
// keep or resume from the products between them.
#pragma once

#include <cstdint>
#include <memory>

#include "isoshell/advanced/level_set.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/remesh_options.h"
#include "isoshell/remesh_report.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

struct PreparedSurface;

/// A surface on its grid, ready for seeds: the products up to the sheet, and what its run has resolved of the options.
/// Copies share their products.
class Prepared {
 public:
  const LatticeSurface& surface() const;
  const SiteSet& sites() const;
  const SiteSamples& samples() const;  ///< empty where want_samples, the shell and digests let them go
  const Shell& shell() const;          ///< empty unless the method or want_shell asked for it
  const Sheet& sheet() const;          ///< with edge lengths where they vary
  int32_t closing_vox() const;         ///< that was chosen
  bool is_in_patches() const;          ///< the input's own triangles, or the sheet, cut along what curves there are
  bool has_bridges() const;            ///< gaps may be closed by voxels of the sheet
  const RemeshReport& report() const;  ///< what was measured up to here
  void free_samples();  ///< of all copies: relax() and triangulate() of the method sheet do not read them

 private:
  friend struct PreparedParts;  // of the library, in src/pipeline/grid
  explicit Prepared(std::shared_ptr<PreparedSurface> parts);

  std::shared_ptr<PreparedSurface> parts_;
};

/// Repairs the faces of an input that is not closed and oriented; holes are capped unless a closing is asked for.
/// Unites the components of one that is: what lies in solid goes, surfaces of hollows stay unless only outer ones are
/// wanted. Then chooses the grid, voxelises, builds the sheet. Where that has not the components and genus of a closed,
/// oriented input, its own triangles are meshed. If that cannot be, the grid is refined by halves, at most to four
/// times the first choice (never beyond a given resolution), or until two finer grids in a row brought nothing. Throws:
/// nothing_to_mesh, usage, out_of_memory, interrupted.
Prepared prepare(const TriangleSoup& soup, const RemeshOptions& options, Context& context);
/// The same from a mesh, as a result of an earlier call or of the caller's own making: positions, triangles, attributes
/// and regions count, features and gaps do not. Cost: a copy of it. Throws: unreadable_input, naming the first, for a
/// triangle whose vertex is not there or not finite, and for attributes or regions that do not fit; and as the other.
Prepared prepare(const TriangleMesh& mesh, const RemeshOptions& options, Context& context);
/// The same from a surface that is on its lattice already, with the closing that was chosen for it: a resumed run.
Prepared prepare(LatticeSurface surface, int32_t closing_vox, const RemeshOptions& options, Context& context);

/// Signed distances around the solid that a prepared surface's sheet bounds, less than so many voxels from it (see
/// LevelSet). Exact to the input's own vertices where level_set_band_vox has kept them, else to the nearest 1/256
/// voxel. Throws: usage where the surface parts regions, and for a band outside of 1 to kMaxLevelSetBandVox.
LevelSet level_set(const Prepared& prepared, double band_vox, Context& context);

/// Seeds of a prepared surface, and what was measured up to there.
struct Relaxed {
  SeedSet seeds;
  RemeshReport report;
};
/// Places and relaxes the seeds, by the options that the surface was prepared with.
Relaxed relax(const Prepared& prepared, Context& context);

struct RemeshResult {
  TriangleMesh mesh;
  RemeshReport report;
};
/// Dual, repair and the final mesh. Repair may add seeds and drop others to keep the count.
RemeshResult triangulate(const Prepared& prepared, Relaxed relaxed, Context& context);

/// Algorithm 1 of the paper: prepare, relax, triangulate.
RemeshResult remesh(const TriangleSoup& soup, const RemeshOptions& options, Context& context);
/// The same from a mesh, of which prepare() says what counts. Throws: as that does.
RemeshResult remesh(const TriangleMesh& mesh, const RemeshOptions& options, Context& context);

}  // namespace isoshell
