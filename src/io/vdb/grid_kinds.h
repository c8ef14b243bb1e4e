// What the grids of a .vdb file are good for, known from their descriptors alone.
#pragma once

#include "io/bytes/mesh_source.h"
#include "io/vdb/vdb_layout.h"
#include "io/vdb/volume_readers.h"
#include "isoshell/io/label_file.h"

namespace isoshell {

/// The grid with what keeps it from being distances or densities.
VolumeGrid as_volume(const VdbGridSpan& span);

/// The grid with what keeps it from being labels.
VolumeGrid as_labels(const VdbGridSpan& span);

/// Whether the grid that is named, or without a name the file as a whole, holds labels and nothing that is read as a
/// volume. Reads descriptors only. Throws: unreadable_input for a damaged .vdb file.
bool holds_labels(const MeshSource& source, const std::string& grid);

/// Whether the source is a .nvdb file by its first bytes.
bool is_nano_file(const MeshSource& source);

/// The name, apart from all others, of the grid that such an input is made of. Throws: as reading it does.
std::string meshed_grid(const MeshSource& source, const std::string& grid);

/// A volume of labels and the name of the grid that it was.
struct LabelGrid {
  std::string name;
  LabelVolume volume;
};

/// read_labels() of bytes that are in memory. Throws: as it does.
LabelGrid read_label_grid(const MeshSource& source, const LabelReadOptions& options);

}  // namespace isoshell
