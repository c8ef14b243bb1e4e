// Colours that show the patches, curves and corners of a result.
#pragma once

#include "isoshell/run/record.h"

namespace isoshell {

/// Gives faces, and vertices inside of a patch, the colour of their patch, vertices on curves black, and corners red. A
/// mesh without features stays as it is, with a warning. Colours that the mesh had are dropped, as the report says
/// then.
void color_features(TriangleMesh& mesh, AttributeReport& report, const Tell& tell);

}  // namespace isoshell
