// Files that are written beside meshes and volumes, and what all outputs must be before any work begins.
#pragma once

#include <string>
#include <vector>

namespace isoshell {

/// A file as a person named it.
struct NamedFile {
  std::string what;  ///< "OUTPUT", "--stats"
  std::string path;  ///< "-" is a standard stream; empty: there is none
  /// Of an output: which input may be the same file, where outputs may replace files. That one is read whole before.
  std::string replaces = {};
};

constexpr const char* kInput = "INPUT";

/// Every output can be written and is there only if it may be replaced; no two of them are one file, and none is an
/// input that it does not replace, whatever links their paths go through. Temporary files that killed processes of this
/// host have left in the folders of the outputs are removed, unless `keeps_leftovers`: for a folder of many frames that
/// takes long. Throws: unwritable_output; usage for a file that is named twice.
void check_output_files(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs, bool overwrite,
                        bool keeps_leftovers = false);

/// A file of this text, which appears whole or not at all and is on the disk then; "-" is standard output. Throws:
/// unwritable_output, also when it exists and is not to be replaced.
void write_text(const std::string& path, const std::string& text, bool overwrite);

/// Gives a finished file of the same file system its name, in one step, once it is on the disk, and the permissions of
/// the file that it replaces. Throws: as write_text(); `finished` stays then.
void put_in_place(const std::string& finished, const std::string& path, bool overwrite);

}  // namespace isoshell
