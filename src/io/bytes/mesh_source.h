// The bytes of a mesh file, and how a reader refuses them.
#pragma once

#include <string>
#include <vector>

#include "isoshell/advanced/buffer.h"

namespace isoshell {

/// The bytes of one file: memory-mapped, or read to the end where that is not possible ("-", pipes).
class MeshSource {
 public:
  /// Throws: unreadable_input when the file cannot be opened or read.
  explicit MeshSource(const std::string& path);
  /// Bytes that are in memory already; `data` must outlive the source.
  MeshSource(std::string name, View<const char> data) : name_(std::move(name)), data_(data) {}
  MeshSource(const MeshSource&) = delete;
  MeshSource& operator=(const MeshSource&) = delete;
  ~MeshSource();

  const std::string& name() const { return name_; }
  const char* begin() const { return data_.data; }
  const char* end() const { return data_.data + data_.size; }
  int64_t size() const { return data_.size; }

  /// Throw unreadable_input: "name: what", "name, line 7: what", "name, byte 7: what". Lines count from 1.
  [[noreturn]] void refuse(const std::string& what) const;
  [[noreturn]] void refuse_line_at(int64_t offset, const std::string& what) const;
  [[noreturn]] void refuse_byte(int64_t offset, const std::string& what) const;
  /// Throws nothing_to_mesh: "name: what".
  [[noreturn]] void nothing_to_mesh(const std::string& what) const;

 private:
  void read_all(int file);

  std::string name_;
  View<const char> data_;
  void* mapped_ = nullptr;
  std::vector<char> owned_;
};

/// What is wrong where "a face", say, names a vertex that is none of the file's.
std::string no_such_vertex(const std::string& who, const std::string& index, int64_t count);

}  // namespace isoshell
