// Between OpenVDB's grids and the bytes of a .vdb file.
#pragma once

#include <openvdb/Grid.h>

#include <functional>
#include <string>
#include <vector>

#include "io/vdb/vdb_layout.h"
#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// Registers OpenVDB's types; may be called again and from any thread.
void initialize_openvdb();

/// Voxel (0,0,0) has its centre where index (0,0,0) is mapped to.
openvdb::math::Transform::Ptr lattice_transform(const LatticeFrame& frame);

/// Calls the makers, several at a time, and writes their grids in order behind one header. The file's unique tag is a
/// checksum of the rest, so equal grids give equal bytes. Throws: unwritable_output.
void write_vdb_file(const std::string& path, const std::vector<std::function<openvdb::GridBase::Ptr()>>& makers,
                    const openvdb::MetaMap& meta, bool overwrite);

/// The grid that a layout names, with its metadata of type string. Damage is found before OpenVDB sees the bytes.
/// Throws: unreadable_input, std::bad_alloc.
openvdb::GridBase::Ptr read_vdb_grid(const std::string& path, View<const char> bytes, const VdbGridSpan& grid);

}  // namespace isoshell
