// The bytes of a mesh file, and how a reader refuses them.
#include "io/bytes/mesh_source.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "isoshell/error.h"

namespace isoshell {
namespace {

constexpr const char* kStage = "read_mesh";

struct FileHandle {
  int number;
  ~FileHandle() {
    if (number > 0) close(number);
  }
};

}  // namespace

MeshSource::MeshSource(const std::string& path) : name_(path == "-" ? "standard input" : path) {
  if (path == "-") {
    read_all(STDIN_FILENO);
    return;
  }
  const FileHandle file{open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (file.number < 0) refuse(std::string("cannot be opened: ") + std::strerror(errno));
  struct stat info;
  if (fstat(file.number, &info) != 0) refuse(std::string("cannot be examined: ") + std::strerror(errno));
  if (S_ISDIR(info.st_mode)) refuse("is a folder; name a mesh file");
  if (S_ISREG(info.st_mode) && info.st_size == 0) return;
  if (S_ISREG(info.st_mode)) {
    void* mapped = mmap(nullptr, size_t(info.st_size), PROT_READ, MAP_PRIVATE | MAP_POPULATE, file.number, 0);
    if (mapped != MAP_FAILED) {
      mapped_ = mapped;
      data_ = {static_cast<const char*>(mapped), int64_t(info.st_size)};
      return;
    }
  }
  read_all(file.number);
}

MeshSource::~MeshSource() {
  if (mapped_) munmap(mapped_, size_t(data_.size));
}

void MeshSource::read_all(int file) {
  size_t used = 0;
  owned_.resize(1 << 16);
  for (;;) {
    const ssize_t got = read(file, owned_.data() + used, owned_.size() - used);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse(std::string("cannot be read: ") + std::strerror(errno));
    if (got == 0) break;
    used += size_t(got);
    if (used == owned_.size()) owned_.resize(2 * used);
  }
  data_ = {owned_.data(), int64_t(used)};
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
