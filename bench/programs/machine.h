// What a bench result must say about where it was measured, and about memory.
#pragma once

#include <sys/utsname.h>
#include <unistd.h>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

namespace isoshell::bench {

inline std::string line_after_colon(const char* path, const std::string& key) {
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);)
    if (line.rfind(key, 0) == 0) {
      const size_t at = line.find_first_not_of(" \t", line.find(':') + 1);
      return at == std::string::npos ? "" : line.substr(at);
    }
  return "";
}

/// Machine, compiler, flags and time of a run.
inline nlohmann::json machine() {
  utsname system{};
  uname(&system);
  char date[32];
  const std::time_t now = std::time(nullptr);
  std::strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
  return {{"cpu", line_after_colon("/proc/cpuinfo", "model name")},
          {"cores", sysconf(_SC_NPROCESSORS_ONLN)},
          {"memory_kb", line_after_colon("/proc/meminfo", "MemTotal")},
          {"system", std::string(system.sysname) + " " + system.release},
          {"compiler", __VERSION__},
          {"flags", ISOSHELL_BENCH_FLAGS},
          {"date", date}};
}

inline double memory_mb(const char* key) {
  return std::atof(line_after_colon("/proc/self/status", key).c_str()) / 1024;
}

/// What a piece of work adds to the process's resident memory at its highest.
class PeakMemory {
 public:
  PeakMemory() {
    std::ofstream("/proc/self/clear_refs") << "5";  // sets VmHWM back to VmRSS
    before_ = memory_mb("VmRSS");
  }
  double mb() const { return memory_mb("VmHWM") - before_; }

 private:
  double before_ = 0;
};

}  // namespace isoshell::bench
