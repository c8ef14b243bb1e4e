// Chunks of 64 KiB are hashed on their own, then their hashes together.
#include "core/hash_bytes.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "core/parallel_ranges.h"
#include "voxel/random.h"

namespace isoshell {
namespace {

uint64_t hash_chunk(const unsigned char* data, int64_t bytes) {
  uint64_t h = mix64(uint64_t(bytes) + 1);
  int64_t i = 0;
  for (; i + 8 <= bytes; i += 8) {
    uint64_t w;
    std::memcpy(&w, data + i, 8);
    h = mix64(h ^ w) + w;
  }
  uint64_t tail = 0;
  if (i < bytes) std::memcpy(&tail, data + i, size_t(bytes - i));
  return mix64(h ^ tail);
}

}  // namespace

uint64_t hash_bytes(const void* data, int64_t size_bytes) {
  constexpr int64_t kChunk = 1 << 16;
  const auto* bytes = static_cast<const unsigned char*>(data);
  const int64_t chunks = (size_bytes + kChunk - 1) / kChunk;
  std::vector<uint64_t> part(size_t(chunks) + 1);
  for_each_index(int64_t(0), chunks, [&](int64_t c) {
    part[size_t(c)] = hash_chunk(bytes + c * kChunk, std::min(kChunk, size_bytes - c * kChunk));
  });
  part[size_t(chunks)] = uint64_t(size_bytes);
  return hash_chunk(reinterpret_cast<const unsigned char*>(part.data()), int64_t(part.size() * 8));
}

}  // namespace isoshell
