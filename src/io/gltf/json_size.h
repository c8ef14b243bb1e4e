// What is looked at before JSON is parsed, since its parser minds neither.
#pragma once

#include "isoshell/advanced/buffer.h"

namespace isoshell {

struct JsonSize {
  int depth = 0;      ///< the most of lists and objects in each other
  int64_t bytes = 0;  ///< that its values take in memory, or more
};

/// No further than to a depth of one more than `most_depth`.
JsonSize json_size_of(View<const char> text, int most_depth);

}  // namespace isoshell
