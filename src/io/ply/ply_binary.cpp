// The body of a binary PLY file: rows found by stride where they are equally long, by hopping from list to list
// where not, and read in parallel by blocks.
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/number_type.h"
#include "core/parallel_ranges.h"
#include "io/bytes/byte_order.h"
#include "io/bytes/text_scan.h"
#include "io/ply/ply_body.h"

namespace isoshell {
namespace {

constexpr int64_t kRowsPerBlock = 1 << 12;

// One element's rows in the file.
class BinaryRows {
 public:
  BinaryRows(const MeshSource& source, const PlyHeader& header, const PlyElement& element, int64_t begin)
      : source_(source), element_(element), big_endian_(header.encoding == PlyEncoding::big_endian) {
    if (element.smallest_row_bytes() == 0) {
      end_ = begin;
    } else if (!element.has_list()) {
      stride_ = element.smallest_row_bytes();
      begin_ = begin;
      end_ = begin + element.count * stride_;
      if (end_ > source.size()) refuse_short(begin + (source.size() - begin) / stride_ * stride_);
    } else if (!find_stride(begin)) {
      hop(begin);
    }
  }

  int64_t begin() const { return begin_; }
  int64_t end() const { return end_; }
  int64_t block_count() const { return (element_.count + kRowsPerBlock - 1) / kRowsPerBlock; }
  int64_t stride() const { return stride_; }
  bool big_endian() const { return big_endian_; }

  /// Calls read(row, offset) for the rows of a block, in order.
  template <class Read>
  void each_row(int64_t block, Read read) const {
    const int64_t first = block * kRowsPerBlock, last = std::min(element_.count, first + kRowsPerBlock);
    int64_t offset = stride_ ? begin_ + first * stride_ : block_begin_[size_t(block)];
    for (int64_t row = first; row < last; ++row) {
      read(row, offset);
      offset += stride_ ? stride_ : row_bytes(offset);
    }
  }

  /// Where the property of the row at `offset` begins, and for a list how long it is (`offset` then behind its length).
  struct Place {
    int64_t offset, length;
  };
  Place find(int64_t offset, int property) const {
    for (int i = 0; i < property; ++i) offset += property_bytes(element_.properties[size_t(i)], offset);
    const PlyProperty& wanted = element_.properties[size_t(property)];
    if (!wanted.is_list) return {offset, 1};
    return {offset + size_of(wanted.count_type), list_length(wanted, offset)};
  }

 private:
  // Lengths are read as they stand; a negative one is caught where rows are found.
  int64_t list_length(const PlyProperty& list, int64_t offset) const {
    const char* const p = source_.begin() + offset;
    if (list.count_type == PlyType::u8) return static_cast<unsigned char>(*p);
    return with_type(list.count_type, [&](auto type) { return int64_t(load_number<decltype(type)>(p, big_endian_)); });
  }
  int64_t property_bytes(const PlyProperty& property, int64_t offset) const {
    if (!property.is_list) return size_of(property.type);
    return size_of(property.count_type) + size_of(property.type) * list_length(property, offset);
  }
  int64_t row_bytes(int64_t offset) const {
    int64_t at = offset;
    for (const PlyProperty& property : element_.properties) at += property_bytes(property, at);
    return at - offset;
  }
  // The same, for a row that may be cut off or lie.
  int64_t checked_row_bytes(int64_t offset) const {
    int64_t at = offset;
    for (const PlyProperty& property : element_.properties) {
      const int64_t fixed = size_of(property.is_list ? property.count_type : property.type);
      if (source_.size() - at < fixed) refuse_short(offset);
      if (!property.is_list) {
        at += fixed;
        continue;
      }
      const int64_t length = list_length(property, at);
      if (length < 0 || length > (source_.size() - at - fixed) / size_of(property.type))
        source_.refuse_byte(at, "element " + element_.name + ": list " + property.name + " promises " +
                                    std::to_string(length) + " items of " + std::to_string(size_of(property.type)) +
                                    " bytes; " + std::to_string(source_.size() - at - fixed) +
                                    " bytes are left; the file is truncated or damaged");
      at += fixed + length * size_of(property.type);
    }
    return at - offset;
  }

  // Are all lists as long as the first row's? Then rows are equally long: if rows 0 to i are, row i + 1 begins where it
  // is looked for, so one look at every place proves it for all.
  bool find_stride(int64_t begin) {
    if (element_.count == 0) {
      begin_ = end_ = begin;
      stride_ = 1;
      return true;
    }
    const int64_t stride = checked_row_bytes(begin);
    if (element_.count > (source_.size() - begin) / stride) return false;
    struct Length {
      int64_t at;
      const PlyProperty* list;
      int64_t length;
    };
    std::vector<Length> lengths;
    int64_t at = begin;
    for (const PlyProperty& property : element_.properties) {
      if (property.is_list) lengths.push_back({at - begin, &property, list_length(property, at)});
      at += property_bytes(property, at);
    }
    const bool equal = tbb::parallel_reduce(
        tbb::blocked_range<int64_t>(0, element_.count, 1 << 14), true,
        [&](const tbb::blocked_range<int64_t>& r, bool so_far) {
          for (int64_t row = r.begin(); so_far && row < r.end(); ++row)
            for (const Length& l : lengths) so_far &= list_length(*l.list, begin + row * stride + l.at) == l.length;
          return so_far;
        },
        std::logical_and<bool>());
    if (!equal) return false;
    begin_ = begin;
    stride_ = stride;
    end_ = begin + element_.count * stride;
    return true;
  }

  void hop(int64_t offset) {
    block_begin_.reserve(size_t(block_count()));
    for (int64_t row = 0; row < element_.count; ++row) {
      if (row % kRowsPerBlock == 0) block_begin_.push_back(offset);
      offset += checked_row_bytes(offset);
    }
    end_ = offset;
  }

  [[noreturn]] void refuse_short(int64_t offset) const {
    source_.refuse_byte(offset, "the file ends within element " + element_.name + ", which promises " +
                                    std::to_string(element_.count) + " rows; it is truncated, restore it");
  }

  const MeshSource& source_;
  const PlyElement& element_;
  bool big_endian_;
  int64_t begin_ = 0, end_ = 0, stride_ = 0;
  std::vector<int64_t> block_begin_;
};

void read_vertices(const MeshSource& source, const BinaryRows& rows, const PlyMeshLayout& layout, PlyBody& body) {
  static constexpr double WorldPoint::*kAxes[] = {&WorldPoint::x, &WorldPoint::y, &WorldPoint::z};
  std::vector<WorldPoint>& points = body.vertices.points;
  for_each_index(int64_t(0), rows.block_count(), [&](int64_t block) {
    // By columns: the type is looked at once a block, which stays cached.
    const auto read_column = [&](int property, auto value_of_row) {
      with_type(layout.vertices->properties[size_t(property)].type, [&](auto type) {
        int64_t in_row = -1;
        rows.each_row(block, [&](int64_t row, int64_t offset) {
          if (in_row < 0 || rows.stride() == 0) in_row = rows.find(offset, property).offset - offset;
          value_of_row(row) = double(load_number<decltype(type)>(source.begin() + offset + in_row, rows.big_endian()));
        });
      });
    };
    for (int axis = 0; axis < 3; ++axis)
      read_column(layout.xyz[axis], [&](int64_t row) -> double& { return points[size_t(row)].*kAxes[axis]; });
    for (const PlyColumn& column : layout.columns)
      read_column(column.property, [&](int64_t row) -> double& { return body.value_at(column, row); });
  });
  body.vertices.count_nonfinite();
}

template <class T>
int64_t as_index(T value) {
  if constexpr (std::is_floating_point_v<T>)
    return value > -1e15 && value < 1e15 && value == std::floor(value) ? int64_t(value) : INT64_MIN;
  else
    return int64_t(value);
}

// The whole element when its rows are equally long, all faces are triangles and all corners in range: then nothing has
// to be looked at twice. False: nothing was taken.
bool take_triangles(const MeshSource& source, const BinaryRows& rows, const PlyElement& element, int list,
                    const VertexTable& vertices, std::vector<FaceCollector>& faces) {
  if (rows.stride() == 0 || element.count == 0) return false;
  const BinaryRows::Place first = rows.find(rows.begin(), list);
  if (first.length != 3) return false;
  const uint64_t vertex_count = vertices.points.size();
  std::vector<Triangle> triangles;
  resize_counted(source, triangles, size_t(element.count));
  std::atomic<bool> in_range{true};
  with_type(element.properties[size_t(list)].type, [&](auto type) {
    using T = decltype(type);
    for_ranges(element.count, kRowsPerBlock, [&](int64_t first_row, int64_t end_row) {
      bool fits = true;
      for (int64_t row = first_row; row < end_row; ++row) {
        const char* p = source.begin() + first.offset + row * rows.stride();
        for (uint32_t& corner : triangles[size_t(row)]) {
          const uint64_t index = uint64_t(as_index(load_number<T>(p, rows.big_endian())));
          fits &= index < vertex_count;
          corner = uint32_t(index);
          p += sizeof(T);
        }
      }
      if (!fits) in_range = false;
    });
  });
  if (!in_range) {
    release(source, triangles);
    return false;
  }
  faces.emplace_back(vertices).adopt(std::move(triangles));
  return true;
}

/// What is kept of a row beside its corners.
class FaceRowReader {
 public:
  FaceRowReader(const MeshSource& source, const BinaryRows& rows, const PlyMeshLayout& layout)
      : source_(source), rows_(rows), layout_(layout), lists_(layout.corner_lists.size()) {}

  template <class Refuse>
  void read(int64_t offset, const std::vector<uint32_t>& vertices, PlyFaceRows& to, Refuse refuse) {
    for (size_t i = 0; i < layout_.face_columns.size(); ++i)
      append(offset, layout_.face_columns[i].property, to.columns[i]);
    for (size_t i = 0; i < lists_.size(); ++i) {
      lists_[i].clear();
      append(offset, layout_.corner_lists[i].property, lists_[i]);
    }
    add_face_row(source_, vertices, lists_, layout_, to, refuse);
  }

 private:
  void append(int64_t offset, int property, std::vector<double>& values) const {
    const BinaryRows::Place place = rows_.find(offset, property);
    make_room(source_, values, size_t(place.length));
    with_type(layout_.faces->properties[size_t(property)].type, [&](auto type) {
      const char* p = source_.begin() + place.offset;
      for (int64_t i = 0; i < place.length; ++i, p += sizeof(type))
        values.push_back(double(load_number<decltype(type)>(p, rows_.big_endian())));
    });
  }

  const MeshSource& source_;
  const BinaryRows& rows_;
  const PlyMeshLayout& layout_;
  std::vector<std::vector<double>> lists_;
};

void read_faces(const MeshSource& source, const BinaryRows& rows, const PlyElement& element, int list,
                const PlyMeshLayout& layout, PlyBody& body) {
  const bool is_strip = &element == layout.strips, keeps_rows = layout.keeps_faces();
  const VertexTable& vertices = body.vertices;
  std::vector<FaceCollector>& faces = body.faces;
  if (!is_strip && !keeps_rows && take_triangles(source, rows, element, list, vertices, faces)) return;
  const size_t base = faces.size();
  const int64_t vertex_count = int64_t(vertices.points.size());
  faces.resize(base + size_t(rows.block_count()), layout.collector(vertices));
  if (keeps_rows) body.face_rows.resize(faces.size(), PlyFaceRows(layout));
  for_each_chunk(rows.block_count(), [&](int64_t block) {
    FaceCollector& out = faces[base + size_t(block)];
    out.reserve(std::min(kRowsPerBlock, element.count - block * kRowsPerBlock));
    std::vector<int64_t> corners;
    std::vector<uint32_t> scratch;
    FaceRowReader row(source, rows, layout);
    with_type(element.properties[size_t(list)].type, [&](auto type) {
      using T = decltype(type);
      rows.each_row(block, [&](int64_t, int64_t offset) {
        const BinaryRows::Place place = rows.find(offset, list);
        const char* const p = source.begin() + place.offset;
        const auto corner = [&](int64_t i) {
          return as_index(load_number<T>(p + i * int64_t(sizeof(T)), rows.big_endian()));
        };
        const auto refuse = [&](const std::string& what) { source.refuse_byte(offset, what); };
        resize_counted(source, corners, size_t(place.length));
        make_room(source, scratch, corners.size() - std::min(corners.size(), scratch.size()));
        for (int64_t i = 0; i < place.length; ++i) corners[size_t(i)] = corner(i);
        add_ply_row(corners, is_strip, vertex_count, scratch, out, refuse);
        if (keeps_rows) row.read(offset, scratch, body.face_rows[base + size_t(block)], refuse);
      });
    });
  });
}

}  // namespace

void read_ply_binary(const MeshSource& source, const PlyHeader& header, const PlyMeshLayout& layout, PlyBody& body) {
  std::vector<BinaryRows> rows;
  int64_t offset = header.body;
  for (const PlyElement& element : header.elements) {
    rows.emplace_back(source, header, element, offset);
    offset = rows.back().end();
  }
  const bool is_padding =
      std::all_of(source.begin() + offset, source.end(), [](char c) { return c == '\0' || c == '\n' || is_blank(c); });
  if (!is_padding) body.dirt.surplus_bytes = source.size() - offset;

  const auto rows_of = [&](const PlyElement* element) { return rows[size_t(element - header.elements.data())]; };
  if (layout.vertices) {
    body.make_room(source, layout);
    read_vertices(source, rows_of(layout.vertices), layout, body);
  }
  for (const PlyElement& element : header.elements) {
    if (&element != layout.faces && &element != layout.strips) continue;
    const int list = &element == layout.strips ? layout.strip_corners : layout.face_corners;
    if (element.count > 0) read_faces(source, rows_of(&element), element, list, layout, body);
  }
}

}  // namespace isoshell
