// Mesh files for tests: a folder that goes when the test ends, bytes into files, errors into values.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "isoshell/error.h"
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

/// What `work` throws; fails the test when it throws nothing.
template <class Work>
Error error_of(Work work) {
  try {
    work();
  } catch (const Error& error) {
    return error;
  }
  FAIL("nothing was thrown");
  return Error(ErrorCode::internal, "", "");
}

inline bool says(const Error& error, const std::string& part) {
  return std::string(error.what()).find(part) != std::string::npos;
}

inline bool same_bits(const WorldPoint& a, const WorldPoint& b) {
  const auto same = [](double p, double q) { return p == q && std::signbit(p) == std::signbit(q); };
  return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z);
}

}  // namespace isoshell
