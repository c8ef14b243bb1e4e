#!/usr/bin/env python3
"""Makes tests/parity/canary_table.h: operands, and the bits that IEEE 754 demands, from rational numbers.

For every operation it keeps operands that tell the faults apart: for multiply-and-add only those where the fused result
differs, for sums only those where another order differs, for float square roots and quotients only those that lie near
the middle of two floats.
"""
import math
import random
import struct
from fractions import Fraction

random.seed(3)
INF, NAN = float("inf"), float("nan")


def bits64(x):
    return struct.unpack("<Q", struct.pack("<d", x))[0]


def bits32(x):
    return struct.unpack("<I", struct.pack("<f", x))[0]


def to_float(x):  # one rounding of a double
    return struct.unpack("<f", struct.pack("<f", x))[0]


class Double:
    first, bits, digits = 0, staticmethod(bits64), 53
    round = staticmethod(lambda x: x)
    tiny = 5e-324

    @staticmethod
    def nearest(q):  # Fraction to double: Python rounds correctly
        return q.numerator / q.denominator


class Float:
    first, bits, digits = 100, staticmethod(bits32), 24
    round = staticmethod(to_float)
    tiny = 2.0 ** -149

    @staticmethod
    def nearest(q):
        # Innocuous: the callers' values are results of one operation on floats, or are checked by `exact`.
        return to_float(q.numerator / q.denominator)


def draw(real):
    return real.round(math.ldexp(random.uniform(1, 2), random.randint(-3, 3)) * random.choice((-1, 1)))


rows = []


def add(real, operation, a, b, c, value):
    bits = real.bits
    rows.append((real.first + operation, bits(a), bits(b), bits(c), bits(value)))


def fused_cases(real):
    r = real.round
    for operation, sign_p, sign_c in ((0, 1, 1), (1, 1, -1), (2, -1, 1)):
        kept = 0
        while kept < 3:
            a, b, c = draw(real), draw(real), draw(real)
            fused = real.nearest(sign_p * Fraction(a) * Fraction(b) + sign_c * Fraction(c))
            value = r(sign_p * r(a * b) + sign_c * c)
            if fused != value:
                add(real, operation, a, b, c, value)
                kept += 1
    kept = 0
    while kept < 4:
        a, b, c = draw(real), draw(real), draw(real)
        value = r(r(r(a * a) + r(b * b)) + r(c * c))
        one = real.nearest(Fraction(r(a * a)) + Fraction(b) ** 2)
        if real.nearest(Fraction(one) + Fraction(c) ** 2) != value:
            add(real, 3, a, b, c, value)
            kept += 1


def order_cases(real):
    r = real.round
    kept = 0
    while kept < 3:
        a, b, c = draw(real), draw(real), draw(real)
        left, right = r(r(a + b) + c), r(a + r(b + c))
        if left != right:
            add(real, 4, a, b, c, left)
            add(real, 5, a, b, c, right)
            kept += 1
    kept = 0
    while kept < 2:
        a, b = draw(real) * 1024, draw(real)
        if r(r(a + b) - a) != b:
            add(real, 13, a, b, 0.0, r(r(a + b) - a))
            kept += 1
    kept = 0
    while kept < 2:
        a, b = draw(real), draw(real)
        if r(r(a * b) / b) != a:
            add(real, 12, a, b, 0.0, r(r(a * b) / b))
            kept += 1


def division_cases(real):
    r = real.round
    kept = 0
    while kept < 4:  # one that multiplying by the reciprocal misses
        a, b = draw(real), draw(real)
        if r(a / b) != r(a * r(1 / b)):
            add(real, 6, a, b, 0.0, r(a / b))
            kept += 1
    kept = 0
    while kept < 3:
        a = draw(real)
        if r(a / 3) != r(a * r(1 / 3)):
            add(real, 9, a, 0.0, 0.0, r(a / 3))
            kept += 1
    kept = 0
    while kept < 4:
        a = abs(draw(real))
        root = r(math.sqrt(a))
        ulp = math.ldexp(1.0, math.frexp(root)[1] - real.digits)
        miss = abs((Fraction(a) - Fraction(root) ** 2) / (2 * Fraction(root)) / Fraction(ulp))
        if miss > Fraction(45, 100):
            add(real, 7, a, 0.0, 0.0, root)
            add(real, 8, a, 0.0, 0.0, r(1 / root))
            kept += 1


def edge_cases(real):
    r, tiny = real.round, real.tiny
    add(real, 10, 3 * tiny, 0.5, 0.0, r(3 * tiny * 0.5))  # denormals, ties to even
    add(real, 10, 1000001 * tiny, 0.75, 0.0, r(1000001 * tiny * 0.75))
    add(real, 11, tiny, 0.0, 0.0, tiny)
    add(real, 11, -0.0, 0.0, 0.0, 0.0)
    add(real, 6, 7 * tiny, 2.0, 0.0, r(7 * tiny / 2))
    add(real, 0, tiny, 2.0, tiny, 3 * tiny)
    add(real, 10, -1.0, 0.0, 0.0, -0.0)
    add(real, 7, -0.0, 0.0, 0.0, -0.0)
    add(real, 15, INF, 0.0, 0.0, 1.0)
    add(real, 15, NAN, 0.0, 0.0, 1.0)
    add(real, 15, 1.5, 0.0, 0.0, 0.0)
    add(real, 14, r(-1.25), r(2.5), 0.0, -4.0)
    a = r(3.0) - r(math.ldexp(1.0, 2 - real.digits))  # a * b lies just below 3, or is 3 when it is fused with nothing
    add(real, 14, a, 1.0, 0.0, 2.0)


for real in (Double, Float):
    fused_cases(real)
    order_cases(real)
    division_cases(real)
    edge_cases(real)

for x in (1 / 3, 1e-40, 1 + 2.0 ** -24, 1 + 3 * 2.0 ** -24, 3.4028235677973366e38, -2.0 ** -150, 16777217.0):
    try:
        value = bits32(x)
    except OverflowError:
        value = bits32(INF)
    rows.append((200, bits64(x), 0, 0, value))
for x in (1e-40, 0.1, -3.5):
    rows.append((201, bits32(x), 0, 0, bits64(to_float(x))))
for n in (2 ** 53 + 1, 2 ** 62 + 2 ** 8 + 1, -(2 ** 60) - 129, -1):
    rows.append((202, n % 2 ** 64, 0, 0, bits64(float(n))))
for x in (-2.75, 2.0 ** 52 + 0.5, -(2.0 ** 62), 0.99999):
    rows.append((203, bits64(x), 0, 0, int(x) % 2 ** 64))

print("// Made by canary_table.py: operation, operands, expected bits.")
print("#pragma once\n")
print('#include "parity/canary_cases.h"\n')
print("namespace isoshell::parity {\n")
print("inline constexpr CanaryCase kCanaries[] = {")
for operation, a, b, c, expected in rows:
    print("    {{%d, 0x%x, 0x%x, 0x%x}, 0x%x}," % (operation, a, b, c, expected))
print("};\n")
print("}  // namespace isoshell::parity")
