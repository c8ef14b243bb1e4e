// Boundaries of small voxel solids as closed soups: any genus, any number of components, thin walls and tubes.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <tuple>

#include "support/shapes.h"

namespace isoshell::shapes {

/// Boundary of the voxels of [0, n)^3 with inside(x, y, z), two outward triangles a face, corners shared. A 2-manifold
/// when no two voxels touch in an edge or a corner alone.
inline TriangleSoup solid_boundary(int n, const std::function<bool(int, int, int)>& inside) {
  TriangleSoup soup;
  std::map<std::tuple<int, int, int>, uint32_t> index;
  const auto corner = [&](int x, int y, int z) {
    const auto [at, is_new] = index.try_emplace({x, y, z}, uint32_t(soup.vertices.size()));
    if (is_new) soup.vertices.push_back({double(x), double(y), double(z)});
    return at->second;
  };
  const auto in = [&](int x, int y, int z) {
    return x >= 0 && y >= 0 && z >= 0 && x < n && y < n && z < n && inside(x, y, z);
  };
  // Corners of the cube by bits x, y, z; each face counter-clockwise from outside.
  const int face[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  const int step[6][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < n; ++z)
        for (int f = 0; in(x, y, z) && f < 6; ++f) {
          if (in(x + step[f][0], y + step[f][1], z + step[f][2])) continue;
          uint32_t q[4];
          for (int i = 0; i < 4; ++i) {
            const int c = face[f][i];
            q[i] = corner(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2 & 1));
          }
          add_triangle(soup, q[0], q[1], q[2]);
          add_triangle(soup, q[0], q[2], q[3]);
        }
  soup.faces_in_file = int64_t(soup.triangles.size()) / 2;
  return soup;
}

/// The edges of a cube, `width` voxels thick: genus 5.
inline TriangleSoup cube_frame(int n, int width) {
  return solid_boundary(n, [=](int x, int y, int z) {
    const auto rim = [=](int c) { return c < width || c >= n - width; };
    return int(rim(x)) + int(rim(y)) + int(rim(z)) >= 2;
  });
}

/// A plate with `holes` by `holes` square holes, bars `bar` wide, `thick` voxels thick: genus holes^2.
inline TriangleSoup sieve(int holes, int hole, int bar, int thick) {
  const int n = holes * (hole + bar) + bar;
  return solid_boundary(
      n, [=](int x, int y, int z) { return z < thick && (x % (hole + bar) < bar || y % (hole + bar) < bar); });
}

/// A straight rod of one voxel's width.
inline TriangleSoup rod(int length) {
  return solid_boundary(length, [](int, int y, int z) { return y == 0 && z == 0; });
}

/// `count` cubes of `side` voxels in a row, one voxel apart.
inline TriangleSoup cubes(int count, int side) {
  return solid_boundary(count * (side + 1),
                        [=](int x, int y, int z) { return x % (side + 1) < side && y < side && z < side; });
}

}  // namespace isoshell::shapes
