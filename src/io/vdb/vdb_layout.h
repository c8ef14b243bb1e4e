// Where things lie in a .vdb file, read without OpenVDB: its reader trusts every count and offset in a file, and loops
// or allocates without end when they are wrong. So a file is checked here first.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "isoshell/advanced/buffer.h"

namespace isoshell {

constexpr int64_t kVdbTagBegin = 21;  ///< first byte of the file's unique tag, 36 characters in the form of a UUID
constexpr int64_t kVdbTagBytes = 36;
constexpr int64_t kVdbHeaderBytes = kVdbTagBegin + kVdbTagBytes;

/// One grid in the file. Offsets in bytes from the start of the file.
struct VdbGridSpan {
  std::string name, type;
  bool instance = false;                     ///< shares the tree of another grid
  uint32_t compression = 0;                  ///< OpenVDB's flags
  std::map<std::string, std::string> texts;  ///< its metadata of type string
  int64_t begin = 0;                         ///< of its descriptor
  int64_t content = 0;                       ///< of its compression flags and metadata; the descriptor ends here
  int64_t transform = 0;                     ///< of its transform, which the tree follows
  int64_t end = 0;
};

struct VdbLayout {
  std::string tag;
  bool has_offsets = false;
  std::map<std::string, std::string> texts;  ///< the file's metadata of type string
  std::vector<VdbGridSpan> grids;
};

/// Reads header and file metadata from the first bytes of a file; `grids` stays empty.
/// Throws: unreadable_input when they are not those of a .vdb file of format 222 or newer.
VdbLayout read_vdb_header(const std::string& path, View<const char> bytes);

/// Reads the whole layout. A stream has no offsets: each of its grids ends where a walk through its tree does. Result:
/// the grids follow one another without a gap, the last one ends with the file, and the metadata of each lies inside
/// it. Throws: unreadable_input, also for a stream with a grid that cannot be walked.
VdbLayout read_vdb_layout(const std::string& path, View<const char> bytes);

struct VdbTreeExtent {
  int64_t memory_bytes = 0;  ///< that the tree takes; 0 of an instance, which has none of its own
  int64_t end = 0;           ///< in bytes from the start of the file
};

/// Walks the transform and the tree of a grid without decompressing it: every count, mask and length must be borne out
/// by the bytes up to `grid.end`, so that OpenVDB cannot be led astray by them. Throws: unreadable_input, also for a
/// grid of other values than numbers, masks and vectors of three.
VdbTreeExtent walk_vdb_tree(const std::string& path, View<const char> bytes, const VdbGridSpan& grid);
/// The same of a grid that must end with its tree. Result: bytes that the tree takes in memory.
int64_t check_vdb_tree(const std::string& path, View<const char> bytes, const VdbGridSpan& grid);

/// Checksum of a file's bytes without its tag, in the form of a tag that is recognised as ours.
std::string vdb_checksum_tag(View<const char> bytes);
/// Whether a tag has the form that vdb_checksum_tag gives.
bool is_checksum_tag(const std::string& tag);

/// The first bytes of a regular file, all of them when there are fewer. Throws: unreadable_input.
Buffer<char> read_file_start(const std::string& path, int64_t max_bytes);

}  // namespace isoshell
