// Bounded reading of a .vdb file's header, metadata and grid descriptors.
#include "io/vdb/vdb_layout.h"

#include <cstdio>

#include "core/hash_bytes.h"
#include "io/vdb/vdb_cursor.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

constexpr int64_t kMagic = 0x56444220;
constexpr uint32_t kOldestFormat = 222;          // from here on the header ends with the tag
constexpr char kTagStart[] = "69736f73-6865-8";  // "isoshe" in ASCII, then the version digit of a custom UUID

std::map<std::string, std::string> read_metadata(VdbCursor& in) {
  std::map<std::string, std::string> texts;
  const uint32_t count = in.value<uint32_t>("count of metadata");
  for (uint32_t i = 0; i < count; ++i) {
    const std::string name = in.text("name of metadata"), type = in.text("type of metadata");
    const std::string content = in.text("value of metadata");
    if (type == "string") texts[name] = content;
  }
  return texts;
}

/// Where a file says that a grid ends, which is held against its other offsets and the bytes that there are.
int64_t end_by_offsets(const std::string& path, VdbCursor in, const VdbGridSpan& grid, int64_t bytes) {
  const int64_t content = in.value<int64_t>("offset of a grid"),
                blocks = in.value<int64_t>("offset of a grid's blocks"), end = in.value<int64_t>("end of a grid");
  if (content != grid.content || end < content || (!grid.instance && (blocks < content || blocks > end)))
    throw_unreadable_vdb(path, "grid \"" + grid.name + "\" has offsets " + std::to_string(content) + ", " +
                                   std::to_string(blocks) + ", " + std::to_string(end) + " where the first must be " +
                                   std::to_string(grid.content) + " and they must rise: the file is damaged");
  if (end > bytes)
    throw_unreadable_vdb(path, "grid \"" + grid.name + "\" ends at byte " + std::to_string(end) + " of " +
                                   std::to_string(bytes) + ": the file is truncated");
  return end;
}

VdbGridSpan read_grid_span(const std::string& path, View<const char> bytes, int64_t begin, bool has_offsets) {
  constexpr int64_t kOffsetBytes = 3 * 8;  // a stream has them as well, without a meaning
  VdbCursor in(path, bytes, begin);
  VdbGridSpan grid;
  grid.begin = begin;
  grid.name = in.text("name of a grid");
  grid.type = in.text("type of a grid");
  grid.instance = !in.text("parent of a grid").empty();
  const VdbCursor offsets = in;
  in.take(kOffsetBytes, "offsets of a grid");
  grid.content = in.at();
  grid.end = has_offsets ? end_by_offsets(path, offsets, grid, bytes.size) : bytes.size;
  VdbCursor inside(path, {bytes.data, grid.end}, grid.content);
  grid.compression = inside.value<uint32_t>("compression of a grid");
  grid.texts = read_metadata(inside);
  grid.transform = inside.at();
  if (!has_offsets) grid.end = walk_vdb_tree(path, bytes, grid).end;
  return grid;
}

}  // namespace

void throw_unreadable_vdb(const std::string& path, const std::string& what) {
  throw Error(ErrorCode::unreadable_input, "read", path + ": " + what);
}

VdbLayout read_vdb_header(const std::string& path, View<const char> bytes) {
  VdbCursor in(path, bytes, 0);
  if (in.value<int64_t>("header") != kMagic)
    throw_unreadable_vdb(path, "is not a .vdb file: it does not start with the bytes of one");
  const uint32_t format = in.value<uint32_t>("header");
  if (format < kOldestFormat)
    throw_unreadable_vdb(path, ".vdb format " + std::to_string(format) + " is older than " +
                                   std::to_string(kOldestFormat) + "; save it again with a newer program");
  in.take(8, "header");
  VdbLayout layout;
  layout.has_offsets = in.value<char>("header") != 0;
  layout.tag = std::string(in.take(kVdbTagBytes, "header"), size_t(kVdbTagBytes));
  layout.texts = read_metadata(in);
  return layout;
}

VdbLayout read_vdb_layout(const std::string& path, View<const char> bytes) {
  VdbLayout layout = read_vdb_header(path, bytes);
  VdbCursor in(path, bytes, kVdbHeaderBytes);
  read_metadata(in);
  const uint32_t count = in.value<uint32_t>("count of grids");
  int64_t at = in.at();
  for (uint32_t i = 0; i < count; ++i) {
    layout.grids.push_back(read_grid_span(path, bytes, at, layout.has_offsets));
    at = layout.grids.back().end;
  }
  if (at != bytes.size)
    throw_unreadable_vdb(path, "its " + std::to_string(count) + " grids end at byte " + std::to_string(at) +
                                   ", the file at " + std::to_string(bytes.size) + ": it is damaged");
  return layout;
}

std::string vdb_checksum_tag(View<const char> bytes) {
  const uint64_t head = hash_bytes(bytes.data, kVdbTagBegin);
  const uint64_t rest = hash_bytes(bytes.data + kVdbHeaderBytes, bytes.size - kVdbHeaderBytes);
  const uint64_t words[2] = {head, rest};
  const uint64_t sum = hash_bytes(words, sizeof words);
  char hex[19];
  std::snprintf(hex, sizeof hex, "%018llx", static_cast<unsigned long long>(sum));
  return kTagStart + std::string(hex, 3) + "-8" + std::string(hex + 3, 3) + "-" + std::string(hex + 6, 12);
}

bool is_checksum_tag(const std::string& tag) { return tag.compare(0, sizeof kTagStart - 1, kTagStart) == 0; }

}  // namespace isoshell
