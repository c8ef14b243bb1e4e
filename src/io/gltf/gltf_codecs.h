// Decoders of what extensions of glTF pack. Each is compiled with its library, or else refuses all that it is given.
#pragma once

#include <string>
#include <vector>

#include "isoshell/advanced/buffer.h"
#include "isoshell/attribute.h"

namespace isoshell {

/// A primitive of KHR_draco_mesh_compression.
struct DracoMesh {
  struct Attribute {
    int64_t id;                ///< Draco's unique one
    NumberType type;           ///< of what is wanted, as its accessor says
    int32_t components;        ///< refused if Draco's attribute has others
    std::vector<char> values;  ///< result: of all points, packed
  };
  View<const char> packed;
  int64_t most_triangles, most_points;  ///< refused before memory is taken for more
  int64_t most_bytes;                   ///< of all attributes that are packed, wanted or not; as those
  std::vector<Attribute> attributes;
  int64_t points = 0;         ///< result
  std::vector<char> indices;  ///< result: of 32 bits, of points, three a triangle; they may be out of range
};

/// Result: what is wrong with `mesh.packed`, as the end of a sentence about it; empty if nothing is.
/// Throws: std::bad_alloc.
std::string decode_draco(DracoMesh& mesh);

/// A buffer view of EXT_meshopt_compression.
struct MeshoptView {
  View<const char> packed;
  int64_t count, stride;  ///< of elements; the product is in range
  std::string mode, filter;
  std::vector<char> values;  ///< result
};

/// Result: as of decode_draco, of `view`.
std::string decode_meshopt(MeshoptView& view);

}  // namespace isoshell
