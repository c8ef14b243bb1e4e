// PCD, the Point Cloud Library's format: a header of text, then rows as text, as binary, or columns packed by LZF.
#include <cstring>

#include "io/bytes/lzf.h"
#include "io/bytes/text_scan.h"
#include "io/faces/face_collector.h"
#include "io/points/point_readers.h"

namespace isoshell {
namespace {

constexpr int64_t kMaxCount = 1 << 20;          // numbers of one field of a point
constexpr int64_t kBestLzfRatio = 265 / 3 + 1;  // three bytes stand for 264 at most

struct PcdField {
  std::string name;
  int64_t size = 4, count = 1;
  char type = 'F';
  int64_t column = 0;  ///< first of its numbers in a row of text
  int64_t offset = 0;  ///< first of its bytes in a binary row
};

struct PcdHeader {
  std::vector<PcdField> fields;
  int64_t width = -1, height = 1, points = -1;
  std::string data;
  const char* body = nullptr;
  int64_t row_bytes = 0, columns = 0;
};

class PcdReader {
 public:
  explicit PcdReader(const MeshSource& source) : source_(source) { read_header(); }

  PointCloud read() {
    constexpr const char* kPosition[3] = {"x", "y", "z"};
    constexpr const char* kNormal[3] = {"normal_x", "normal_y", "normal_z"};
    const PcdField* field[6];
    for (int i = 0; i < 6; ++i) field[i] = find(i < 3 ? kPosition[i] : kNormal[i - 3]);
    if (!field[0] || !field[1] || !field[2]) source_.refuse("its fields are not x, y and z; the points have no place");
    const bool normals = field[3] && field[4] && field[5];
    PointCloud cloud;
    if (h_.data == "ascii")
      read_text(field, normals, cloud);
    else if (h_.data == "binary")
      read_binary(field, normals, cloud);
    else if (h_.data == "binary_compressed")
      read_packed(field, normals, cloud);
    else
      source_.refuse("DATA is '" + h_.data.substr(0, 40) + "'; it must be ascii, binary or binary_compressed");
    return cloud;
  }

 private:
  const PcdField* find(const char* name) const {
    for (const PcdField& field : h_.fields)
      if (field.name == name && field.count == 1) return &field;
    return nullptr;
  }

  void read_header() {
    const char* p = source_.begin();
    while (h_.data.empty()) {
      if (p == source_.end()) source_.refuse("the header of a .pcd file ends with DATA; it is missing");
      const char* const stop = line_end(p, source_.end());
      const std::vector<std::string> words = words_of(p, stop);
      line_ = p - source_.begin();
      p = stop == source_.end() ? stop : stop + 1;
      if (!words.empty() && words[0][0] != '#') read_line(words);
    }
    h_.body = p;
    check_header();
  }

  void read_line(const std::vector<std::string>& words) {
    const auto each = [&](auto set) {
      if (words.size() != h_.fields.size() + 1) refuse(words[0] + " does not have a word for every field");
      for (size_t i = 0; i < h_.fields.size(); ++i) set(h_.fields[i], words[i + 1]);
    };
    if (words[0] == "FIELDS" || words[0] == "COLUMNS") {
      h_.fields.resize(words.size() - 1);
      each([](PcdField& field, const std::string& word) { field.name = word; });
    } else if (words[0] == "SIZE") {
      each([&](PcdField& field, const std::string& word) { field.size = number(word, 8); });
    } else if (words[0] == "TYPE") {
      each([&](PcdField& field, const std::string& word) { field.type = word[0]; });
    } else if (words[0] == "COUNT") {
      each([&](PcdField& field, const std::string& word) { field.count = number(word, kMaxCount); });
    } else if (words[0] == "WIDTH" || words[0] == "HEIGHT" || words[0] == "POINTS") {
      if (words.size() != 2) refuse(words[0] + " needs a number");
      (words[0] == "WIDTH"    ? h_.width
       : words[0] == "HEIGHT" ? h_.height
                              : h_.points) = number(words[1], kMaxSoupVertices);
    } else if (words[0] == "DATA") {
      h_.data = words.size() > 1 ? words[1] : "nothing";
    } else if (words[0] != "VERSION" && words[0] != "VIEWPOINT") {
      refuse(quoted_token(words[0].data(), words[0].data() + words[0].size()) + " is no word of a PCD header");
    }
  }

  int64_t number(const std::string& word, int64_t most) const {
    int64_t value = -1;
    const char* p = word.data();
    const char* const end = p + word.size();
    if (!parse_integer(p, end, value) || p != end || value < 0 || value > most)
      refuse(quoted_token(word.data(), end) + " is no number from 0 to " + std::to_string(most));
    return value;
  }

  void check_header() {
    if (h_.width > 0 && h_.height > kMaxSoupVertices / h_.width)
      source_.refuse("WIDTH " + std::to_string(h_.width) + " times HEIGHT " + std::to_string(h_.height) +
                     " is more than " + std::to_string(kMaxSoupVertices) + " points; split the file");
    if (h_.points < 0) h_.points = h_.width < 0 ? 0 : h_.height > 0 ? h_.width * h_.height : h_.width;
    if (h_.points > kMaxSoupVertices || h_.points == 0) source_.refuse("it promises no points, or too many");
    if (h_.width >= 0 && h_.height > 0 && h_.width * h_.height != h_.points)
      source_.refuse("WIDTH times HEIGHT is " + std::to_string(h_.width * h_.height) + ", POINTS " +
                     std::to_string(h_.points) + ": the header is damaged");
    for (PcdField& field : h_.fields) {
      if (field.size != 1 && field.size != 2 && field.size != 4 && field.size != 8)
        source_.refuse("field " + field.name.substr(0, 40) + " has values of " + std::to_string(field.size) + " bytes");
      field.column = h_.columns;
      field.offset = h_.row_bytes;
      h_.columns += field.count;
      h_.row_bytes += field.size * field.count;
    }
  }

  void make_room(bool normals, PointCloud& cloud) const {
    resize_counted(source_, cloud.position, size_t(h_.points));
    if (normals) resize_counted(source_, cloud.normal, size_t(h_.points));
  }

  void read_text(const PcdField* const field[6], bool normals, PointCloud& cloud) const {
    const Text text(source_);
    const TextRows rows(text, text.begin() + (h_.body - source_.begin()), '#');
    if (rows.count() != h_.points)
      source_.refuse("the header promises " + std::to_string(h_.points) + " points; " + std::to_string(rows.count()) +
                     " rows follow");
    make_room(normals, cloud);
    rows.for_each(0, rows.count(), [&](int64_t row, const char* p, const char* end, int64_t) {
      for (int64_t column = 0; column < h_.columns; ++column) {
        p = skip_blanks(p, end);
        double value = 0;
        if (!parse_real(p, end, value))
          text.refuse(p, "a row needs " + std::to_string(h_.columns) + " numbers; found " + quoted_token(p, end));
        for (int i = 0; i < (normals ? 6 : 3); ++i)
          if (field[i]->column == column) axis(cloud, row, i) = value;
      }
      return p;
    });
  }

  void read_binary(const PcdField* const field[6], bool normals, PointCloud& cloud) const {
    const int64_t left = source_.end() - h_.body;
    if (h_.points > left / h_.row_bytes)
      source_.refuse("the header promises " + std::to_string(h_.points) + " points of " + std::to_string(h_.row_bytes) +
                     " bytes; " + std::to_string(left) + " bytes follow");
    make_room(normals, cloud);
    for (int64_t row = 0; row < h_.points; ++row)
      for (int i = 0; i < (normals ? 6 : 3); ++i)
        axis(cloud, row, i) = value_at(h_.body + row * h_.row_bytes + field[i]->offset, *field[i]);
  }

  void read_packed(const PcdField* const field[6], bool normals, PointCloud& cloud) const {
    uint32_t sizes[2] = {};  // packed, plain
    const int64_t left = source_.end() - h_.body - int64_t(sizeof sizes);
    if (left < 0) source_.refuse("ends before its packed points");
    std::memcpy(sizes, h_.body, sizeof sizes);
    if (sizes[0] > left || sizes[1] != h_.points * h_.row_bytes || sizes[1] > sizes[0] * kBestLzfRatio)
      source_.refuse(std::to_string(h_.points) + " points of " + std::to_string(h_.row_bytes) +
                     " bytes are packed as " + std::to_string(sizes[1]) + " bytes into " + std::to_string(sizes[0]) +
                     ", where " + std::to_string(left) + " follow");
    std::vector<char> plain;
    resize_counted(source_, plain, sizes[1]);
    if (!unpack_lzf({h_.body + sizeof sizes, sizes[0]}, {plain.data(), int64_t(plain.size())}))
      source_.refuse("its packed points are damaged");
    make_room(normals, cloud);
    for (int i = 0; i < (normals ? 6 : 3); ++i)
      for (int64_t row = 0; row < h_.points; ++row)
        axis(cloud, row, i) = value_at(plain.data() + field[i]->offset * h_.points + row * field[i]->size, *field[i]);
  }

  static double& axis(PointCloud& cloud, int64_t row, int i) {
    WorldPoint& p = i < 3 ? cloud.position[size_t(row)] : cloud.normal[size_t(row)];
    return i % 3 == 0 ? p.x : i % 3 == 1 ? p.y : p.z;
  }

  template <class T>
  static double load(const char* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return double(value);
  }
  double value_at(const char* at, const PcdField& field) const {
    if (field.type == 'F' && field.size == 4) return load<float>(at);
    if (field.type == 'F' && field.size == 8) return load<double>(at);
    if (field.type == 'I' && field.size == 2) return load<int16_t>(at);
    if (field.type == 'I' && field.size == 4) return load<int32_t>(at);
    if (field.type == 'U' && field.size == 2) return load<uint16_t>(at);
    if (field.type == 'U' && field.size == 4) return load<uint32_t>(at);
    source_.refuse("field " + field.name + " has the type " + std::string(1, field.type) + " of " +
                   std::to_string(field.size) + " bytes, which is no coordinate");
  }

  [[noreturn]] void refuse(const std::string& what) const { source_.refuse_line_at(line_, what); }

  const MeshSource& source_;
  PcdHeader h_;
  int64_t line_ = 0;
};

}  // namespace

PointCloud read_pcd(const MeshSource& source) { return PcdReader(source).read(); }

}  // namespace isoshell
