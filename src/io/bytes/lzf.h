// LZF, the packing of PCD files.
#pragma once

#include "isoshell/advanced/buffer.h"

namespace isoshell {

/// Fills `to` from LZF data. False when the data is damaged or does not fill it exactly.
inline bool unpack_lzf(View<const char> from, View<char> to) {
  int64_t in = 0, out = 0;
  while (in < from.size) {
    const auto control = static_cast<uint8_t>(from[in++]);
    if (control < 32) {  // as many plain bytes and one more
      const int64_t length = control + 1;
      if (length > from.size - in || length > to.size - out) return false;
      for (int64_t i = 0; i < length; ++i) to[out++] = from[in++];
      continue;
    }
    int64_t length = control >> 5;  // bytes that stand earlier, two fewer
    if (length == 7) {
      if (in == from.size) return false;
      length += static_cast<uint8_t>(from[in++]);
    }
    if (in == from.size) return false;
    const int64_t back = int64_t(control & 31) << 8 | static_cast<uint8_t>(from[in++]);
    length += 2;
    if (back + 1 > out || length > to.size - out) return false;
    for (int64_t i = 0; i < length; ++i, ++out) to[out] = to[out - back - 1];
  }
  return out == to.size;
}

}  // namespace isoshell
