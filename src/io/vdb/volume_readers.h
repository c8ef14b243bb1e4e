// One reader a format of volumes. Each throws as read_volume() does.
#pragma once

#include <memory>
#include <vector>

#include "implicit/volumes/scalar_field.h"
#include "io/bytes/mesh_source.h"
#include "isoshell/io/volume_file.h"

namespace isoshell {

/// A grid of a file as its reader lists it, before it is read.
struct VolumeGrid {
  std::string name, type, grid_class;
  std::string flaw;  ///< why it has no surface, or empty

  std::string text() const;  ///< "density" (float, fog volume)
};

/// Which of the grids to read. Throws: usage when several would do or the name is not there, nothing_to_mesh when none
/// would; `wanted` is what messages say that none is.
size_t choose_grid(const std::string& path, const std::vector<VolumeGrid>& grids, const VolumeReadOptions& options,
                   const char* wanted = "that has a surface");

/// Throws: out_of_memory when reading would take more than the limit beside what is held of the source.
void check_volume_memory(const MeshSource& source, const VolumeGrid& grid, int64_t grid_bytes,
                         const VolumeReadOptions& options);

/// Fills `to` from the packed grid of a .nvdb file. False when the bytes do not fit each other.
/// Throws: unreadable_input in a build without OpenVDB.
bool unpack_stream(View<const char> packed, bool zip, View<char> to);

/// The field keeps what it needs of the source's bytes; the source must outlive it.
std::unique_ptr<ScalarField> read_vdb_volume(const MeshSource& source, const VolumeReadOptions& options);
/// Of a .nvdb file, with what keeps each from being a volume.
std::vector<VolumeGrid> nano_grids(const MeshSource& source);
std::unique_ptr<ScalarField> read_nano_volume(const MeshSource& source, const VolumeReadOptions& options);

/// The surface of a field, as read_volume() finds it.
TriangleSoup surface_of_field(ScalarField& field, const VolumeReadOptions& options, VolumeInfo& info);

/// read_volume() of bytes that are in memory.
TriangleSoup read_volume(const MeshSource& source, const VolumeReadOptions& options, VolumeInfo& info);
/// read_volume() of a field; `file` is what messages say it is of.
TriangleSoup read_volume(std::unique_ptr<ScalarField> field, const std::string& file, const VolumeReadOptions& options,
                         VolumeInfo& info);

}  // namespace isoshell
