// Where an output goes, and how a finished file gets there.
#pragma once

#include <sys/stat.h>

#include <optional>
#include <string>
#include <tuple>

namespace isoshell {

/// A file that is there by its device and inode, one that is not by those of its folder and its name.
using FileId = std::tuple<dev_t, ino_t, std::string>;

struct OutputPlace {
  std::string name;    ///< as messages call it
  std::string target;  ///< the path, of a file that is there without symbolic links
  bool is_stream = false;
  std::optional<mode_t> mode;  ///< of what is there
  std::optional<FileId> id;    ///< none of a stream that is no file

  bool is_there() const { return mode.has_value(); }
  /// Written under another name first.
  bool is_replaced_whole() const { return !is_stream && (!mode || S_ISREG(*mode)); }
  std::string folder() const;
  [[noreturn]] void fail(const std::string& what) const;  ///< throws unwritable_output: "name: what"
};

/// "-" is standard output. Throws: unwritable_output for what no file can be made of: an empty name, a NUL in it, one
/// that is too long, a folder, a link to nothing, a folder that is not there, a closed stream.
OutputPlace output_place(const std::string& path);

/// The file that an input is; none where there is no such file.
std::optional<FileId> input_id(const std::string& path);

/// In one step; 0, or the error number: EEXIST for a place that is taken and not to be overwritten.
int rename_to(const std::string& from, const std::string& to, bool overwrite);

/// The same without overwriting, for file systems that cannot rename so. A second name refuses a place that is taken,
/// as on NFS. Where files have one name only, as on FUSE and 9p, the place is looked at first, in a step of its own.
int rename_by_link(const std::string& from, const std::string& to);

/// Waits until the contents of an open file, or the names in a folder, are on the disk. Returns 0, or the error number;
/// a file system that knows no disk is none.
int bring_to_disk(int file);
int bring_folder_to_disk(const std::string& folder);

}  // namespace isoshell
