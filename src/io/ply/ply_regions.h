// Regions in PLY files: two integers a face, and names in comments.
#pragma once

#include "io/ply/ply_header.h"
#include "isoshell/surface_source.h"

namespace isoshell {

constexpr const char* kRegionInside = "region_inside";
constexpr const char* kRegionOutside = "region_outside";

/// Makes regions of the attributes of faces that have these names, if both are there, are integers that fit 32
/// bits; else they stay attributes. Faces that have the background behind them, or the larger of two
/// labels, are turned.
void take_regions(const MeshSource& source, const PlyHeader& header, TriangleSoup& soup);

}  // namespace isoshell
