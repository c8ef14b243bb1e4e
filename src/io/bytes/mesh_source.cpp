// The bytes of a mesh file, and how a reader refuses them.
#include "io/bytes/mesh_source.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <new>

#include "core/parallel_ranges.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

constexpr const char* kStage = "read_mesh";
constexpr int64_t kPieceBytes = int64_t(1) << 22;        // of a file, read by one thread
constexpr int64_t kStreamPieceBytes = int64_t(1) << 16;  // as much as a pipe holds
constexpr int64_t kHugePageBytes = int64_t(1) << 21;

struct FileHandle {
  int number;
  ~FileHandle() {
    if (number >= 0) close(number);
  }
};

ReadingBudget& no_limit() {
  static ReadingBudget budget;
  return budget;
}

/// Memory in large pages, which are there in half the time, where the system has them.
char* allocate_pages(int64_t bytes) {
  const int64_t unit = bytes < kHugePageBytes ? 64 : kHugePageBytes;
  const auto size = size_t((bytes + unit - 1) / unit * unit);
  auto* const data = static_cast<char*>(std::aligned_alloc(size_t(unit), size));
  if (!data) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
  if (unit == kHugePageBytes) (void)madvise(data, size, MADV_HUGEPAGE);  // no more than a hint
#endif
  return data;
}

/// Repeats a call that a signal interrupts.
template <class Read>
ssize_t uninterrupted(Read read) {
  ssize_t got;
  do got = read();
  while (got < 0 && errno == EINTR);
  return got;
}

}  // namespace

void MeshSource::Free::operator()(char* bytes) const noexcept { std::free(bytes); }

MeshSource::MeshSource(std::string name, View<const char> data)
    : name_(std::move(name)), budget_(no_limit()), data_(data) {}

MeshSource::MeshSource(const std::string& path, ReadingBudget& budget)
    : name_(path == "-" ? "standard input" : path), budget_(budget) {
  if (path == "-") {
    read_stream(STDIN_FILENO);
    return;
  }
  const FileHandle file{open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (file.number < 0) refuse(std::string("cannot be opened: ") + std::strerror(errno));
  struct stat info;
  if (fstat(file.number, &info) != 0) refuse(std::string("cannot be examined: ") + std::strerror(errno));
  if (S_ISDIR(info.st_mode)) refuse("is a folder; name a mesh file");
  if (!S_ISREG(info.st_mode))
    read_stream(file.number);
  else if (info.st_size > 0)
    read_file(file.number, int64_t(info.st_size));
}

MeshSource::~MeshSource() { budget_.give_back(counted_bytes_); }

/// In pieces by all threads. A map of the file would be there sooner, but kills the process where the file shrinks.
void MeshSource::read_file(int file, int64_t bytes) {
  take(bytes);
  counted_bytes_ = bytes;
  owned_.reset(allocate_pages(bytes));
  for_each_index(int64_t(0), (bytes + kPieceBytes - 1) / kPieceBytes, [&](int64_t piece) {
    const int64_t end = std::min(bytes, (piece + 1) * kPieceBytes);
    for (int64_t at = piece * kPieceBytes; at < end;) {
      const ssize_t got = uninterrupted([&] { return pread(file, owned_.get() + at, size_t(end - at), off_t(at)); });
      if (got < 0) refuse(std::string("cannot be read: ") + std::strerror(errno));
      if (got == 0)
        refuse("ends at byte " + std::to_string(at) + " of the " + std::to_string(bytes) +
               " that it had when it was opened; read it once it is written");
      at += got;
    }
  });
  data_ = {owned_.get(), bytes};
}

/// What comes is counted, not the room for more: memory that was never written to takes none.
void MeshSource::read_stream(int file) {
  int64_t room = 0, used = 0;
  for (;;) {
    if (room - used < kStreamPieceBytes) {
      room = std::max(2 * room, 16 * kStreamPieceBytes);
      auto* const grown = static_cast<char*>(std::realloc(owned_.get(), size_t(room)));
      if (!grown) throw std::bad_alloc();
      (void)owned_.release();
      owned_.reset(grown);
    }
    if (counted_bytes_ - used < kStreamPieceBytes) {
      take(kStreamPieceBytes);
      counted_bytes_ += kStreamPieceBytes;
    }
    const ssize_t got = uninterrupted([&] { return ::read(file, owned_.get() + used, size_t(kStreamPieceBytes)); });
    if (got < 0) refuse(std::string("cannot be read: ") + std::strerror(errno));
    if (got == 0) break;
    used += got;
  }
  data_ = {owned_.get(), used};
}

void MeshSource::refuse(const std::string& what) const {
  throw Error(ErrorCode::unreadable_input, kStage, name_ + ": " + what);
}

void MeshSource::refuse_line_at(int64_t offset, const std::string& what) const {
  const auto line = 1 + std::count(begin(), begin() + std::min(offset, size()), '\n');
  throw Error(ErrorCode::unreadable_input, kStage, name_ + ", line " + std::to_string(line) + ": " + what);
}

void MeshSource::refuse_byte(int64_t offset, const std::string& what) const {
  throw Error(ErrorCode::unreadable_input, kStage, name_ + ", byte " + std::to_string(offset) + ": " + what);
}

void MeshSource::nothing_to_mesh(const std::string& what) const {
  throw Error(ErrorCode::nothing_to_mesh, kStage, name_ + ": " + what);
}

std::string no_such_vertex(const std::string& who, const std::string& index, int64_t count) {
  return who + " names vertex " + index + "; the file holds vertices 0 to " + std::to_string(count - 1) +
         "; correct the index or restore the missing vertices";
}

}  // namespace isoshell
