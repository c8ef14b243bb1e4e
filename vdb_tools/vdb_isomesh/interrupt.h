// Answers to signals: the run is asked to stop, and stopped where it does not hear in time.
#pragma once

#include <string>

#include "isoshell/backend.h"

namespace isoshell::tool {

/// From now on SIGINT, SIGTERM and SIGHUP cancel the context, which must live as long as the process. A run that has
/// not ended a quarter of a second later, or by the next signal, is ended with status 130, unless a file is being
/// written then.
/// `program` is what the last words begin with.
void answer_signals(Context& context, const std::string& program);

/// While one of these lives, a file is being written: it is finished or removed before the process ends.
class WhileWriting {
 public:
  WhileWriting();
  ~WhileWriting();
  WhileWriting(const WhileWriting&) = delete;
  WhileWriting& operator=(const WhileWriting&) = delete;
};

/// A file is there for good: the last words of a process that is ended name it. Called while a WhileWriting lives.
void note_written(const std::string& path);

}  // namespace isoshell::tool
