// Counter-based randomness: value = f(seed, index), no state anywhere.
#pragma once

#include <cstdint>

#include "isoshell/advanced/host_device.h"

namespace isoshell {

/// 64 well-mixed bits from (seed, index): two rounds of the SplitMix64 finaliser.
ISOSHELL_HD inline uint64_t mix64(uint64_t x) {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9ull;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}
ISOSHELL_HD inline uint64_t random_bits(uint64_t seed, uint64_t index) {
  return mix64(mix64(seed + 0x9e3779b97f4a7c15ull) + (index + 1) * 0x9e3779b97f4a7c15ull);
}

}  // namespace isoshell
