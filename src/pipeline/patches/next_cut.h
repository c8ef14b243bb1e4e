// How a surface is cut again where patches of it are wrong.
#pragma once

#include <optional>
#include <vector>

#include "features/cutting/change_paths.h"

namespace isoshell {

struct NextCut {
  Paths paths;
  std::vector<double> edge_length;  ///< of the fine mesh; empty: as it was
};

/// Without creases around what is wrong. Between regions, where all curves stay: with edges of half the length there,
/// on curves and beside them. None where nothing can be changed.
std::optional<NextCut> next_cut(const CutSurface& cut, const std::vector<PointQ8>& wrong);

}  // namespace isoshell
