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

/// How far a call is.
struct Progress {
  const char* stage = "";     ///< that goes on: a step of the call; the name lives as long as the program
  double fraction = 0;        ///< of the whole call that is done: from 0 to 1, it never goes back
  double stage_fraction = 0;  ///< of that stage, likewise
  double seconds_left = 0;    ///< about
};

/// Called a few times a second by a thread of its own, and by the one that works; one call at a time. Must not throw.
using TellProgress = std::function<void(const Progress&)>;

}  // namespace isoshell
