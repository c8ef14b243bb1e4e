// The planes of the triangles around a vertex. Smoothing and searching move vertices along the mesh, and would wear
// down what is finer than an edge, tips, ridges and rims: a move that leaves those planes is shortened.
#pragma once

#include "stages/halfedge/triangle_shape.h"

namespace isoshell::optimize {

/// A symmetric 3 x 3 matrix: xx, xy, xz, yy, yz, zz.
struct Symmetric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  ISOSHELL_HD void add(double w, Vector d) {
    xx += w * d.x * d.x, xy += w * d.x * d.y, xz += w * d.x * d.z;
    yy += w * d.y * d.y, yz += w * d.y * d.z, zz += w * d.z * d.z;
  }
  ISOSHELL_HD Symmetric squared() const {
    return {xx * xx + xy * xy + xz * xz, xx * xy + xy * yy + xz * yz, xx * xz + xy * yz + xz * zz,
            xy * xy + yy * yy + yz * yz, xy * xz + yy * yz + yz * zz, xz * xz + yz * yz + zz * zz};
  }
  /// x of A x = b for a positive definite A.
  ISOSHELL_HD Vector solve(Vector b) const {
    const double a = yy * zz - yz * yz, c = xz * yz - xy * zz, d = xy * yz - xz * yy, e = xx * zz - xz * xz,
                 f = xy * xz - xx * yz, g = xx * yy - xy * xy;
    return 1 / (xx * a + xy * c + xz * d) *
           Vector{a * b.x + c * b.y + d * b.z, c * b.x + e * b.y + f * b.z, d * b.x + f * b.y + g * b.z};
  }
};

/// Sum of n n^T over the triangles around a vertex.
struct PlanesAround {
  Symmetric sum;
  ISOSHELL_HD void add(Vector normal) { sum.add(1, unit(normal)); }

  /// A with which A.solve(move) is shortened where it leaves the planes: 1 + hold C^2, C the mean of n n^T. Squared, it
  /// leaves smooth places alone, where normals differ by little, and holds tips, ridges and rims.
  ISOSHELL_HD Symmetric holding(double hold) const {
    const double count = sum.xx + sum.yy + sum.zz;
    if (!(count > 0)) return {1, 0, 0, 1, 0, 1};
    const Symmetric s = sum.squared();
    const double k = hold / (count * count);
    return {1 + k * s.xx, k * s.xy, k * s.xz, 1 + k * s.yy, k * s.yz, 1 + k * s.zz};
  }
};

}  // namespace isoshell::optimize
