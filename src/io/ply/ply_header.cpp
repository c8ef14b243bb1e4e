// The header of a PLY file.
#include "io/ply/ply_header.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "io/bytes/text_scan.h"
#include "isoshell/io/mesh_file.h"

namespace isoshell {
namespace {

constexpr int64_t kMaxLineBytes = 1 << 16;

struct TypeName {
  const char *name, *other_name;
  PlyType type;
  int64_t bytes;
};
constexpr TypeName kTypes[] = {
    {"char", "int8", PlyType::i8, 1},      {"uchar", "uint8", PlyType::u8, 1},     {"short", "int16", PlyType::i16, 2},
    {"ushort", "uint16", PlyType::u16, 2}, {"int", "int32", PlyType::i32, 4},      {"uint", "uint32", PlyType::u32, 4},
    {"float", "float32", PlyType::f32, 4}, {"double", "float64", PlyType::f64, 8},
};

struct NoteKind {
  const char* name;
  size_t words_before_name;
};
constexpr NoteKind kNotes[] = {{kTextureNote, 2}, {kLibraryNote, 2},    {kLabelNote, 4},
                               {kRegionNote, 3},  {kBackgroundNote, 2}, {kFrameNote, 2}};

// Reads the header line by line; lines end in \n, \r\n or \r.
class HeaderReader {
 public:
  explicit HeaderReader(const MeshSource& source) : source_(source), p_(source.begin()) {}

  PlyHeader read() {
    if (!next_line() || words_.empty() || words_[0] != "ply")
      source_.refuse("does not begin with ply; check that it is the format its name says");
    bool has_format = false;
    while (next_line()) {
      if (words_.size() > 2 && words_[0] == "comment") read_comment();
      if (words_.empty() || words_[0] == "comment" || words_[0] == "obj_info") continue;
      if (words_[0] == "end_header") {
        if (!has_format) refuse("the header has no format line");
        header_.body = p_ - source_.begin();
        return std::move(header_);
      }
      if (words_[0] == "format") {
        read_format();
        has_format = true;
      } else if (words_[0] == "element") {
        read_element();
      } else if (words_[0] == "property") {
        read_property();
      } else {
        refuse(quoted(words_[0]) + " is no word of a PLY header; the header is damaged");
      }
    }
    if (source_.end() - p_ > kMaxLineBytes)
      refuse("a line of the header is longer than " + std::to_string(kMaxLineBytes) + " bytes; the file is damaged");
    source_.refuse("the header has no end_header within " + std::to_string(source_.size()) +
                   " bytes; the file is truncated or damaged, restore it");
  }

 private:
  static constexpr int64_t kBytesPerNote = 512;  // beside four times its letters
  static constexpr size_t kMostOfAKind = 4096;   // elements, properties of one: each is compared with those before

  static std::string quoted(const std::string& word) { return quoted_token(word.data(), word.data() + word.size()); }

  bool next_line() {
    line_ = p_ - source_.begin();
    const char* const end = p_ + std::min<int64_t>(source_.end() - p_, kMaxLineBytes);
    const char* const stop = std::find_if(p_, end, [](char c) { return c == '\n' || c == '\r'; });
    if (stop == end) return false;
    words_ = words_of(p_, stop);
    p_ = stop + 1;
    if (*stop == '\r' && p_ < source_.end() && *p_ == '\n') ++p_;
    return true;
  }

  /// A name may hold blanks: it goes to the end of the line.
  void read_comment() {
    const auto kind = std::find_if(std::begin(kNotes), std::end(kNotes),
                                   [&](const NoteKind& note) { return words_[1] == note.name; });
    if (kind == std::end(kNotes)) return;
    const size_t words_before_name = kind->words_before_name;
    if (words_.size() <= words_before_name) return;
    const char* p = source_.begin() + line_;
    for (size_t i = 0; i < words_before_name; ++i) p = skip_token(skip_blanks(p, p_), p_);
    p = skip_blanks(p, p_);
    const char* last = p_;
    while (last > p && (is_blank(last[-1]) || last[-1] == '\n')) --last;
    source_.take(kBytesPerNote + 4 * int64_t(last - p));
    header_.notes.emplace_back(words_.begin() + 1, words_.begin() + int64_t(words_before_name));
    header_.notes.back().emplace_back(p, last);
  }

  void read_format() {
    if (words_.size() < 2) refuse("the format line names no format");
    if (words_[1] == "ascii") {
      header_.encoding = PlyEncoding::ascii;
    } else if (words_[1] == "binary_little_endian") {
      header_.encoding = PlyEncoding::little_endian;
    } else if (words_[1] == "binary_big_endian") {
      header_.encoding = PlyEncoding::big_endian;
    } else {
      refuse("the format is " + quoted(words_[1]) + "; it must be ascii, binary_little_endian or binary_big_endian");
    }
  }

  void read_element() {
    PlyElement element;
    element.header_line = line_;
    if (words_.size() != 3) refuse("an element line needs a name and a count");
    element.name = words_[1];
    const char* p = words_[2].data();
    const char* const end = p + words_[2].size();
    if (!parse_integer(p, end, element.count) || p != end || element.count < 0)
      refuse("element " + quoted(words_[1]) + " has the count " + quoted(words_[2]) + "; it must be a number from 0");
    if (header_.elements.size() == kMostOfAKind) refuse("the header has more than 4096 elements; it is damaged");
    if (header_.find(element.name)) refuse("element " + quoted(words_[1]) + " is declared twice");
    header_.elements.push_back(std::move(element));
  }

  void read_property() {
    if (header_.elements.empty()) refuse("a property stands before the first element");
    PlyProperty property;
    property.is_list = words_.size() > 1 && words_[1] == "list";
    if (words_.size() != (property.is_list ? 5u : 3u)) refuse("a property line needs a type and a name");
    if (property.is_list) {
      property.count_type = type_named(words_[2]);
      if (is_real(property.count_type))
        refuse("the length of a list has the type " + quoted(words_[2]) + "; it must be an integer");
    }
    property.type = type_named(words_[words_.size() - 2]);
    property.name = words_.back();
    PlyElement& element = header_.elements.back();
    if (element.properties.size() == kMostOfAKind) refuse("the element has more than 4096 properties; it is damaged");
    if (element.find(property.name) >= 0) refuse("property " + quoted(words_.back()) + " is declared twice");
    element.properties.push_back(std::move(property));
  }

  PlyType type_named(const std::string& name) const {
    for (const TypeName& type : kTypes)
      if (name == type.name || name == type.other_name) return type.type;
    refuse(quoted(name) + " is no PLY type; types are char, uchar, short, ushort, int, uint, float, double");
  }

  [[noreturn]] void refuse(const std::string& what) const { source_.refuse_line_at(line_, what); }

  const MeshSource& source_;
  const char* p_;
  int64_t line_ = 0;
  std::vector<std::string> words_;
  PlyHeader header_;
};

/// The lines up to end_header, or as far as they are those of a header.
std::string header_text(const std::string& path, int64_t memory_limit_bytes) {
  std::ifstream file(path, std::ios::binary);
  if (!file) MeshSource(path, View<const char>{}).refuse(std::string("cannot be opened: ") + std::strerror(errno));
  ReadingBudget budget(memory_limit_bytes);
  std::string text;
  for (std::string line(kMaxLineBytes, '\0'); file.getline(line.data(), kMaxLineBytes) || file.gcount() > 0;) {
    const bool is_whole = file.good();
    const auto got = size_t(file.gcount()) - (is_whole ? 1 : 0);
    budget.take(int64_t(got) + 1, path);
    text.append(line, 0, got);
    if (!is_whole) break;
    text += '\n';
    const std::vector<std::string> words = words_of(line.data(), line.data() + got);
    if (!words.empty() && words[0] == "end_header") break;
  }
  return text;
}

// As text a value takes a digit and a separator; the last separator may be missing.
void check_counts(const MeshSource& source, const PlyHeader& header) {
  const bool ascii = header.encoding == PlyEncoding::ascii;
  int64_t room = source.size() - header.body + (ascii ? 1 : 0);
  for (const PlyElement& element : header.elements) {
    const int64_t row = ascii ? 2 * int64_t(element.properties.size()) : element.smallest_row_bytes();
    if (row == 0) continue;
    if (element.count > room / row)
      source.refuse_line_at(element.header_line,
                            "element " + element.name + " promises " + std::to_string(element.count) +
                                " rows of at least " + std::to_string(row) + " bytes; only " + std::to_string(room) +
                                " bytes are left for it; the file is truncated or the count is wrong");
    room -= element.count * row;
  }
}

}  // namespace

int64_t size_of(PlyType type) { return kTypes[int(type)].bytes; }

const char* name_of(PlyType type) { return kTypes[int(type)].name; }

int PlyElement::find(const std::string& property) const {
  for (size_t i = 0; i < properties.size(); ++i)
    if (properties[i].name == property) return int(i);
  return -1;
}

int64_t PlyElement::smallest_row_bytes() const {
  int64_t bytes = 0;
  for (const PlyProperty& property : properties)
    bytes += size_of(property.is_list ? property.count_type : property.type);
  return bytes;
}

bool PlyElement::has_list() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return p.is_list; });
}

const PlyElement* PlyHeader::find(const std::string& element) const {
  for (const PlyElement& e : elements)
    if (e.name == element) return &e;
  return nullptr;
}

std::string made_of_in_ply(const std::string& path, int64_t memory_limit_bytes) {
  const std::string text = header_text(path, memory_limit_bytes);
  const MeshSource source(path, View<const char>{text.data(), int64_t(text.size())});
  for (const std::vector<std::string>& note : HeaderReader(source).read().notes)
    if (note[0] == kFrameNote) return note[1];
  return "";
}

PlyHeader read_ply_header(const MeshSource& source) {
  PlyHeader header = HeaderReader(source).read();
  check_counts(source, header);
  return header;
}

}  // namespace isoshell
