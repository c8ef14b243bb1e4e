// What can be asked of a run.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "isoshell/advanced/stages.h"
#include "isoshell/polylines.h"
#include "isoshell/previous_frame.h"
#include "isoshell/sizing.h"

namespace isoshell {

enum class Method {
  sheet,  ///< clipped cells on the sheet, the default
  shell,  ///< the paper's Lloyd loop on shell voxels
};

/// Which edges of the input become edges of the result.
struct Features {
  enum class Creases {
    off,        ///< none: sharp edges are rounded off
    automatic,  ///< those of crisp parts, and none of a scan; none with the method shell
    threshold,  ///< all whose faces turn by `degrees` or more
  };
  Creases creases = Creases::automatic;
  double degrees = 0;                           ///< only of a threshold
  std::shared_ptr<const Polylines> lines = {};  ///< become edges of the result, whatever the creases; null: none
};

/// What becomes of the borders of a surface that is not closed.
enum class Boundary {
  close,  ///< narrow holes are capped or bridged, and the result is closed
  keep,   ///< borders wider than the gaps to close are borders of the result
};

/// What becomes of the places where texture coordinates of neighbouring faces, or the images they are in, differ.
enum class UvSeams {
  keep,    ///< they are edges of the result, where the surface allows it
  ignore,  ///< triangles lie across them, and take all their texture coordinates from the chart under their middle
};

/// How long edges are on the walls of a region.
struct RegionEdgeLength {
  std::string region;  ///< its label in decimal digits, or its name
  double edge_length_world = 0;
};

/// How many vertices, and where.
struct SizeOptions {
  std::optional<int64_t> vertices = 10000;    ///< target count; without it as `sizing` asks for, or 10000
  std::optional<double> edge_length_world;    ///< target edge length, instead of `vertices`
  std::shared_ptr<const SizingField> sizing;  ///< edge lengths to aim at; null: the same everywhere
  /// Before those of `sizing`, each of a region once; where two have a wall, the shorter one holds. Others have what
  /// they would have without.
  std::vector<RegionEdgeLength> region_edge_lengths = {};
  double adaptivity = 0;   ///< part of the vertices that goes by curvature, 0 to 1
  double gradation = 1.2;  ///< most that an edge may be longer than its neighbours, above 1
};

/// The solid, and the voxels that it is found with.
struct GridOptions {
  std::optional<int32_t> resolution;       ///< voxels along the longest side
  std::optional<double> voxel_size_world;  ///< instead of `resolution`
  int32_t band_vox = 2;                    ///< d
  std::optional<int32_t> closing_vox;      ///< r; without it 0 for a closed surface, else as much as closes leaks
  std::optional<double> closing_world;     ///< width of gaps to close, world units, instead of closing_vox
  bool outer_only = false;                 ///< drop what lies inside of a closed surface
};

/// The loop that moves seeds.
struct RelaxationOptions {
  Method method = Method::sheet;
  std::optional<int32_t> max_passes;   ///< of the finest level of seeds; without it the method's own
  std::optional<double> tolerance;     ///< relative fall of the energy a pass; without it the method's own
  std::optional<double> max_step_vox;  ///< u; without it the method's own
  uint64_t seed = 0;
};

/// What the triangles are to be like, and what they keep of the input.
struct ShapeOptions {
  Fit fit = Fit::balanced;
  bool uniform_area = false;            ///< triangles of even size rather than of the best shape
  Features features;                    ///< a threshold needs the method sheet
  Boundary boundary = Boundary::close;  ///< keep needs the method sheet
  /// What the regions of a mesh are, as find_part_regions() takes it: its walls become one mesh; empty: it is one
  /// solid.
  std::string regions = {};
  std::optional<double> snap_world = {};  ///< faces of regions that are nearer are one wall
  /// Where texture coordinates, materials or groups of the input jump, the result has edges; names of faces, as
  /// materials and groups, end at edges either way. The values themselves go over by transfer_attributes().
  UvSeams uv_seams = UvSeams::keep;
};

/// What has no value is chosen by the run. The numbers that stood for that before, 0 or -1 by option, mean it still.
struct RemeshOptions : SizeOptions, GridOptions, RelaxationOptions, ShapeOptions {
  /// The frame before this one of a sequence: vertices keep their numbers; null: there is none. Needs the method sheet.
  /// Where the surface is another than before, or cannot be meshed from there, the run begins as without it, and
  /// vertices get the numbers of those that lie nearest.
  std::shared_ptr<const PreviousFrame> previous = {};
  bool want_shell = false;        ///< build the shell even when the method does not need it, to keep it
  double level_set_band_vox = 0;  ///< above 0: keep the vertices that were snapped, for a level_set() of that band
  bool want_samples = true;   ///< keep Prepared::samples() when the sheet is made, though it and no shell reads them
  bool want_digests = false;  ///< fill RemeshReport::digests
};

}  // namespace isoshell
