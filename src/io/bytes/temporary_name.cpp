// See temporary_name.h.
#include "io/bytes/temporary_name.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <atomic>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <optional>

namespace isoshell {
namespace {

namespace fs = std::filesystem;

constexpr char kEnding[] = ".tmp";

/// Up to the number of the process.
std::string beginning() {
  constexpr size_t kMost = 64;
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  std::string name = std::string(host).substr(0, kMost);
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '.') c = '_';
  return ".isoshell-" + name + "-";
}

/// The process that a name which begins as ours do tells; none of any other name.
std::optional<pid_t> process_of(const std::string& name, const std::string& begin) {
  if (name.compare(0, begin.size(), begin) != 0) return {};
  pid_t process = 0;
  uint32_t serial = 0;
  const char *const first = name.data() + begin.size(), *const end = name.data() + name.size();
  const auto [dash, bad] = std::from_chars(first, end, process);
  if (bad != std::errc() || process <= 0 || dash == end || *dash != '-') return {};
  const auto [rest, also_bad] = std::from_chars(dash + 1, end, serial);
  if (also_bad != std::errc() || std::string(rest, end) != kEnding) return {};
  return process;
}

bool has_ended(pid_t process) { return kill(process, 0) != 0 && errno == ESRCH; }

void remove_unless_held(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (file < 0) return;
  if (flock(file, LOCK_EX | LOCK_NB) == 0) unlink(path.c_str());
  close(file);
}

}  // namespace

std::string next_temporary_name() {
  static std::atomic<uint32_t> serial{0};
  return beginning() + std::to_string(getpid()) + "-" + std::to_string(serial++) + kEnding;
}

void remove_leftovers(const std::string& folder) {
  const std::string begin = beginning();
  std::error_code code;
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code)) {
    const std::optional<pid_t> process = process_of(it->path().filename().string(), begin);
    if (process && has_ended(*process)) remove_unless_held(it->path().string());
  }
}

}  // namespace isoshell
