// A run for tests that is soon done, and what its caller is told.
#pragma once

#include <string>
#include <vector>

#include "isoshell/run/run.h"
#include "support/shapes.h"

namespace isoshell {

inline TriangleSoup ball() { return shapes::sphere({1, 2, 3}, 5, 48); }

inline RunRequest small_run() {
  RemeshOptions options;
  options.vertices = 300;
  options.resolution = 48;
  RunRequest request;
  request.options = requested_options(options);
  return request;
}

/// What a request tells its caller from now on.
struct Heard {
  std::vector<std::string> warnings, notes;
  std::vector<Progress> progress;

  explicit Heard(RunRequest& request) {
    request.tell = [this](MessageKind kind, const std::string& text) {
      (kind == MessageKind::warning ? warnings : notes).push_back(text);
    };
    request.progress = [this](const Progress& p) { progress.push_back(p); };
  }
  Heard(const Heard&) = delete;
};

}  // namespace isoshell
