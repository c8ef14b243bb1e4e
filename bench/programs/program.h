// What the programs share: arguments, times, and the result that they print.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "bench/programs/machine.h"
#include "isoshell/isoshell.h"

namespace isoshell::bench {

/// An option and where its value goes. A bool has no value: its name alone sets it. A list is "1,2,3".
struct Option {
  const char* name;
  const char* value;  ///< as the usage calls it
  std::variant<bool*, int32_t*, int64_t*, double*, std::string*, std::vector<int>*> to;
};

inline void take_value(const std::string& text, int32_t& out) { out = std::atoi(text.c_str()); }
inline void take_value(const std::string& text, int64_t& out) { out = std::atoll(text.c_str()); }
inline void take_value(const std::string& text, double& out) { out = std::atof(text.c_str()); }
inline void take_value(const std::string& text, std::string& out) { out = text; }
inline void take_value(const std::string&, bool& out) { out = true; }
inline void take_value(const std::string& text, std::vector<int>& out) {
  out.clear();
  std::istringstream list(text);
  for (std::string one; std::getline(list, one, ',');) out.push_back(std::atoi(one.c_str()));
}

[[noreturn]] inline void show_usage(const std::string& call, const std::vector<Option>& options) {
  std::string text = "usage: " + call;
  for (const Option& o : options) text += std::string(" [") + o.name + (*o.value ? " " : "") + o.value + "]";
  std::fprintf(stderr, "%s\n", text.c_str());
  std::exit(2);
}

/// Sets what the options name and returns the other words. Ends the program with how to call it where there are fewer
/// words than `least`, or where an option is unknown or has no value.
inline std::vector<std::string> read_arguments(int argc, char** argv, const std::string& call, size_t least,
                                               const std::vector<Option>& options) {
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word.rfind("--", 0) != 0) {
      words.push_back(word);
      continue;
    }
    const auto option = std::find_if(options.begin(), options.end(), [&](const Option& o) { return word == o.name; });
    if (option == options.end()) show_usage(call, options);
    const bool has_value = !std::holds_alternative<bool*>(option->to);
    if (has_value && i + 1 == argc) show_usage(call, options);
    const std::string value = has_value ? argv[++i] : "";
    std::visit([&](auto* out) { take_value(value, *out); }, option->to);
  }
  if (words.size() < least) show_usage(call, options);
  return words;
}

/// Milliseconds since it was made.
class Watch {
 public:
  double ms() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

template <class Work>
double ms_of(Work work) {
  const Watch watch;
  work();
  return watch.ms();
}

struct Spread {
  double median = 0, least = 0, most = 0;
};
inline Spread spread_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {values[values.size() / 2], values.front(), values.back()};
}
/// As KEY_median, KEY_min and KEY_max.
inline void add_spread(nlohmann::json& row, const std::string& key, const Spread& s) {
  row[key + "_median"] = s.median;
  row[key + "_min"] = s.least;
  row[key + "_max"] = s.most;
}

inline std::string file_name(const std::string& path) { return path.substr(path.find_last_of('/') + 1); }

inline LatticeFrame frame_of(const TriangleSoup& soup, int32_t resolution) {
  const auto [lo, hi] = bounding_box(soup);
  return LatticeFrame::around(lo, hi, resolution);
}

/// A context on this backend.
struct BackendContext : Context {
  explicit BackendContext(Backend on, int with_threads = 0) { backend = on, threads = with_threads; }
};

/// JSON on standard output, with where it was measured.
inline void print_result(nlohmann::json result) {
  result["machine"] = machine();
  std::printf("%s\n", result.dump(1).c_str());
}

/// The exit status of a program that an exception ends.
inline int failed(const char* program, const std::exception& error) {
  std::fprintf(stderr, "%s: %s\n", file_name(program).c_str(), error.what());
  return 1;
}

}  // namespace isoshell::bench
