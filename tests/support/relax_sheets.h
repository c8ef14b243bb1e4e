// Sheets that relaxation is tested on.
#pragma once

#include "support/shapes.h"
#include "support/soup_sheet.h"

namespace isoshell {

inline Sheet torus_sheet() { return sheet_of_soup(shapes::torus(2, 0.7, 160, 70), 256, 1, 1); }

/// Two walls two voxels apart with opposite normals.
inline Sheet plate_sheet() {
  TriangleSoup s;
  const int n = 41;
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) s.vertices.push_back({i * 0.1, j * 0.1, k * 0.07});
  const auto at = [&](int k, int i, int j) { return uint32_t((k * n + i) * n + j); };
  for (int i = 0; i + 1 < n; ++i)
    for (int j = 0; j + 1 < n; ++j) {
      s.triangles.push_back({at(1, i, j), at(1, i + 1, j), at(1, i + 1, j + 1)});
      s.triangles.push_back({at(1, i, j), at(1, i + 1, j + 1), at(1, i, j + 1)});
      s.triangles.push_back({at(0, i, j), at(0, i + 1, j + 1), at(0, i + 1, j)});
      s.triangles.push_back({at(0, i, j), at(0, i, j + 1), at(0, i + 1, j + 1)});
    }
  return sheet_of_soup(s, 120, 2, 0);
}

}  // namespace isoshell
