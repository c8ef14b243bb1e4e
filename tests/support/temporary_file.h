#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>

namespace isoshell {

/// A file name of its own in the folder for temporary files, removed at the end.
struct TemporaryFile {
  explicit TemporaryFile(const std::string& name)
      : path((std::filesystem::temp_directory_path() / ("isoshell_test_" + std::to_string(::getpid()) + "_" + name))
                 .string()) {}
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
  const std::string path;
};

}  // namespace isoshell
