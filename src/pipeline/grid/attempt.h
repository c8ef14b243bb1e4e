// What a run tries is a value: it is made, or there is a reason why not.
#pragma once

#include <string>

#include "isoshell/error.h"

namespace isoshell {

/// Runs work that has another way after it. Result: why it cannot be done, said by the work, or by the stage that has
/// no room for it; empty where it is done. Throws: all other errors, which no other way avoids.
template <class Work>
std::string failure_reason(Work work) {
  try {
    return work();
  } catch (const NoRoom& error) {
    return error.what();
  }
}

}  // namespace isoshell
