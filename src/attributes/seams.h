// The edges of a surface where its attributes jump.
#pragma once

#include <array>
#include <vector>

#include "isoshell/remesh_options.h"
#include "isoshell/surface_source.h"

namespace isoshell {

struct Seams {
  std::vector<std::array<WorldPoint, 2>> edges;  ///< ends as they are in the soup
  std::vector<DroppedAttribute> dropped;         ///< attributes that jump too often
};

/// Where texture coordinates, the images they are in, materials, groups and objects jump between two faces. Left out
/// are
/// - texture coordinates, other attributes of corners, and images, if seams of UVs are to be ignored;
/// - attributes whose seams would leave patches narrower than about two edges;
/// - edges where values differ at one end only, if they are shorter than two edges and end freely there, as slits do,
/// or
///   if more than six seams would meet, as at the pole of a globe.
/// Result: in the order of the edges of the welded soup. Cost: nothing without such attributes, else a sort of the
/// half-edges.
Seams find_seams(const TriangleSoup& soup, UvSeams uv_seams, double edge_length_world);

}  // namespace isoshell
