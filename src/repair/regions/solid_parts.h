// The components of a soup as solids.
#pragma once

#include <cstdint>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/surface_source.h"

namespace isoshell::repair {

constexpr uint32_t kNoContainer = 0xffffffff;

enum class PartShape : uint8_t {
  closed,     ///< every edge has two faces, which pass it in opposite directions
  branching,  ///< no edge has one face, some have more than two
  open        ///< some edge has one face, or two that do not agree
};

/// Faces that are connected through edges.
struct SolidPart {
  std::vector<uint32_t> triangles;  ///< of the soup, ascending; none with two corners in one place
  PartShape shape = PartShape::closed;
  bool is_turned = false;             ///< is to be turned, so that it looks outward or bounds a hollow
  uint32_t container = kNoContainer;  ///< of one that looks inward the smallest part with it inside of its box
};

/// In the order of their first triangles. Throws: interrupted. Cost: sorts of the vertices and edges, and a ray from
/// each part that looks inward.
std::vector<SolidPart> find_solid_parts(const TriangleSoup& soup, const Context& context);

}  // namespace isoshell::repair
