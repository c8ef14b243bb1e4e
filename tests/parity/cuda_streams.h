// Copies between the streams of two contexts, while the first one is at work.
#pragma once

#include <cstdint>

#include "isoshell/backend.h"

namespace isoshell::parity {

/// Fills `count` numbers again and again in the stream of `from`, copies them to the memory of `to` while that goes on,
/// and has `from` fill and free them at once. Returns how many numbers of the copy are not what `from` had enqueued
/// before the copy was asked for.
int64_t wrong_in_copy(Context& from, Context& to, int64_t count);

}  // namespace isoshell::parity
