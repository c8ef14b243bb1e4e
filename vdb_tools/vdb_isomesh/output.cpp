// Checks and writes files.
#include "vdb_isomesh/output.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <vector>

#include "isoshell/error.h"
#include "isoshell/io/vdb_file.h"
#include "vdb_isomesh/interrupt.h"

namespace isoshell::tool {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::unwritable_output, "write", message); }

void check_output(const std::string& path, bool force) {
  std::error_code code;
  const fs::file_status status = fs::status(path, code);
  if (fs::is_directory(status)) refuse(path + ": is a folder; name a file");
  if (fs::exists(status) && !fs::is_regular_file(status))
    refuse(path + ": is not a regular file; name another, or - for standard output");
  if (fs::exists(status) && !force) refuse(path + ": exists already; --force replaces it");
  const fs::path folder = fs::path(path).has_parent_path() ? fs::path(path).parent_path() : fs::path(".");
  if (!fs::is_directory(folder, code)) refuse(path + ": there is no folder " + folder.string());
  if (access(folder.c_str(), W_OK) != 0)
    refuse(path + ": cannot write in " + folder.string() + ": " + std::strerror(errno));
}

void put(std::FILE* file, const std::string& path, const std::string& text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  if (!written || std::fflush(file) != 0) refuse(path + ": " + std::strerror(errno));
}

}  // namespace

std::string preview_path(const std::string& path) {
  const bool named = fs::path(path).extension() == ".vdb";
  return path.substr(0, path.size() - (named ? 4 : 0)) + ".preview.vdb";
}

void check_outputs(const Arguments& a) {
  std::vector<std::string> files = {a.output, a.stats, a.save_shell, a.save_voronoi};
  if (!a.save_voronoi.empty()) files.push_back(preview_path(a.save_voronoi));
  if (a.stop_after == StopAfter::voronoi && !a.output.empty()) files.push_back(preview_path(a.output));
  if (!can_write_vdb() && (a.stop_after != StopAfter::mesh || !a.save_shell.empty() || !a.save_voronoi.empty()))
    refuse("this build writes no .vdb files: leave out --stop-after and --save-..., or build with -DISOSHELL_VDB=ON");
  for (size_t i = 0; i < files.size(); ++i) {
    if (files[i].empty() || files[i] == "-") continue;
    check_output(files[i], a.force);
    for (size_t j = 0; j < i; ++j)
      if (fs::path(files[i]).lexically_normal() == fs::path(files[j]).lexically_normal())
        throw Error(ErrorCode::usage, "write", files[i] + " is named twice; every result needs its own file");
  }
}

void write_text(const std::string& path, const std::string& text) {
  if (path == "-") return put(stdout, "standard output", text);
  const WhileWriting writing;
  const std::string temporary = path + ".tmp" + std::to_string(getpid());
  std::FILE* file = std::fopen(temporary.c_str(), "wb");
  if (!file) refuse(temporary + ": " + std::strerror(errno));
  try {
    put(file, path, text);
  } catch (...) {
    std::fclose(file);
    std::remove(temporary.c_str());
    throw;
  }
  if (std::fclose(file) != 0 || std::rename(temporary.c_str(), path.c_str()) != 0) {
    const std::string why = std::strerror(errno);
    std::remove(temporary.c_str());
    refuse(path + ": " + why);
  }
}

}  // namespace isoshell::tool
