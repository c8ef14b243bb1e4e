// Whatever a run can start from, read by one call: a mesh, points, a volume or a stage file.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/io/grid_field.h"
#include "isoshell/io/point_file.h"
#include "isoshell/io/vdb_file.h"
#include "isoshell/io/volume_file.h"
#include "isoshell/message.h"
#include "isoshell/region_census.h"
#include "isoshell/surface_source.h"

namespace isoshell {

enum class InputKind { mesh, points, volume, labels, stage };

/// "mesh", "points", "volume", "labels" or "stage".
const char* kind_name(InputKind kind);

/// How a file of labels is read. What has no value is as in read_labels() and LabelVolume.
struct LabelReading {
  std::optional<int32_t> background;           ///< the label of what is no region
  std::optional<int64_t> smallest_island_vox;  ///< islands of fewer voxels get the label around them

  std::optional<double> smoothing_vox;             ///< how far walls may leave the faces of their voxels
  std::optional<std::array<bool, 3>> is_periodic;  ///< axes along which opposite sides get the same triangles

  /// The option that was given first; null where none was.
  const char* given() const {
    return background            ? "--background"
           : smallest_island_vox ? "--smallest-island"
           : smoothing_vox       ? "--smoothing"
           : is_periodic         ? "--periodic"
                                 : nullptr;
  }
  /// The first one that level sets as regions have no use for.
  const char* given_of_labels() const {
    return background ? "--background" : smoothing_vox ? "--smoothing" : is_periodic ? "--periodic" : nullptr;
  }
};

/// A file and what is needed to read it.
struct InputRequest {
  std::string path;                             ///< "-" is standard input
  std::string format;                           ///< lower case, without a dot; empty: by the path
  std::string grid;                             ///< of a volume, as in VolumeReadOptions; empty: the only one; with *
                                                ///< or ? all level sets whose names fit, as regions
  std::optional<double> iso;                    ///< of a volume
  LabelReading labels = {};                     ///< of a volume of labels
  VolumeCreases creases = VolumeCreases::none;  ///< of a volume or points; a run sets it by its features
  bool keep_open = false;                       ///< the same of borders; a run sets it by its boundary
  bool keep_points = false;                     ///< of points: no surface is made of them
  std::vector<std::string> also = {};   ///< more files of level sets, named as INPUT is: all of them are regions
  bool unite = false;                   ///< of several level sets: one surface around all of them
  std::string reference = {};           ///< of several level sets: a mesh or level set, named as INPUT is, what was cut
  std::vector<std::string> grids = {};  ///< whose values vertices of the result get, as grid_name_of() takes them
  std::vector<std::shared_ptr<const GridField>> given_grids = {};  ///< the same of grids in memory

  /// Whether vertices get values of any.
  bool samples_grids() const { return !grids.empty() || !given_grids.empty(); }
};

/// The request that a person's words mean: "FILE.vdb:NAME" and "FILE.nvdb:NAME" name a grid; a format in upper case or
/// with a dot is the same. Throws: usage when nothing says the format of standard input, or a colon names no grid.
InputRequest named_input(const std::string& name, const std::string& format = "");
/// The same with what `request` says of how it is read. Throws: as the other does.
InputRequest named_input(const std::string& name, InputRequest request);

/// Throws: usage where the request asks for a union or a reference and is not for several level sets, for both of these
/// at once, or for all grids beside several level sets.
void check_several(const InputRequest& request);

/// What is known of an input before the first stage.
struct InputFacts {
  std::string path;                    ///< as in the request
  std::vector<std::string> also = {};  ///< the same
  InputKind kind = InputKind::mesh;
  int64_t vertices = -1, faces = -1;  ///< as in the file, of points the different ones; -1: of a stage file not known
  std::optional<WorldPoint> box_min, box_max;  ///< of the surface, world units; of a stage file not known
  SurfaceRegions regions;                      ///< of the surface, once islands are absorbed

  /// As messages call it.
  std::string name() const { return path == "-" ? "standard input" : path; }
};

/// Either a surface, or the products of an earlier run, or points.
struct Input {
  InputFacts facts;
  TriangleSoup soup;               ///< empty when there is a stage file, or points without a surface
  std::vector<WorldPoint> points;  ///< different ones, where they were kept as points
  std::optional<StageFile> stage;  ///< its options are for the run to read
  /// Those that the request names; of a volume or labels of a .vdb file alone: others have none of their own, and no
  /// list. A run adds those of other files.
  std::optional<std::vector<std::shared_ptr<const GridField>>> grids = {};
};

/// Reads a file of any kind, and makes a surface of points, unless they are kept as points, and of volumes. Tells what
/// was read, and warns of what of it could not be used. Throws: unreadable_input when the file is missing or of no
/// known kind, usage for an isovalue of what is no volume and for LabelReading of what holds no labels, and as the
/// readers of each kind do (mesh_file.h, point_file.h, volume_file.h, vdb_file.h, grid_field.h); out_of_memory over the
/// context's limit, and interrupted while labels become walls.
Input read_input(const InputRequest& request, const Context& context, const Tell& tell = {});
/// The same with a limit alone, if that is above 0.
Input read_input(const InputRequest& request, int64_t memory_limit_bytes, const Tell& tell = {});

/// A surface and points that are in memory already, under the name that messages and statistics call them by. A surface
/// that says no number of faces has its triangles. Throws: nothing_to_mesh; unreadable_input for a triangle whose
/// vertex is not there or not finite, a point or normal that is not finite; usage for another number of normals than of
/// points; and as surface_of_points does.
Input input_of(TriangleSoup soup, const std::string& name, const Tell& tell = {});
Input input_of(const PointCloud& cloud, const std::string& name, int64_t memory_limit_bytes, const Tell& tell = {},
               VolumeCreases creases = VolumeCreases::of_sharp_bodies, bool keep_open = false);
/// The same without a surface. Throws: nothing_to_mesh for no point; and as the other does.
Input input_of_points(PointCloud cloud, const std::string& name, const Tell& tell = {});

}  // namespace isoshell
