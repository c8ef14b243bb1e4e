// A file that appears whole or not at all.
#include "io/bytes/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "isoshell/error.h"

namespace isoshell {

OutputFile::OutputFile(const std::string& path, bool overwrite) : path_(path), target_(path), overwrite_(overwrite) {
  if (path == "-") {
    path_ = "standard output";
    file_ = STDOUT_FILENO;
    return;
  }
  if (path.empty()) fail("the name is empty; name a file");
  if (char* const resolved = realpath(path.c_str(), nullptr)) {
    target_ = resolved;
    std::free(resolved);
  }
  struct stat info;
  const bool exists = stat(target_.c_str(), &info) == 0;
  if (exists && S_ISDIR(info.st_mode)) fail("is a folder; name a file in it");
  if (exists && !S_ISREG(info.st_mode)) {
    file_ = open(target_.c_str(), O_WRONLY | O_CLOEXEC);
    if (file_ < 0) fail(std::string("cannot be opened: ") + std::strerror(errno));
    return;
  }
  if (exists && !overwrite) fail("exists already; ask for it to be replaced, or choose another name");
  open_temporary();
  if (exists) (void)!fchmod(file_, info.st_mode & 07777);
}

OutputFile::~OutputFile() {
  if (file_ > STDOUT_FILENO) close(file_);
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

void OutputFile::fail(const std::string& what) const {
  throw Error(ErrorCode::unwritable_output, "write", path_ + ": " + what);
}

void OutputFile::open_temporary() {
  static std::atomic<uint32_t> serial{0};
  const size_t slash = target_.rfind('/');
  const std::string folder = slash == std::string::npos ? "" : target_.substr(0, slash + 1);
  do {
    // A name of its own length, so that a target with the longest legal name can be written too.
    temporary_ = folder + ".isoshell-" + std::to_string(getpid()) + "-" + std::to_string(serial++) + ".tmp";
    file_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (file_ < 0 && errno == EEXIST);
  if (file_ >= 0) return;
  const int reason = errno;
  temporary_.clear();
  fail(std::string("cannot be made in its folder: ") + std::strerror(reason));
}

void OutputFile::write(const void* data, int64_t bytes) {
  constexpr int64_t kLargestWrite = int64_t(1) << 30;
  for (const char* p = static_cast<const char*>(data); bytes > 0;) {
    const ssize_t done = ::write(file_, p, size_t(std::min(bytes, kLargestWrite)));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) fail(std::string("cannot be written: ") + std::strerror(errno) + "; what stood there is untouched");
    p += done;
    bytes -= done;
  }
}

void OutputFile::commit() {
  if (file_ > STDOUT_FILENO) {
    const int failed = close(file_);
    file_ = -1;
    if (failed) fail(std::string("cannot be written: ") + std::strerror(errno) + "; what stood there is untouched");
  }
  if (!temporary_.empty()) put_in_place();
}

void OutputFile::put_in_place() {
  int failed;
#ifdef RENAME_NOREPLACE
  failed = renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, target_.c_str(), overwrite_ ? 0 : RENAME_NOREPLACE);
  if (failed && !overwrite_ && (errno == EINVAL || errno == ENOSYS) && access(target_.c_str(), F_OK) != 0)
    failed = std::rename(temporary_.c_str(), target_.c_str());  // a file system that cannot refuse by itself
#else
  failed = !overwrite_ && access(target_.c_str(), F_OK) == 0 ? (errno = EEXIST, -1)
                                                             : std::rename(temporary_.c_str(), target_.c_str());
#endif
  if (failed) fail(std::string("cannot be put in place: ") + std::strerror(errno) + "; what stood there is untouched");
  temporary_.clear();
}

}  // namespace isoshell
