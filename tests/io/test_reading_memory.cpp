// Readers take no more memory than their limit, whatever the file. This program counts what it allocates itself.
#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <new>
#include <sstream>

#include "io/file_formats.h"
#include "support/catch.h"
#include "support/gltf_file.h"
#include "support/refusals.h"
#include "support/temporary_file.h"

namespace {

std::atomic<int64_t> held_bytes{0}, most_bytes{0};

void* counted_allocation(size_t bytes) {
  void* const data = std::malloc(bytes);
  if (!data) throw std::bad_alloc();
  const int64_t held = held_bytes += int64_t(malloc_usable_size(data));
  for (int64_t most = most_bytes; held > most && !most_bytes.compare_exchange_weak(most, held);) {
  }
  return data;
}

void counted_free(void* data) {
  if (data) held_bytes -= int64_t(malloc_usable_size(data));
  std::free(data);
}

}  // namespace

void* operator new(size_t bytes) { return counted_allocation(bytes); }
void* operator new[](size_t bytes) { return counted_allocation(bytes); }
void operator delete(void* data) noexcept { counted_free(data); }
void operator delete[](void* data) noexcept { counted_free(data); }
void operator delete(void* data, size_t) noexcept { counted_free(data); }
void operator delete[](void* data, size_t) noexcept { counted_free(data); }

using namespace isoshell;

namespace {

constexpr int kSide = 100;
constexpr int64_t kUncountedBytes = 1 << 20;  // lists of chunks, messages, what threads keep

/// Vertices of a bent sheet, and its squares by the numbers of their corners.
template <class Vertex, class Square>
void each_of_sheet(Vertex vertex, Square square) {
  for (int y = 0; y <= kSide; ++y)
    for (int x = 0; x <= kSide; ++x) vertex(x, y, 0.1 * (x * x % 7));
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const int first = y * (kSide + 1) + x;
      square(std::array<int, 4>{first, first + 1, first + kSide + 2, first + kSide + 1});
    }
}

template <class T>
std::string raw(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

std::string obj_of_sheet() {
  std::ostringstream text;
  each_of_sheet(
      [&](int x, int y, double z) {
        text << "v " << x << " " << y << " " << z << " 1 0 0\nvt " << x << " " << y << "\nvn 0 0 1\n";
      },
      [&](const std::array<int, 4>& q) {
        text << "g n" << q[0] << "\nf";
        for (const int i : q) text << " " << i + 1 << "/" << i + 1 << "/" << i + 1;
        text << "\n";
      });
  return text.str();
}

std::string ply_of_sheet(bool is_text) {
  std::string body;
  const auto add = [&](auto value, char behind) { body += is_text ? std::to_string(int(value)) + behind : raw(value); };
  each_of_sheet(
      [&](int x, int y, double) {
        for (const int value : {x, y, x % 2}) add(float(value), ' ');
        for (int i = 0; i < 4; ++i) add(uint8_t(7), i < 3 ? ' ' : '\n');
      },
      [&](const std::array<int, 4>& q) {
        add(uint8_t(4), ' ');
        for (const int i : q) add(int32_t(i), ' ');
        add(uint8_t(3), '\n');
      });
  return "ply\nformat " + std::string(is_text ? "ascii" : "binary_little_endian") + " 1.0\nelement vertex " +
         std::to_string((kSide + 1) * (kSide + 1)) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar a\nproperty uchar b\nproperty uchar "
         "c\nproperty uchar d\nelement face " +
         std::to_string(kSide * kSide) +
         "\nproperty list uchar int vertex_indices\nproperty uchar label\nend_header\n" + body;
}

std::string stl_of_sheet(bool is_text, bool has_solids = false) {
  std::string body;
  int facets = 0;
  const auto facet = [&](int x, int y) {
    const int corners[3][2] = {{x, y}, {x + 1, y}, {x, y + 1}};
    ++facets;
    body += is_text ? "facet normal 0 0 1\nouter loop\n" : std::string(12, '\0');
    for (const auto& [u, v] : corners)
      body += is_text ? "vertex " + std::to_string(u) + " " + std::to_string(v) + " 0\n"
                      : raw(float(u)) + raw(float(v)) + raw(0.f);
    body += is_text ? "endloop\nendfacet\n" : std::string(2, '\0');
  };
  for (int y = 0; y < 2 * kSide; ++y) {
    if (has_solids) body += "endsolid\nsolid row " + std::to_string(y) + "\n";
    for (int x = 0; x < kSide; ++x) facet(x, y);
  }
  return is_text ? "solid s\n" + body + "endsolid s\n" : std::string(80, ' ') + raw(uint32_t(facets)) + body;
}

std::string off_of_sheet() {
  std::ostringstream text;
  text << "OFF\n" << (kSide + 1) * (kSide + 1) << " " << kSide * kSide << " 0\n";
  each_of_sheet([&](int x, int y, double z) { text << x << " " << y << " " << z << "\n"; },
                [&](const std::array<int, 4>& q) {
                  text << 4;
                  for (const int i : q) text << " " << i;
                  text << "\n";
                });
  return text.str();
}

/// A small mesh with texture coordinates that many nodes place: much more than the file holds.
std::string glb_of_instances(int nodes) {
  GltfFile file;
  std::vector<float> position, uv;
  std::vector<uint32_t> corners;
  each_of_sheet(
      [&](int x, int y, double z) {
        for (const double value : {double(x), double(y), z}) position.push_back(float(value));
        for (const int value : {x, y}) uv.push_back(float(value));
      },
      [&](const std::array<int, 4>& q) {
        for (const int i : {0, 1, 2, 0, 2, 3}) corners.push_back(uint32_t(q[size_t(i)]));
      });
  const size_t points = position.size() / 3;
  const size_t of_position = file.accessor(5126, points, "VEC3", {{"bufferView", file.view(bytes_of(position))}});
  const size_t of_uv = file.accessor(5126, points, "VEC2", {{"bufferView", file.view(bytes_of(uv))}});
  const size_t of_corners =
      file.accessor(5125, corners.size(), "SCALAR", {{"bufferView", file.view(bytes_of(corners))}});
  file.primitive({{"attributes", {{"POSITION", of_position}, {"TEXCOORD_0", of_uv}}}, {"indices", of_corners}});
  for (int i = 0; i < nodes; ++i) file.json["nodes"].push_back({{"mesh", 0}, {"translation", {200 * i, 0, 0}}});
  return file.glb();
}

std::string xyz_of_sheet() {
  std::ostringstream text;
  each_of_sheet([&](int x, int y, double z) { text << x << " " << y << " " << z << " 0 0 1\n"; },
                [](const std::array<int, 4>&) {});
  return text.str();
}

std::string pcd_of_zeros(const std::string& data) {
  constexpr uint32_t kPoints = 100000, kBytes = 12 * kPoints;
  std::string head = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + std::to_string(kPoints) +
                     "\nHEIGHT 1\nPOINTS " + std::to_string(kPoints) + "\nDATA " + data + "\n";
  if (data == "binary") return head + std::string(kBytes, '\0');
  std::string packed(2, '\0');  // a zero, then runs of up to 264 bytes that repeat the byte before them
  for (uint32_t left = kBytes - 1; left > 0;) {
    const uint32_t run = std::min(left, 264u) - 2;
    packed += char(7 << 5);
    packed += char(run - 7);
    packed += '\0';
    left -= run + 2;
  }
  return head + raw(uint32_t(packed.size())) + raw(kBytes) + packed;
}

/// Files of each format that is read as a mesh or points; every row of the table of formats has some.
std::multimap<std::string, std::string> files_of_formats() {
  return {
      {"obj", obj_of_sheet()},     {"ply", ply_of_sheet(true)},       {"ply", ply_of_sheet(false)},
      {"stl", stl_of_sheet(true)}, {"stl", stl_of_sheet(true, true)}, {"stl", stl_of_sheet(false)},
      {"off", off_of_sheet()},     {"glb", glb_of_instances(40)},     {"gltf", glb_of_instances(40)},
      {"xyz", xyz_of_sheet()},     {"pcd", pcd_of_zeros("binary")},   {"pcd", pcd_of_zeros("binary_compressed")},
  };
}

/// What was read under the limit, in vertices or points; -1: nothing, for want of memory.
int64_t read_below(const FormatRow& row, const std::string& path, int64_t limit_bytes) {
  const std::string& format = row.format.name;
  try {
    if (row.read) return int64_t(read_mesh(path, format, limit_bytes).vertices.size());
    return int64_t(read_points(path, format, limit_bytes).position.size());
  } catch (const Error& error) {
    INFO(format << ": " << error.what());
    CHECK(int(error.code()) == int(ErrorCode::out_of_memory));
    CHECK(says(error, "raise --max-memory, or split the file"));
    return -1;
  }
}

}  // namespace

TEST_CASE("reading: every format holds no more than the limit, or says so", "[mesh_file][memory]") {
  const auto files = files_of_formats();
  for (const FileFormat& format : file_formats()) {
    const FormatRow& row = *find_row(format.name);
    if (!row.read && !row.read_points) continue;
    REQUIRE(files.count(format.name) > 0);
    const auto [first, last] = files.equal_range(format.name);
    for (auto file = first; file != last; ++file) {
      const TemporaryFile at("memory." + format.name);
      std::ofstream(at.path, std::ios::binary) << file->second;
      const int64_t whole = read_below(row, at.path, 0);  // and what is made at the first use is there
      REQUIRE(whole > 0);
      int refused = 0, read = 0;
      for (int64_t limit = 1 << 16; limit <= int64_t(1) << 30; limit *= 2) {
        const int64_t before = held_bytes;
        most_bytes = before;
        const int64_t found = read_below(row, at.path, limit);
        const int64_t took = most_bytes - before;
        INFO(format.name << " of " << file->second.size() << " bytes, limit " << limit << ", took " << took);
        CHECK(took <= limit + kUncountedBytes);
        CHECK((found == -1 || found == whole));
        ++(found == -1 ? refused : read);
      }
      INFO(format.name << " of " << file->second.size() << " bytes");
      CHECK(refused > 0);
      CHECK(read > 0);
    }
  }
}

TEST_CASE("reading: many nodes on one mesh are counted before they are made", "[gltf][memory]") {
  const TemporaryFile file("instances.glb");
  std::ofstream(file.path, std::ios::binary) << glb_of_instances(4000);
  const int64_t before = held_bytes;
  most_bytes = before;
  const Error error = error_of([&] { read_mesh(file.path, "glb", int64_t(200) << 20); });
  CHECK(int(error.code()) == int(ErrorCode::out_of_memory));
  CHECK(says(error, file.path + ": needs at least"));
  CHECK(most_bytes - before < int64_t(200) << 20);
}

TEST_CASE("reading: what never ends is refused at the limit", "[mesh_file][memory]") {
  for (const FileFormat& format : file_formats()) {
    if (!format.reads_mesh && !format.reads_points) continue;
    const FormatRow& row = *find_row(format.name);
    INFO(format.name);
    CHECK(read_below(row, "/dev/zero", int64_t(32) << 20) == -1);
  }
}

TEST_CASE("reading: a file that shrinks once it is open is read as it was", "[mesh_file]") {
  const TemporaryFile file("shrinks.obj");
  std::ofstream(file.path, std::ios::binary) << obj_of_sheet();
  ReadingBudget budget;
  const MeshSource source(file.path, budget);
  std::filesystem::resize_file(file.path, 0);
  CHECK(find_row("obj")->read(source).vertices.size() == size_t(kSide + 1) * (kSide + 1));
}

TEST_CASE("reading: a file that ends before the size that it says is refused", "[mesh_file]") {
  const std::string path = "/sys/kernel/mm/transparent_hugepage/enabled";  // says a page, and has a line
  std::error_code missing;
  if (!std::filesystem::exists(path, missing)) return;
  CHECK(says(error_of([&] { read_mesh(path, "obj"); }), "that it had when it was opened; read it once it is written"));
}
