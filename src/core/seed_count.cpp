// How many seeds a sheet can carry.
#include "core/seed_count.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "isoshell/error.h"

namespace isoshell {

void require_seed_count(const Sheet& sheet, int64_t count) {
  const int64_t fewest = 4 * std::max<int64_t>(1, sheet.topology.components), most = sheet.vertex_count() / 2;
  if (count < fewest)
    throw NoRoom("seeds", std::to_string(count) + " vertices are too few: the surface's " +
                              std::to_string(sheet.topology.components) + " components need at least " +
                              std::to_string(fewest));
  if (count > most) {
    const double factor = std::sqrt(double(count) / double(std::max<int64_t>(1, most)));
    throw NoRoom("seeds", std::to_string(count) + " vertices are too many for resolution " +
                              std::to_string(sheet.frame.resolution) + ", which can carry " + std::to_string(most) +
                              "; use a resolution of at least " +
                              std::to_string(int64_t(std::ceil(sheet.frame.resolution * factor))));
  }
}

}  // namespace isoshell
