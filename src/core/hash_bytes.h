// A 64-bit hash of bytes, for digests and checksums; not against an adversary.
#pragma once

#include <cstdint>

namespace isoshell {

/// Hash of 8-byte words in fixed chunks, so that threads cannot matter.
uint64_t hash_bytes(const void* data, int64_t size_bytes);

}  // namespace isoshell
