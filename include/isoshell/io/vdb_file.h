// Stage files: products to .vdb and back, so that a run can stop after the shell or the Voronoi volume and be resumed
// from that file alone. docs/VDB_FORMAT.md lists every grid and every metadata key.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "isoshell/advanced/lattice_surface.h"
#include "isoshell/advanced/level_set.h"
#include "isoshell/advanced/seed_set.h"
#include "isoshell/advanced/shell.h"
#include "isoshell/advanced/site_set.h"
#include "isoshell/advanced/voronoi_labels.h"

namespace isoshell {

/// What the caller wants to be written beside the products.
struct StageWriteOptions {
  std::string options_json;         ///< options of the run, kept as given; at most 256 KiB
  int32_t closing_vox = -1;         ///< closing radius r of the run; -1 when not chosen yet
  bool overwrite = false;           ///< replace an existing file
  bool view_grids = true;           ///< also write the grids that are only there to be looked at
  std::vector<Voxel> bridges = {};  ///< see bridging_voxels: 1 in the grid "gap", too
  std::string left_out;             ///< what of the input the file does not hold, and where that is
};

/// What a stage file says about itself.
struct StageInfo {
  std::string stage;  ///< "shell" or "voronoi"
  int32_t format_version = 0;
  std::string creator;
  std::string options_json;
  int32_t closing_vox = -1;
  std::string left_out;                        ///< empty where nothing is known to be missing
  std::map<std::string, std::string> digests;  ///< by product: surface, sites, shell, seeds, labels
};

/// Everything a stage file holds. Products are equal, digest by digest, to those that were saved.
struct StageFile {
  StageInfo info;
  LatticeSurface surface;
  SiteSet sites;
  Shell shell;
  std::optional<SeedSet> seeds;         ///< stage voronoi
  std::optional<VoronoiLabels> labels;  ///< stage voronoi
};

/// Sites of a shell: its voxels at distance 0, in canonical order, which is the order of their ids.
SiteSet sites_of_shell(const Shell& shell, const LatticeFrame& frame);

/// Whether this build can: without OpenVDB everything here that writes or reads throws.
bool can_write_vdb();

/// Writes the stage file of the shell. Written under a temporary name and renamed. Result: two saves of equal arguments
/// give equal bytes. Throws: unwritable_output; usage when sizes do not fit one another or options_json is too long.
void save_shell(const std::string& path, const LatticeSurface& surface, const SiteSamples& samples, const Shell& shell,
                const StageWriteOptions& options = {});

/// The same with the seeds and the Voronoi labels of the shell's voxels.
void save_voronoi(const std::string& path, const LatticeSurface& surface, const SiteSamples& samples,
                  const Shell& shell, const SeedSet& seeds, const VoronoiLabels& labels,
                  const StageWriteOptions& options = {});

/// Writes float grids only, which every program opens: `density` 1 in the shell and, with labels, `seed_rand` and
/// `color` by a hash of the seed id. Not a stage file. Throws as save_shell.
void save_preview(const std::string& path, const LatticeFrame& frame, const Shell& shell, const VoronoiLabels& labels,
                  const StageWriteOptions& options = {});

struct LevelSetWriteOptions {
  std::string name = "surface";  ///< of the grid
  bool as_half = false;          ///< values in 16 bits, to 1/2048 of the band or better
  bool overwrite = false;        ///< replace an existing file
};

/// Writes a level set that every program opens: a float grid of that class, in world units, from voxel centres;
/// inactive voxels inside have the background's negative. Throws: usage where a distance is missing; and as
/// check_level_set_write() and save_shell do.
void save_level_set(const std::string& path, const LevelSet& level_set, const LevelSetWriteOptions& options = {});

/// Throws: usage where values of 16 bits are asked for and do not hold the band: their largest number is 65504, and
/// below a band of 2^-14 world units they are coarser than 1/2048 of it.
void check_level_set_write(const LevelSet& level_set, const LevelSetWriteOptions& options);

/// Whether this is a file that save_shell or save_voronoi wrote. Cost: the first bytes of the file. Never throws; a
/// file that cannot be read is none.
bool is_stage_file(const std::string& path);

/// Reads a stage file. Damage is found before anything is trusted: the file carries a checksum of itself, a file
/// without ours (saved again by another program) is held to its products' digests, and every value to its range; only
/// SeedSet::home is left to the stage that knows its limit.
/// Throws: unreadable_input (names file, part and value), out_of_memory.
StageFile read_stage(const std::string& path);

}  // namespace isoshell
