// Runs the command as a user does, in a folder of its own, and tells how it ended.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "isoshell/io/mesh_file.h"
#include "support/shapes.h"
#include "support/source_folder.h"

namespace isoshell::cli {

namespace fs = std::filesystem;

#ifndef COMMAND_VARIABLE
#define COMMAND_VARIABLE "VDB_ISOMESH"
#endif

/// What the environment variable of the command under test says, or the command of this build.
inline std::string command_path() {
  const char* path = std::getenv(COMMAND_VARIABLE);
  return path ? path : VDB_ISOMESH_BUILT;
}

inline std::string content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A surface as an OFF file.
inline void write_off(const fs::path& path, const TriangleSoup& soup) {
  std::ofstream file(path);
  file.precision(9);
  file << "OFF\n" << soup.vertices.size() << " " << soup.triangles.size() << " 0\n";
  for (const WorldPoint& p : soup.vertices) file << p.x << " " << p.y << " " << p.z << "\n";
  for (const auto& t : soup.triangles) file << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
}

/// A folder that is deleted at the end of the test, with the command run inside it.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "vdb_isomesh_XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }

  struct Result {
    int status;  ///< exit status; 128 + signal as a shell says it
    std::string out, err;
  };

  /// Runs `vdb_isomesh <arguments>` through the shell; redirections and pipes may follow the arguments.
  Result run(const std::string& arguments) { return shell("'" + command_path() + "' " + arguments); }

  Result shell(const std::string& command) {
    const std::string line = "cd '" + path_.string() + "' && ( " + command + " ) >.stdout 2>.stderr </dev/null";
    const int ended = std::system(line.c_str());
    Result r{WIFEXITED(ended) ? WEXITSTATUS(ended) : 128 + WTERMSIG(ended), content(".stdout"), content(".stderr")};
    fs::remove(path_ / ".stdout");
    fs::remove(path_ / ".stderr");
    return r;
  }

  std::string content(const std::string& name) const { return cli::content(path_ / name); }
  bool has(const std::string& name) const { return fs::exists(path_ / name); }
  size_t file_count() const { return size_t(std::distance(fs::directory_iterator(path_), fs::directory_iterator())); }
  fs::path operator/(const std::string& name) const { return path_ / name; }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
  }

  void write_off(const std::string& name, const TriangleSoup& soup) const { cli::write_off(path_ / name, soup); }

 private:
  fs::path path_;
};

}  // namespace isoshell::cli
