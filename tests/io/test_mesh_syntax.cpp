// Every odd way to write a mesh that must be understood, and every lie that must be named.
#include <cstring>

#include "support/mesh_files.h"
#include "support/refusals.h"

using namespace isoshell;

namespace {

using Triangles = std::vector<std::array<uint32_t, 3>>;

const std::string kTriangleObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

Error refusal_of(const std::string& ending, const std::string& bytes) {
  const Error error = error_of([&] { read_text_as(ending, bytes); });
  CHECK(error.code() == ErrorCode::unreadable_input);
  INFO(error.what());
  return error;
}

void append_big_endian(std::string& out, const void* value, size_t bytes) {
  for (size_t i = bytes; i-- > 0;) out += static_cast<const char*>(value)[i];
}

template <class T>
void put(std::string& out, T value, bool big_endian) {
  if (big_endian)
    append_big_endian(out, &value, sizeof value);
  else
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// Three vertices of every scalar type in turn, one face with list types as given.
template <class Real, class Length, class Index>
std::string binary_ply(const char* real, const char* length, const char* index, bool big_endian) {
  std::string out = std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
                    "_endian 1.0\nelement vertex 3\nproperty uchar flag\nproperty " + real + " x\nproperty " + real +
                    " y\nproperty list uchar short tags\nproperty " + real + " z\nelement face 2\nproperty list " +
                    length + " " + index + " vertex_index\nproperty double area\nend_header\n";
  for (int i = 0; i < 3; ++i) {
    put<uint8_t>(out, 7, big_endian);
    put<Real>(out, Real(i), big_endian);
    put<Real>(out, Real(i * i), big_endian);
    put<uint8_t>(out, uint8_t(i), big_endian);
    for (int k = 0; k < i; ++k) put<int16_t>(out, -1, big_endian);
    put<Real>(out, Real(9), big_endian);
  }
  for (int f = 0; f < 2; ++f) {
    put<Length>(out, Length(3 - f), big_endian);
    for (int k = 0; k < 3 - f; ++k) put<Index>(out, Index(2 - k), big_endian);
    put<double>(out, 0.5, big_endian);
  }
  return out;
}

template <class Real, class Length, class Index>
void check_binary_ply(const char* real, const char* length, const char* index) {
  for (const bool big_endian : {false, true}) {
    INFO(real << ' ' << length << ' ' << index << (big_endian ? " big" : " little"));
    const TriangleSoup soup = read_text_as("ply", binary_ply<Real, Length, Index>(real, length, index, big_endian));
    CHECK(soup.triangles == Triangles{{2, 1, 0}});
    CHECK(soup.dirt.short_faces == 1);
    REQUIRE(soup.vertices.size() == 3);
    CHECK(same_bits(soup.vertices[2], {2, 4, 9}));
  }
}

const std::string kAsciiPly =
    "ply\nformat ascii 1.0\ncomment c\nobj_info o\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nelement range_grid 3\nproperty list uchar int vertex_indices\n";

}  // namespace

TEST_CASE("OBJ: slashes, tabs, continuation, CRLF, colours, groups, lines and a missing last line break are understood",
          "[mesh_file][unit]") {
  const TriangleSoup soup = read_text_as("obj",
                                         "# c\\\r\nmtllib a.mtl\r\no x\r\ng a b\r\nv\t0 0\t0 0.5 0.5 0.5\r\nv 1 0 0\r\n"
                                         "  v 0 \\\r\n1 0\r\nvt 0 0\r\nvn 0 0 1\r\nvp 1\r\ns off\r\nl 1 2\r\np 1\r\n"
                                         "f 1/1/1\t2//1 \\\r\n 3/1\r\nf -1 -2/1 -3//1 # tail\r\nusemtl m\r\nf 3 2 1");
  CHECK(soup.vertices.size() == 3);
  CHECK(same_bits(soup.vertices[2], {0, 1, 0}));
  CHECK(soup.triangles == Triangles{{0, 1, 2}, {2, 1, 0}, {2, 1, 0}});
}

TEST_CASE("OBJ: old Macintosh line ends and a byte order mark are understood", "[mesh_file][unit]") {
  CHECK(read_text_as("obj", "\xEF\xBB\xBFv 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r").triangles == Triangles{{0, 1, 2}});
}

TEST_CASE("OBJ: relative indices count from their own line, in every part of a long file", "[mesh_file][unit]") {
  std::string text;
  for (int i = 0; i < 20000; ++i)
    text += "v " + std::to_string(i) + " 0 0\nv " + std::to_string(i) + " 1 0\nv 0 0 1\nf -3 -2 -1\n";
  const TriangleSoup soup = read_text_as("obj", text);
  REQUIRE(soup.triangles.size() == 20000);
  bool right = true;
  for (uint32_t i = 0; i < 20000; ++i)
    right &= soup.triangles[i] == std::array<uint32_t, 3>{3 * i, 3 * i + 1, 3 * i + 2} && soup.vertices[3 * i].x == i;
  CHECK(right);
}

TEST_CASE("text: numbers are the nearest doubles however they are spelled", "[mesh_file][unit]") {
  const auto x_of = [](const std::string& number) {
    return read_text_as("obj", kTriangleObj + "v " + number + " 0 0\nf 1 2 3\n").vertices[3].x;
  };
  for (const char* number :
       {"0.1", "-0.30000000000000004", "1e22", "1e23", "123456789012345678901234567890", ".5", "5.",
        "1.7976931348623157e308", "4.9e-324", "2.2250738585072011e-308", "9007199254740993",
        "0.000000000000000000000000000001", "1E+2", "-1.5e-3", "-0", "1e-22", "7.2057594037927933e16"})
    CHECK(x_of(number) == std::strtod(number, nullptr));
  CHECK(x_of("+1.5") == 1.5);
  CHECK(x_of("1e-400") == 0);
  CHECK(std::signbit(x_of("-0")));
  for (const char* dirty : {"nan", "-nan", "NaN", "nan(ind)", "-nan(ind)", "inf", "-Inf", "infinity", "1e999", "1.#IND",
                            "-1.#IND", "1.#QNAN", "-1.#QNAN0", "1.#INF", "-1.#INF00", "1e99999999999999999999"}) {
    INFO(dirty);
    CHECK_FALSE(std::isfinite(x_of(dirty)));
  }
  for (const char* wrong : {"abc", "1,5", "1.5f", "--1", "+-1", "0x10", "e5", ".", "-", "1e"}) {
    INFO(wrong);
    const Error error = refusal_of("obj", kTriangleObj + "v " + wrong + " 0 0\nf 1 2 3\n");
    CHECK(says(error, "line 4: a vertex needs three numbers; found '"));
  }
}

TEST_CASE("OBJ: what is wrong is named with its line", "[mesh_file][unit]") {
  CHECK(says(refusal_of("obj", kTriangleObj + "v 1 2\nf 1 2 3\n"),
             "line 4: a vertex needs three numbers; found the end"));
  CHECK(says(refusal_of("obj", kTriangleObj + "f 1 2 4\n"), "line 4: a face names vertex 4"));
  CHECK(says(refusal_of("obj", kTriangleObj + "f 1 2 -4\n"), "line 4: a face names vertex -4; 3 vertices come before"));
  CHECK(says(refusal_of("obj", kTriangleObj + "f 1 2 x\n"), "line 4: a face corner is 'x'"));
  CHECK(says(refusal_of("obj", kTriangleObj + "f 1 2 99999999999999999999\n"), "line 4: a face corner is '9999"));
  CHECK(says(refusal_of("obj", std::string("\0\1\2\3 f", 6)), "zero bytes"));
}

TEST_CASE("dirt: repeated corners, short faces and unused vertices are counted", "[mesh_file][unit]") {
  const TriangleSoup soup =
      read_text_as("obj", kTriangleObj + "v 1 1 0\nv 5 5 5\nf 1 2 2\nf 1 2\nf\nf 1 2 3\nf 1 2 1 2\nf 2 4 4 3\n");
  CHECK(soup.triangles == Triangles{{0, 1, 2}, {1, 3, 2}});  // a quad closed to a triangle stays
  CHECK(soup.faces_in_file == 6);
  CHECK(soup.dirt.degenerate_faces == 2);
  CHECK(soup.dirt.short_faces == 2);
  CHECK(soup.dirt.unreferenced_vertices == 1);
}

TEST_CASE("OFF: prefixes, comments, blank lines, colours and missing edge counts are understood", "[mesh_file][unit]") {
  const std::string body = "0 0 0\n# between\n\n1 0 0 # tail\n0 1 0\n3 0 1 2 255 0 0\n";
  for (const std::string head : {"OFF\n3 1 0\n", "OFF 3 1 0\n", "OFF3 1 0\n", "# c\nOFF # c\n# c\n3 1\n",
                                 "COFF\r\n3 1 0\r\n", "NOFF\n\n3 1 0\n", "STOFF\n3 1 0\n", "STCNOFF 3 1 0 # c\n"}) {
    INFO(head);
    CHECK(read_text_as("off", head + body).triangles == Triangles{{0, 1, 2}});
  }
  CHECK(read_text_as("off", "COFF 3 1 0\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2").triangles.size() == 1);
}

TEST_CASE("OFF: what is wrong is named", "[mesh_file][unit]") {
  CHECK(says(refusal_of("off", "OFF BINARY\n"), "binary OFF cannot be read"));
  CHECK(says(refusal_of("off", "4OFF\n1 1 0\n"), "only three-dimensional OFF"));
  CHECK(says(refusal_of("off", "hello\n"), "begins with 'hello'"));
  CHECK(says(refusal_of("off", "OFF\n-3 1 0\n"), "line 2: the counts"));
  CHECK(says(refusal_of("off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
             "line 6: a face names vertex 3; the file holds vertices 0 to 2"));
  CHECK(says(refusal_of("off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n"),
             "line 6: the face promises 4 corners; corner 4"));
  CHECK(says(refusal_of("off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n"), "line 7: the header promises"));
}

TEST_CASE("PLY text: lists, other elements with empty lists, strips and polygons are understood", "[mesh_file][unit]") {
  const TriangleSoup soup = read_text_as(
      "ply",
      kAsciiPly +
          "element face 2\nproperty uchar red\nproperty list uchar int vertex_indices\nproperty list int float w\n"
          "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
          "0 0 0\n1 0 0\r\n1 1 0\n\n0 1 0 \n0\n2 7 8\n0\n255 4 0 1 2 3 0\n1 3 0 1 2 2 0.5 .5\n9 0 1 2 3 -1 3 2 1 -1");
  CHECK(soup.triangles == Triangles{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}, {0, 1, 2}, {2, 1, 3}, {3, 2, 1}});
  CHECK(soup.faces_in_file == 4);
}

TEST_CASE("PLY text: what is wrong is named", "[mesh_file][unit]") {
  const std::string head = kAsciiPly + "end_header\n";
  CHECK(says(refusal_of("ply", head + "0 0 0\n"), "line 5: element vertex promises 4 rows of at least 6 bytes"));
  CHECK(says(refusal_of("ply", head + "0 0 0 0 0\n1 1 1 1 1\n2 2 2 2 2 2\n"), "promises 7 rows; the file holds 3"));
  CHECK(says(refusal_of("ply", head + "0 0\n0.0 0 0\n0 0 0\n0 0 0\n0\n0\n0\n"),
             "line 12: element vertex: a number is expected; found the end"));
  const std::string face =
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0\n0\n0\n";
  CHECK(says(refusal_of("ply", kAsciiPly + face + "3 0 1 4\n"), "names vertex 4; the file holds vertices 0 to 3"));
  CHECK(says(refusal_of("ply", kAsciiPly + face + "3 0 1 -1\n"), "names vertex -1"));
  CHECK(says(refusal_of("ply", kAsciiPly + face + "3 0 1\n"), "an integer is expected; found the end"));
  CHECK(says(refusal_of("ply", kAsciiPly + face + "-3 0 1 2\n"), "a list promises -3 items"));
  CHECK(says(refusal_of("ply", "ply\nformat ascii 1.0\nelement vertex x\nend_header\n"),
             "line 3: element 'vertex' has the count 'x'"));
  CHECK(says(refusal_of("ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\nend_header\n"),
             "'half' is no PLY type"));
  CHECK(says(refusal_of("ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n"),
             "no number named y"));
  CHECK(says(refusal_of("ply", "ply\nelement vertex 0\nend_header\n"), "no format line"));
  CHECK(says(refusal_of("ply", "OFF\n"), "does not begin with ply"));
}

TEST_CASE("PLY text: values and rows that the header does not declare are passed over and counted",
          "[mesh_file][unit]") {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
  const TriangleSoup soup =
      read_text_as("ply", head + "0 0 0 9\n1 0 0\n0 1 0 9 nine\n3 0 1 2 0.5\n3 2 1 0 \r\n3 0 1 1\nanything\n\n");
  CHECK(soup.triangles == Triangles{{0, 1, 2}, {2, 1, 0}});
  CHECK(same_bits(soup.vertices[2], {0, 1, 0}));
  CHECK(soup.faces_in_file == 2);
  CHECK(soup.dirt.long_rows == 3);
  CHECK(soup.dirt.surplus_rows == 2);
  const TriangleSoup clean = read_text_as("ply", head + "0 0 0 \n1 0 0\t\r\n0 1 0\n3 0 1 2\n3 2 1 0\n \n\n");
  CHECK(clean.dirt.long_rows + clean.dirt.surplus_rows == 0);
}

TEST_CASE("PLY text: long rows are counted in every part of a long file", "[mesh_file][unit]") {
  constexpr int kFaces = 20000;
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face " +
      std::to_string(kFaces) + "\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
  for (int i = 0; i < kFaces; ++i) text += i % 4 ? "3 0 1 2\n" : "3 2 1 0 255 255 255\n";
  const TriangleSoup soup = read_text_as("ply", text);
  CHECK(soup.triangles.size() == kFaces);
  CHECK(soup.dirt.long_rows == kFaces / 4);
}

TEST_CASE("PLY: rows that were taken for others are refused: they leave faces too short and more than is declared",
          "[mesh_file][unit]") {
  const std::string counts_swapped =  // four vertices and one face, said to be three and two
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 1 1\n3 0 1 2\n";
  CHECK(says(refusal_of("ply", counts_swapped), "1 faces of fewer than three corners"));
  std::string shifted =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty uchar x\nproperty uchar y\n"
      "property uchar z\nelement face 2\nproperty list uchar uchar vertex_indices\nend_header\n" +
      std::string("\0\0\0\1\0\0\0\1\0", 9);
  for (int i = 0; i < 2; ++i) shifted += std::string("\3\0\1\2\0", 5);  // each with a byte that no property declares
  CHECK(says(refusal_of("ply", shifted), "5 bytes too many"));
}

TEST_CASE("PLY binary: all scalar types in both byte orders, with extra properties and lists", "[mesh_file][unit]") {
  check_binary_ply<float, uint8_t, int32_t>("float", "uchar", "int");
  check_binary_ply<double, int8_t, uint32_t>("double", "char", "uint");
  check_binary_ply<int8_t, int16_t, int8_t>("int8", "int16", "int8");
  check_binary_ply<uint8_t, uint16_t, uint8_t>("uint8", "uint16", "uint8");
  check_binary_ply<int16_t, int32_t, int16_t>("short", "int", "short");
  check_binary_ply<uint16_t, uint32_t, uint16_t>("ushort", "uint", "ushort");
  check_binary_ply<int32_t, uint8_t, float>("int32", "uint8", "float32");
  check_binary_ply<uint32_t, uint8_t, double>("uint32", "uint8", "float64");
}

TEST_CASE("PLY binary: what is wrong is named with its byte", "[mesh_file][unit]") {
  const std::string whole = binary_ply<float, uint8_t, int32_t>("float", "uchar", "int", false);
  CHECK(says(refusal_of("ply", whole.substr(0, whole.size() - 1)), "the file ends within element face"));
  std::string bad_index = whole;
  bad_index[whole.size() - 17 - 20] = 3;  // the last corner of the first face
  CHECK(says(refusal_of("ply", bad_index), "names vertex"));
  std::string bad_length = whole;
  bad_length[whole.size() - 17] = char(200);
  CHECK(says(refusal_of("ply", bad_length), "promises 200 items of 4 bytes"));
  std::string huge = whole;
  huge.replace(huge.find("face 2"), 6, "face 4000000000");
  CHECK(says(refusal_of("ply", huge), "element face promises 4000000000 rows of at least 9 bytes"));
}

TEST_CASE("PLY binary: bytes behind the last row are passed over and counted, padding is neither",
          "[mesh_file][unit]") {
  std::string whole = binary_ply<float, uint8_t, int32_t>("float", "uchar", "int", false);
  whole[whole.find("face 2") + 5] = '1';  // its second face has two corners only
  whole.resize(whole.size() - 17);
  for (const auto& [tail, bytes] :
       {std::pair<std::string, int64_t>{"more", 4}, {"\n\nmore", 6}, {"", 0}, {"\r\n \n", 0}})
    CHECK(read_text_as("ply", whole + tail).dirt.surplus_bytes == bytes);
  CHECK(read_text_as("ply", whole + std::string(64, '\0')).dirt.surplus_bytes == 0);
  CHECK(read_text_as("ply", whole + "more").triangles == Triangles{{2, 1, 0}});
}

TEST_CASE("PLY: points without faces are nothing to mesh, and the message says so", "[mesh_file][unit]") {
  const Error error =
      error_of([] { read_text_as("ply", kAsciiPly + "end_header\n0 0 0\n0 0 1\n0 1 0\n1 0 0\n0\n0\n0\n"); });
  CHECK(error.code() == ErrorCode::nothing_to_mesh);
  CHECK(says(error, "read it as a point cloud"));
}

TEST_CASE("STL text: any case, several solids, and equal positions are one vertex", "[mesh_file][unit]") {
  const std::string facet =
      "FACET normal 0 0 1\n\touter loop\n vertex 0 0 -0.0\nvertex 1e0 0 0\n VERTEX 0 1 0\nendloop\nendfacet\n";
  const std::string other =
      "facet normal 0 0 1\nouter loop\nvertex -0 0 0\nvertex 0 1 0\nvertex 1 1 0\nendloop\nendfacet\n";
  const TriangleSoup soup = read_text_as("stl", "solid a b\r\n" + facet + "endsolid\nsolid\n" + other + "endsolid x");
  CHECK(soup.triangles == Triangles{{0, 1, 2}, {0, 2, 3}});
  CHECK(same_bits(soup.vertices[0], {0, 0, -0.0}));
  CHECK(says(refusal_of("stl", "solid\n" + facet), "ends without endsolid"));
  CHECK(says(refusal_of("stl", "solid\n" + facet + "hello\nendsolid\n"), "line 9: 'hello' is no word"));
  CHECK(says(refusal_of("stl", "solid\nfacet\nouter loop\nvertex 0 0\nendloop\nendfacet\nendsolid\n"),
             "line 4: a vertex needs"));
  std::string many = "solid\n";
  for (int i = 0; i < 2000; ++i) many += i % 2 ? facet : other;
  const TriangleSoup large = read_text_as("stl", many + "endsolid\n");
  CHECK(large.triangles.size() == 2000);
  CHECK(large.vertices.size() == 4);
}

TEST_CASE("STL binary: told from text by its size, though it may begin with solid", "[mesh_file][unit]") {
  std::string bytes = "solid but binary";
  bytes.resize(80, ' ');
  put<uint32_t>(bytes, 1, false);
  for (int i = 0; i < 12; ++i) put<float>(bytes, i < 3 ? 0.f : float(i * i), false);
  bytes += "\1\2";
  const TriangleSoup soup = read_text_as("stl", bytes);
  CHECK(soup.triangles == Triangles{{0, 1, 2}});
  CHECK(same_bits(soup.vertices[2], {81, 100, 121}));
  CHECK(says(refusal_of("stl", bytes.substr(0, 130)),
             "byte 80: the header promises 1 facets of 50 bytes; 46 bytes follow"));
  CHECK(says(refusal_of("stl", bytes + bytes), "byte 80: the header promises 1 facets"));
  CHECK(says(refusal_of("stl", "short"), "is 5 bytes long"));
}

TEST_CASE("read_mesh: names, folders and absent files", "[mesh_file][unit]") {
  const TemporaryFolder folder;
  CHECK(error_of([&] { read_mesh(folder / "a.obj"); }).code() == ErrorCode::unreadable_input);
  CHECK(error_of([&] { read_mesh(folder / "a.xyz"); }).code() == ErrorCode::usage);
  CHECK(error_of([&] { read_mesh("-"); }).code() == ErrorCode::usage);
  std::filesystem::create_directory(folder / "b.obj");
  CHECK(says(error_of([&] { read_mesh(folder / "b.obj"); }), "is a folder"));
  put_file(folder / "c.dat", kTriangleObj + "f 1 2 3");
  CHECK(read_mesh(folder / "c.dat", "obj").triangles.size() == 1);
}

TEST_CASE("ply: a header of endless elements, properties or lines is refused at once", "[mesh_file][unit]") {
  std::string elements = "ply\nformat ascii 1.0\n", properties = elements + "element vertex 1\n";
  for (int i = 0; i < 100000; ++i) {
    elements += "element e" + std::to_string(i) + " 4000000000\n";
    properties += "property float p" + std::to_string(i) + "\n";
  }
  CHECK(says(refusal_of("ply", elements + "end_header\n"), "more than 4096 elements"));
  CHECK(says(refusal_of("ply", properties + "end_header\n"), "more than 4096 properties"));
  CHECK(says(refusal_of("ply", "ply\ncomment " + std::string(1 << 17, 'y') + "\nend_header\n"),
             "longer than 65536 bytes"));
}
