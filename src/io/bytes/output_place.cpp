// See output_place.h.
#include "io/bytes/output_place.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "isoshell/error.h"

namespace isoshell {
namespace {

std::string folder_of(const std::string& path) {
  const size_t slash = path.rfind('/');
  return slash == std::string::npos ? "." : path.substr(0, slash == 0 ? 1 : slash);
}

std::string linked_from(const std::string& path) {
  std::string text(4096, '\0');
  const ssize_t size = readlink(path.c_str(), text.data(), text.size());
  return text.substr(0, size_t(size > 0 ? size : 0));
}

std::optional<FileId> id_of_stream(int stream) {
  struct stat info;
  if (fstat(stream, &info) != 0 || !S_ISREG(info.st_mode)) return {};
  return FileId{info.st_dev, info.st_ino, ""};
}

OutputPlace standard_output() {
  OutputPlace place;
  place.name = "standard output";
  place.is_stream = true;
  const int flags = fcntl(STDOUT_FILENO, F_GETFL);
  if (flags < 0 || (flags & O_ACCMODE) == O_RDONLY) place.fail("is closed; open it, or name a file");
  place.id = id_of_stream(STDOUT_FILENO);
  return place;
}

void find_what_is_there(const struct stat& info, OutputPlace& place) {
  if (S_ISDIR(info.st_mode)) place.fail("is a folder; name a file in it");
  place.mode = info.st_mode;
  place.id = FileId{info.st_dev, info.st_ino, ""};
  if (char* const resolved = realpath(place.name.c_str(), nullptr)) {
    place.target = resolved;
    std::free(resolved);
  }
}

void find_folder(OutputPlace& place) {
  struct stat info;
  if (lstat(place.name.c_str(), &info) == 0)
    place.fail("is a link to " + linked_from(place.name) + ", which is not there; name that file, or remove the link");
  const std::string folder = folder_of(place.name);
  if (stat(folder.c_str(), &info) != 0 || !S_ISDIR(info.st_mode)) place.fail("there is no folder " + folder);
  const std::string last = place.name.substr(place.name.rfind('/') + 1);
  if (last.empty()) place.fail("is the name of a folder; name a file");
  place.id = FileId{info.st_dev, info.st_ino, last};
}

int plain_rename(const std::string& from, const std::string& to) {
  return std::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

/// Whether the system or the file system does not have what was asked for.
bool is_unknown_here(int error) { return error == EINVAL || error == ENOSYS || error == EPERM || error == ENOTSUP; }

}  // namespace

std::string OutputPlace::folder() const { return folder_of(target); }

void OutputPlace::fail(const std::string& what) const {
  throw Error(ErrorCode::unwritable_output, "write", name + ": " + what);
}

OutputPlace output_place(const std::string& path) {
  if (path == "-") return standard_output();
  OutputPlace place;
  place.name = place.target = path;
  if (path.empty()) place.fail("the name is empty; name a file");
  if (const size_t end = path.find('\0'); end != std::string::npos) {
    place.name.replace(end, 1, "\\0");
    place.fail("there is a NUL in the name, at which it would end; leave it out");
  }
  struct stat info;
  if (stat(path.c_str(), &info) == 0)
    find_what_is_there(info, place);
  else if (errno == ENOENT)
    find_folder(place);
  else
    place.fail(std::string("cannot be made: ") + std::strerror(errno) + "; choose another name");
  return place;
}

std::optional<FileId> input_id(const std::string& path) {
  if (path == "-") return id_of_stream(STDIN_FILENO);
  struct stat info;
  if (path.empty() || stat(path.c_str(), &info) != 0) return {};
  return FileId{info.st_dev, info.st_ino, ""};
}

int rename_to(const std::string& from, const std::string& to, bool overwrite) {
  if (overwrite) return plain_rename(from, to);
#ifdef RENAME_NOREPLACE
  if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (!is_unknown_here(errno)) return errno;
#endif
  return rename_by_link(from, to);
}

int rename_by_link(const std::string& from, const std::string& to) {
  if (link(from.c_str(), to.c_str()) == 0) {
    (void)unlink(from.c_str());  // the file has its name, whether or not it keeps the other one, too
    return 0;
  }
  if (!is_unknown_here(errno)) return errno;
  struct stat info;
  if (lstat(to.c_str(), &info) == 0) return EEXIST;
  return errno == ENOENT ? plain_rename(from, to) : errno;
}

int bring_to_disk(int file) {
  if (fsync(file) == 0 || errno == EINVAL || errno == ENOSYS || errno == ENOTSUP) return 0;
  return errno;
}

int bring_folder_to_disk(const std::string& folder) {
  const int handle = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (handle < 0) return errno == EACCES ? 0 : errno;  // one may write there and not look
  const int failed = bring_to_disk(handle);
  close(handle);
  return failed;
}

}  // namespace isoshell
