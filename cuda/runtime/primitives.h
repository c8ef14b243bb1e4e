// What is compiled once: a sort of CUB's, and kernels without a step of a stage. All run in the stream's order and
// return at once.
#pragma once

#include "cuda/runtime/device_stream.h"
#include "isoshell/advanced/buffer.h"

namespace isoshell {

/// In place. The last place, whatever it holds, gets the sum of the others.
void exclusive_scan_async(DeviceStream& stream, View<int64_t> values);

/// Ascending; looks at the lowest `bits` bits only.
void sort_keys_async(DeviceStream& stream, View<uint64_t> keys, int bits = 64);

/// words[w]: bit l set when element 32 w + l is kept; rank[w]: how many are kept before it. Writes the numbers of those
/// that are kept, ascending.
void list_kept_async(DeviceStream& stream, View<const uint32_t> words, View<const uint32_t> rank, View<uint32_t> out);

}  // namespace isoshell
