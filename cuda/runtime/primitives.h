// CUB's algorithms behind plain functions, so that they are compiled once. All run in the stream's order and return at
// once.
#pragma once

#include "cuda/runtime/device_stream.h"
#include "isoshell/buffer.h"

namespace isoshell {

void exclusive_scan_async(DeviceStream& stream, View<int64_t> values);
void exclusive_scan_async(DeviceStream& stream, View<uint32_t> values);
void inclusive_scan_async(DeviceStream& stream, View<int64_t> values);
void inclusive_scan_async(DeviceStream& stream, View<uint32_t> values);

/// Ascending; looks at the lowest `bits` bits only.
void sort_keys_async(DeviceStream& stream, View<uint64_t> keys, int bits = 64);

/// words[w]: bit l set when element 32 w + l is kept. Writes the kept numbers in ascending order; `rank` is scratch of
/// one word more than `words`, whose last becomes the number of them.
void rank_kept_async(DeviceStream& stream, View<const uint32_t> words, View<uint32_t> rank);
void list_kept_async(DeviceStream& stream, View<const uint32_t> words, View<const uint32_t> rank, View<uint32_t> out);

}  // namespace isoshell
