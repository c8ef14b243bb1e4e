// How far the reading of labels is.
#pragma once

#include "core/watched.h"

namespace isoshell {

// What is done when a step ends, by the time that they take.
constexpr double kIslandsAbsorbed = 0.1, kWallsFound = 0.3, kCurvesLed = 0.45, kUnbent = 0.65, kFaired = 0.75;

/// To be called from the thread that reads. Throws: interrupted.
inline void tell_read(const Context& context, double done) {
  check_cancel(context, "read");
  if (context.progress) context.progress("read", done);
}

}  // namespace isoshell
