// The exception of the public face. Its code maps one to one to an exit status of the command.
#pragma once

#include <stdexcept>
#include <string>

namespace isoshell {

/// What went wrong, as the command's exit status says it.
enum class ErrorCode {
  internal = 1,
  usage = 2,
  unreadable_input = 3,
  unwritable_output = 4,
  nothing_to_mesh = 5,
  gate_failed = 6,
  out_of_memory = 7,
  no_device = 8,
  interrupted = 130,
};

/// Thrown by every public function. The message names the value, the limit and the remedy.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, std::string stage, const std::string& message)
      : std::runtime_error(message), code_(code), stage_(std::move(stage)) {}
  ErrorCode code() const { return code_; }
  const std::string& stage() const { return stage_; }

 private:
  ErrorCode code_;
  std::string stage_;
};

/// Of code `usage`: what is asked has no room on this surface, on this grid or in this memory, though nothing is wrong
/// with how it was asked. A run that knows another way tries that.
class NoRoom : public Error {
 public:
  NoRoom(std::string stage, const std::string& message) : Error(ErrorCode::usage, std::move(stage), message) {}
};

}  // namespace isoshell
