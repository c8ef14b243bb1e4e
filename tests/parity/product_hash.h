// A hash of every array of a product, those included that its digest leaves out because the others imply them.
#pragma once

#include <type_traits>
#include <vector>

#include "core/copy_product.h"
#include "core/hash_bytes.h"
#include "voxel/random.h"

namespace isoshell::parity {

/// Elements without padding as they are; samples, which have some, field by field.
template <class T>
uint64_t hash_elements(const Buffer<T>& buffer) {
  return hash_bytes(buffer.data(), buffer.size_bytes());
}
inline uint64_t hash_elements(const Buffer<SiteSample>& buffer) {
  std::vector<int32_t> fields;
  for (const SiteSample& s : buffer)
    fields.insert(fields.end(), {s.dx, s.dy, s.dz, s.normal.x, s.normal.y, s.normal.z, int32_t(s.triangle)});
  return hash_bytes(fields.data(), int64_t(fields.size() * sizeof(int32_t)));
}

/// Of all arrays in their order, wherever they lie.
template <class Product>
uint64_t hash_arrays(const Product& product) {
  uint64_t hash = 0;
  copy_product(product, [&](const auto& buffer) {
    const auto here = buffer.to_host();
    hash = mix64(hash + 0x9e3779b97f4a7c15ull) ^ mix64(hash_elements(here) + uint64_t(here.size()));
    return std::decay_t<decltype(buffer)>();
  });
  return hash;
}

}  // namespace isoshell::parity
