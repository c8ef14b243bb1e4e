// What a run says to people while it goes on.
#pragma once

#include <functional>
#include <string>

namespace isoshell {

enum class MessageKind {
  note,     ///< what was read and chosen, for those who want to know
  warning,  ///< what a person should look at
};

/// Called from the calling thread, as it happens. An empty one is not called.
using Tell = std::function<void(MessageKind kind, const std::string& text)>;

}  // namespace isoshell
