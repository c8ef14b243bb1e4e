// Operations whose bits tell whether a compiler kept to IEEE 754: fused multiply-add, reassociation, flushed
// denormals, approximate division or square root, and mathematics that forgets NaN, infinity and the sign of zero all
// change at least one. canary_table.py makes the operands and the expected bits with rational numbers.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "isoshell/advanced/buffer.h"
#include "parity/executor_operations.h"

namespace isoshell::parity {

template <class To, class From>
ISOSHELL_HD To bits_as(From from) {
  static_assert(sizeof(To) == sizeof(From));
  To to;
  memcpy(&to, &from, sizeof to);
  return to;
}

/// Operations 0 to 15, the same list for double and float.
template <class Real>
ISOSHELL_HD Real canary_value(uint32_t operation, Real a, Real b, Real c) {
  switch (operation) {
    case 0:
      return a * b + c;
    case 1:
      return a * b - c;
    case 2:
      return c - a * b;
    case 3:
      return a * a + b * b + c * c;
    case 4:
      return a + b + c;
    case 5:
      return a + (b + c);
    case 6:
      return a / b;
    case 7:
      return std::sqrt(a);
    case 8:
      return Real(1) / std::sqrt(a);
    case 9:
      return a / Real(3);
    case 10:
      return a * b;
    case 11:
      return a + Real(0);
    case 12:
      return a * b / b;
    case 13:
      return (a + b) - a;
    case 14:
      return std::floor(a * b);
    default:
      return a != a || !(a - a == Real(0)) ? Real(1) : Real(0);
  }
}

/// Operations below 100 are of doubles, those from 100 of floats, those from 200 convert.
ISOSHELL_HD inline uint64_t canary_bits(const CanaryOperands& o) {
  if (o.operation < 100)
    return bits_as<uint64_t>(
        canary_value(o.operation, bits_as<double>(o.a), bits_as<double>(o.b), bits_as<double>(o.c)));
  if (o.operation < 200)
    return bits_as<uint32_t>(canary_value(o.operation - 100, bits_as<float>(uint32_t(o.a)),
                                          bits_as<float>(uint32_t(o.b)), bits_as<float>(uint32_t(o.c))));
  switch (o.operation) {
    case 200:
      return bits_as<uint32_t>(float(bits_as<double>(o.a)));
    case 201:
      return bits_as<uint64_t>(double(bits_as<float>(uint32_t(o.a))));
    case 202:
      return bits_as<uint64_t>(double(int64_t(o.a)));
    default:
      return uint64_t(int64_t(bits_as<double>(o.a)));
  }
}

struct CanaryStep {
  View<const CanaryOperands> operands;
  View<uint64_t> out;
  ISOSHELL_HD void operator()(int64_t i) const { out[i] = canary_bits(operands[i]); }
};

struct CanaryCase {
  CanaryOperands operands;
  uint64_t expected;
};

}  // namespace isoshell::parity
