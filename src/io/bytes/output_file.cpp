// A file that appears whole or not at all.
#include "io/bytes/output_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "io/bytes/temporary_name.h"
#include "isoshell/error.h"
#include "isoshell/io/output_files.h"

namespace isoshell {
namespace {

constexpr const char* kUntouched = "; what stood there is untouched";

void refuse_taken(const OutputPlace& place) {
  place.fail("exists already; ask for it to be replaced, or choose another name");
}

void refuse_write(const OutputPlace& place, int reason) {
  place.fail(std::string("cannot be written: ") + std::strerror(reason) +
             (place.is_replaced_whole() ? kUntouched : ""));
}

/// That of the file which it replaces, as far as the system lets it.
void take_mode(int file, const OutputPlace& place) {
  if (place.mode) (void)!fchmod(file, *place.mode & 07777);
}

/// Of a file that is on the disk already.
void give_name(const std::string& finished, const OutputPlace& place, bool overwrite) {
  const int failed = rename_to(finished, place.target, overwrite);
  if (failed == EEXIST && !overwrite) refuse_taken(place);
  if (failed) place.fail(std::string("cannot be put in place: ") + std::strerror(failed) + kUntouched);
}

void bring_name_to_disk(const OutputPlace& place) {
  if (const int failed = bring_folder_to_disk(place.folder()))
    place.fail(std::string("its folder cannot be brought to the disk: ") + std::strerror(failed));
}

}  // namespace

OutputFile::OutputFile(const std::string& path, bool overwrite) : place_(output_place(path)), overwrite_(overwrite) {
  if (place_.is_stream) {
    file_ = STDOUT_FILENO;
  } else if (!place_.is_replaced_whole()) {
    file_ = open(place_.target.c_str(), O_WRONLY | O_CLOEXEC);
    if (file_ < 0) place_.fail(std::string("cannot be opened: ") + std::strerror(errno));
  } else {
    if (place_.is_there() && !overwrite) refuse_taken(place_);
    open_temporary();
    take_mode(file_, place_);
  }
}

OutputFile::~OutputFile() {
  if (is_own()) close(file_);
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

void OutputFile::open_temporary() {
  do {
    temporary_ = place_.folder() + "/" + next_temporary_name();
    file_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (file_ < 0 && errno == EEXIST);
  if (file_ >= 0) {
    (void)!flock(file_, LOCK_EX | LOCK_NB);  // remove_leftovers() asks for it
    return;
  }
  const int reason = errno;
  temporary_.clear();
  place_.fail(std::string("cannot be made in its folder: ") + std::strerror(reason));
}

void OutputFile::write(const void* data, int64_t bytes) {
  constexpr int64_t kLargestWrite = int64_t(1) << 30;
  for (const char* p = static_cast<const char*>(data); bytes > 0;) {
    const ssize_t done = ::write(file_, p, size_t(std::min(bytes, kLargestWrite)));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) refuse_write(place_, errno);
    p += done;
    bytes -= done;
  }
}

void OutputFile::commit() {
  if (!temporary_.empty())
    if (const int failed = bring_to_disk(file_)) refuse_write(place_, failed);
  if (is_own() && close(std::exchange(file_, -1)) != 0) refuse_write(place_, errno);
  if (temporary_.empty()) return;
  give_name(temporary_, place_, overwrite_);
  temporary_.clear();
  bring_name_to_disk(place_);
}

void write_text(const std::string& path, const std::string& text, bool overwrite) {
  OutputFile file(path, overwrite);
  file.write(text);
  file.commit();
}

void put_in_place(const std::string& finished, const std::string& path, bool overwrite) {
  const OutputPlace place = output_place(path);
  if (!place.is_replaced_whole()) place.fail("is not a regular file; name another");
  if (place.is_there() && !overwrite) refuse_taken(place);
  const int file = open(finished.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) refuse_write(place, errno);
  take_mode(file, place);
  const int failed = bring_to_disk(file);
  close(file);
  if (failed) refuse_write(place, failed);
  give_name(finished, place, overwrite);
  bring_name_to_disk(place);
}

}  // namespace isoshell
