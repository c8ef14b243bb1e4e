// Signs of determinants: by doubles with a bound of their error, and where that is too wide by sums without error.
#include "measure/exact_signs.h"

#include <array>
#include <cmath>

namespace isoshell {
namespace {

/// A sum of doubles as parts that do not overlap, the smallest first: each addition carries its rounding error along.
class ExactSum {
 public:
  void add(double value) {
    int kept = 0;
    for (int i = 0; i < count_; ++i) {
      const double sum = value + part_[size_t(i)], of_part = sum - value;
      const double error = (value - (sum - of_part)) + (part_[size_t(i)] - of_part);
      if (error != 0) part_[size_t(kept++)] = error;
      value = sum;
    }
    if (value != 0) part_[size_t(kept++)] = value;
    count_ = kept;
  }
  void add_product(double a, double b) {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }
  void add_product(double a, double b, double c) {
    const double product = a * b;
    add_product(std::fma(a, b, -product), c);
    add_product(product, c);
  }
  int sign() const { return count_ == 0 ? 0 : part_[size_t(count_ - 1)] > 0 ? 1 : -1; }

 private:
  // A determinant of three rows is 6 products of three differences, each of two doubles: 4 terms of 8 combinations.
  std::array<double, 192> part_;
  int count_ = 0;
};

/// a - b without error: the rounded difference and what it lacks.
std::array<double, 2> exact_difference(double a, double b) {
  const double rounded = a - b, of_b = a - rounded;
  return {rounded, (a - (rounded + of_b)) + (of_b - b)};
}

using Row = std::array<std::array<double, 2>, 3>;

Row exact_row(const WorldPoint& p, const WorldPoint& origin) {
  return {exact_difference(p.x, origin.x), exact_difference(p.y, origin.y), exact_difference(p.z, origin.z)};
}

int exact_side(const Row& u, const Row& v, const Row& w) {
  ExactSum sum;
  const auto add = [&](double sign, size_t i, size_t j, size_t k) {
    for (const double a : u[i])
      for (const double b : v[j])
        for (const double c : w[k])
          if (a != 0 && b != 0 && c != 0) sum.add_product(sign * a, b, c);
  };
  for (size_t i = 0; i < 3; ++i) {
    add(1, i, (i + 1) % 3, (i + 2) % 3);
    add(-1, i, (i + 2) % 3, (i + 1) % 3);
  }
  return sum.sign();
}

constexpr double kSideError = 8e-16,
                 kTurnError = 4e-16;  ///< of the sum of all products' sizes; more than rounding does

}  // namespace

int side_of_plane(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c, const WorldPoint& d) {
  const double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z, vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z,
               wx = d.x - a.x, wy = d.y - a.y, wz = d.z - a.z;
  const double yz = uy * vz, zy = uz * vy, zx = uz * vx, xz = ux * vz, xy = ux * vy, yx = uy * vx;
  const double volume = (yz - zy) * wx + (zx - xz) * wy + (xy - yx) * wz;
  const double size = (std::abs(yz) + std::abs(zy)) * std::abs(wx) + (std::abs(zx) + std::abs(xz)) * std::abs(wy) +
                      (std::abs(xy) + std::abs(yx)) * std::abs(wz);
  if (volume > kSideError * size) return 1;
  if (volume < -kSideError * size) return -1;
  return exact_side(exact_row(b, a), exact_row(c, a), exact_row(d, a));
}

int turn(const WorldPoint2& a, const WorldPoint2& b, const WorldPoint2& c) {
  const double left = (b.x - a.x) * (c.y - a.y), right = (b.y - a.y) * (c.x - a.x);
  const double area = left - right, size = std::abs(left) + std::abs(right);
  if (area > kTurnError * size) return 1;
  if (area < -kTurnError * size) return -1;
  ExactSum sum;
  const auto add = [&](double sign, const std::array<double, 2>& u, const std::array<double, 2>& v) {
    for (const double p : u)
      for (const double q : v) sum.add_product(sign * p, q);
  };
  add(1, exact_difference(b.x, a.x), exact_difference(c.y, a.y));
  add(-1, exact_difference(b.y, a.y), exact_difference(c.x, a.x));
  return sum.sign();
}

}  // namespace isoshell
