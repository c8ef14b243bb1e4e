// The bytes of a mesh file, how a reader refuses them, and how it counts the memory that it takes.
#pragma once

#include <algorithm>
#include <memory>
#include <string>

#include "io/bytes/reading_budget.h"
#include "isoshell/advanced/buffer.h"

namespace isoshell {

/// The bytes of one file, read to the end when it is made: what becomes of the file afterwards does not matter.
class MeshSource {
 public:
  /// `path` "-" is standard input. The budget outlives the source. Throws: unreadable_input when the file cannot be
  /// opened or read, or ends before the size that it had when it was opened; out_of_memory.
  MeshSource(const std::string& path, ReadingBudget& budget);
  /// Bytes that are in memory already, read without a limit; `data` must outlive the source.
  MeshSource(std::string name, View<const char> data);
  MeshSource(const MeshSource&) = delete;
  MeshSource& operator=(const MeshSource&) = delete;
  ~MeshSource();

  const std::string& name() const { return name_; }
  const char* begin() const { return data_.data; }
  const char* end() const { return data_.data + data_.size; }
  int64_t size() const { return data_.size; }

  ReadingBudget& budget() const { return budget_; }
  /// Counts memory before a reader takes it. Throws: out_of_memory.
  void take(int64_t bytes) const { budget_.take(bytes, name_); }

  /// Throw unreadable_input: "name: what", "name, line 7: what", "name, byte 7: what". Lines count from 1.
  [[noreturn]] void refuse(const std::string& what) const;
  [[noreturn]] void refuse_line_at(int64_t offset, const std::string& what) const;
  [[noreturn]] void refuse_byte(int64_t offset, const std::string& what) const;
  /// Throws nothing_to_mesh: "name: what".
  [[noreturn]] void nothing_to_mesh(const std::string& what) const;

 private:
  struct Free {
    void operator()(char* bytes) const noexcept;
  };

  void read_file(int file, int64_t bytes);
  void read_stream(int file);

  std::string name_;
  ReadingBudget& budget_;
  View<const char> data_;
  std::unique_ptr<char, Free> owned_;
  int64_t counted_bytes_ = 0;  ///< of the budget, for `owned_`
};

/// Counts bytes for as long as it lives. Throws: out_of_memory.
class HeldBytes {
 public:
  HeldBytes(const MeshSource& source, int64_t bytes) : budget_(source.budget()), bytes_(bytes) { source.take(bytes); }
  HeldBytes(const HeldBytes&) = delete;
  HeldBytes& operator=(const HeldBytes&) = delete;
  ~HeldBytes() { budget_.give_back(bytes_); }

 private:
  ReadingBudget& budget_;
  int64_t bytes_;
};

/// Room for `more` elements behind those of a std::vector, counted before it is there. It stays counted when the vector
/// goes: what is short-lived and large gives it back.
template <class Vector>
void make_room(const MeshSource& source, Vector& elements, size_t more) {
  const size_t had = elements.capacity();
  if (had - elements.size() >= more) return;
  const size_t room = std::max(2 * had, elements.size() + more);
  source.take(int64_t(room * sizeof elements[0]));
  elements.reserve(room);
  source.budget().give_back(int64_t(had * sizeof elements[0]));
}

/// Elements up to a size, those that are new equal to the values.
template <class Vector, class... Value>
void resize_counted(const MeshSource& source, Vector& elements, size_t size, const Value&... value) {
  if (size > elements.size()) make_room(source, elements, size - elements.size());
  elements.resize(size, value...);
}

/// A vector of elements that is gone at once, so that nothing of it stays counted.
template <class Vector>
void release(const MeshSource& source, Vector& elements) {
  source.budget().give_back(int64_t(elements.capacity() * sizeof elements[0]));
  Vector().swap(elements);
}

/// What is wrong where "a face", say, names a vertex that is none of the file's.
std::string no_such_vertex(const std::string& who, const std::string& index, int64_t count);

}  // namespace isoshell
