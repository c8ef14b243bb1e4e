// Grids of OpenVDB, wherever they come from, as fields and labels.
#pragma once

#include <openvdb/openvdb.h>

#include <map>
#include <memory>
#include <string>

#include "io/vdb/grid_kinds.h"
#include "isoshell/io/grid_field.h"

namespace isoshell {

/// Of a grid of floats or doubles, with the name and class that it is known by.
std::unique_ptr<ScalarField> field_of_grid(const openvdb::GridBase::ConstPtr& grid, const VolumeGrid& about);

/// Its values anywhere, under that name. Throws: usage for a grid of a type that is not sampled.
std::shared_ptr<const GridField> field_of_values(const openvdb::GridBase::ConstPtr& grid, const std::string& name);

/// Of a grid of whole numbers, whose tree takes `tree_bytes` beside the array; `texts` is its metadata of type string.
/// Throws: as read_labels().
LabelVolume labels_of_grid(const MeshSource& source, const openvdb::GridBase& grid, const VolumeGrid& about,
                           const std::map<std::string, std::string>& texts, int64_t tree_bytes,
                           const LabelReadOptions& options);

}  // namespace isoshell
