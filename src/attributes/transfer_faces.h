// Attributes of corners and faces of one surface for the faces of another.
#pragma once

#include <vector>

#include "attributes/welded_source.h"
#include "isoshell/backend.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// Finds for each face of a mesh the face of the source under its middle, and from there values for its corners.
class FaceTransfer {
 public:
  /// Keeps references to all but the context.
  FaceTransfer(const WeldedSource& source, const TriangleMesh& mesh, Context& context);

  Attribute of_faces(const Attribute& attribute) const;
  /// A corner takes the nearest value of those faces that can be reached from the one under the middle without leaving
  /// the surroundings of the mesh's face, and without passing a jump.
  Attribute of_corners(const Attribute& attribute, const std::vector<Jump>& jumps) const;

 private:
  const WeldedSource& source_;
  const TriangleMesh& mesh_;
  Context& context_;
  std::vector<uint32_t> under_;  ///< per face of the mesh a triangle of the source
};

}  // namespace isoshell
