// Outputs before any work (see isoshell/io/output_files.h).
#include "isoshell/io/output_files.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <map>
#include <set>

#include "io/bytes/output_place.h"
#include "io/bytes/temporary_name.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

/// `also` is what the file that is there is beside.
void check_place(const OutputPlace& place, bool overwrite, const std::string& also) {
  if (place.is_stream) return;
  if (!place.is_replaced_whole()) place.fail("is not a regular file; name another, or - for standard output");
  if (place.is_there() && !overwrite)
    place.fail((also.empty() ? "" : "is " + also + " and ") + std::string("exists already; --force replaces it"));
  if (access(place.folder().c_str(), W_OK | X_OK) != 0)
    place.fail("cannot write in " + place.folder() + ": " + std::strerror(errno));
}

[[noreturn]] void refuse_one_file(const NamedFile& a, const NamedFile& b, const char* why) {
  throw Error(ErrorCode::usage, "write",
              a.what + " " + a.path + " and " + b.what + " " + b.path + " are one file, which is named twice; " + why);
}

}  // namespace

void check_output_files(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs, bool overwrite,
                        bool keeps_leftovers) {
  std::map<FileId, const NamedFile*> read, written;
  for (const NamedFile& input : inputs)
    if (const std::optional<FileId> id = input_id(input.path)) read.emplace(*id, &input);
  std::set<std::string> folders;
  for (const NamedFile& output : outputs) {
    if (output.path.empty()) continue;
    const OutputPlace place = output_place(output.path);
    const auto same = place.id ? read.find(*place.id) : read.end();
    const bool is_replaced = same != read.end() && output.replaces == same->second->what && !place.is_stream;
    check_place(place, overwrite, is_replaced ? output.replaces : "");
    if (!place.is_stream) folders.insert(place.folder());
    if (!place.id) continue;
    if (const auto other = written.emplace(*place.id, &output); !other.second)
      refuse_one_file(*other.first->second, output, "every result needs its own");
    if (same != read.end() && !is_replaced) refuse_one_file(output, *same->second, "a result needs its own");
  }
  if (keeps_leftovers) return;
  for (const std::string& folder : folders) remove_leftovers(folder);
}

}  // namespace isoshell
