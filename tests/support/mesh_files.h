// Mesh files for tests: a folder that goes when the test ends, bytes into files, attributes by name.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "isoshell/io/mesh_file.h"
#include "support/catch.h"

namespace isoshell {

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "isoshell-test-XXXXXX").string();
    REQUIRE(mkdtemp(name.data()) != nullptr);
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  int64_t file_count() const {
    return std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator());
  }

 private:
  std::filesystem::path path_;
};

inline void put_file(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
}

inline std::string get_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Reads `bytes` as a file of the given ending.
inline TriangleSoup read_text_as(const std::string& ending, const std::string& bytes) {
  const TemporaryFolder folder;
  const std::string path = folder / ("mesh." + ending);
  put_file(path, bytes);
  return read_mesh(path);
}

/// The surface without its attributes.
inline TriangleMesh mesh_of(const TriangleSoup& soup) { return {soup.vertices, soup.triangles}; }

inline bool same_bits(const WorldPoint& a, const WorldPoint& b) {
  const auto same = [](double p, double q) { return p == q && std::signbit(p) == std::signbit(q); };
  return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z);
}

/// The attribute with this name; fails the test when there is none.
inline const Attribute& named(const std::vector<Attribute>& attributes, const std::string& name) {
  for (const Attribute& a : attributes)
    if (a.name == name) return a;
  FAIL("there is no attribute " + name);
  return attributes.front();
}

inline std::vector<std::string> names_of(const std::vector<Attribute>& attributes) {
  std::vector<std::string> names;
  for (const Attribute& a : attributes) names.push_back(a.name);
  return names;
}

}  // namespace isoshell
