// Walls between labels, with the crossings that they were made of.
#pragma once

#include <string>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/io/memory_input.h"

namespace isoshell {

/// surface_of_labels() of a volume with crossings. `of_triangles` gets that of each triangle, unless it is null.
TriangleSoup surface_of_labels(LabelVolume volume, const std::string& name, const Context& context, const Tell& tell,
                               std::vector<WallCrossing>* of_triangles);

}  // namespace isoshell
