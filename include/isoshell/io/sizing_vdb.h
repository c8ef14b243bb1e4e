// Sizing fields from .vdb files, from memory, and from numbers of a surface's vertices.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "isoshell/io/memory_input.h"
#include "isoshell/sizing.h"
#include "isoshell/surface_source.h"

namespace isoshell {

/// Reads a FloatGrid of edge lengths in world units: "FIELD.vdb" with one float grid, or "FIELD.vdb:grid",
/// which is named as in VolumeReadOptions. Between the voxels of its active region lengths are interpolated; outside of
/// it the background counts, if it is more than 0.
/// Throws: unreadable_input (names file, grid, value and remedy) also where an active value is no length; out_of_memory
/// for a file larger than `max_bytes` (0: no limit).
std::shared_ptr<const SizingField> read_sizing(const std::string& source, int64_t max_bytes = 0);

/// The same from values in memory, which are copied; NaN is what an inactive voxel is in a file. `name` is what
/// messages call the field. Throws: usage for an array without values or steps that span no volume; as read_sizing
/// does.
std::shared_ptr<const SizingField> sizing_of(const DenseVolume& lengths, const std::string& name);

/// The length at the nearest place of a surface, interpolated in its triangle from those of its vertices; NaN says
/// nothing, for the whole triangle. `name` is what messages call the lengths. Cost: the surface is copied; building is
/// linear in its triangles, a point takes the search for one. Throws: usage for another number of lengths than of
/// vertices; unreadable_input for one that is infinite or not more than 0, and where all are NaN; nothing_to_mesh
/// without a triangle.
std::shared_ptr<const SizingField> sizing_on(const TriangleSoup& surface, std::vector<double> lengths,
                                             const std::string& name);

/// The same of the numbers that vertices of the surface have as an attribute. Throws: usage where they have none of
/// that name; as sizing_on does.
std::shared_ptr<const SizingField> sizing_of_attribute(const TriangleSoup& surface, const std::string& name,
                                                       const std::string& surface_name);

/// Whether a person's words name a file, as read_sizing takes it, and not an attribute.
bool is_sizing_file(const std::string& text);

}  // namespace isoshell
