// A file that appears whole or not at all.
#pragma once

#include <cstdint>
#include <string>

#include "io/bytes/output_place.h"

namespace isoshell {

/// Written under a temporary name in the same folder; commit() gives it its own, once it is on the disk. Without commit
/// the temporary goes and what stood there stays. "-" is standard output; a device or pipe is written as it is.
/// Throws: unwritable_output, from every member but the destructor.
class OutputFile {
 public:
  /// Refuses a path that exists unless `overwrite`.
  OutputFile(const std::string& path, bool overwrite);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();

  void write(const void* data, int64_t bytes);
  void write(const std::string& text) { write(text.data(), int64_t(text.size())); }
  /// Closes, and puts the file in its place.
  void commit();

 private:
  void open_temporary();
  /// 0 and 1 are numbers of files, too, where the process was started without those streams.
  bool is_own() const { return !place_.is_stream && file_ >= 0; }

  OutputPlace place_;
  std::string temporary_;
  bool overwrite_;
  int file_ = -1;
};

}  // namespace isoshell
