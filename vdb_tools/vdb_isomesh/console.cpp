// Messages and progress.
#include "vdb_isomesh/console.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>

namespace isoshell::tool {
namespace {

constexpr int kBarWidth = 30;

bool is_terminal() { return isatty(STDERR_FILENO) != 0; }

bool wants_colour() {
  const char* no_colour = std::getenv("NO_COLOR");
  const char* term = std::getenv("TERM");
  return is_terminal() && !(no_colour && *no_colour) && term && std::string(term) != "dumb";
}

/// As people say it.
std::string duration(double seconds) {
  char text[32];
  if (seconds < 90)
    std::snprintf(text, sizeof text, "%.0f s", seconds);
  else if (seconds < 5400)
    std::snprintf(text, sizeof text, "%.0f min", seconds / 60);
  else
    std::snprintf(text, sizeof text, "%.1f h", seconds / 3600);
  return text;
}

}  // namespace

Console::Console(ProgressMode progress, int verbosity, const char* program)
    : progress_(progress),
      verbosity_(verbosity),
      program_(program),
      colour_(wants_colour()),
      start_(std::chrono::steady_clock::now()) {
  if (progress_ == ProgressMode::automatic)
    progress_ = is_terminal() && verbosity_ > 0 ? ProgressMode::always : ProgressMode::never;
}

void Console::error(const std::string& message) { print("error: ", "\033[1;31m", message); }
void Console::warn(const std::string& message) {
  if (verbosity_ >= 1) print("warning: ", "\033[1;33m", message);
}
void Console::result(const std::string& message) {
  if (verbosity_ >= 1) print("", "", message);
}
void Console::detail(const std::string& message) {
  if (verbosity_ >= 2) print("", "", message);
}

void Console::print(const char* label, const char* colour, const std::string& message) {
  const std::lock_guard lock(mutex_);
  clear_bar();
  const bool coloured = colour_ && *colour;
  std::fprintf(stderr, "%s: %s%s%s%s\n", program_, coloured ? colour : "", label, coloured ? "\033[0m" : "",
               message.c_str());
}

void Console::progress(const Progress& progress) {
  if (progress_ == ProgressMode::never) return;
  const std::lock_guard lock(mutex_);
  if (progress_ == ProgressMode::always) return draw_bar(progress);
  const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  std::fprintf(
      stderr,
      "{\"stage\": \"%s\", \"fraction\": %.5f, \"stage_fraction\": %.5f, \"seconds_left\": %.2f, \"ms\": %.1f}\n",
      progress.stage, progress.fraction, progress.stage_fraction, progress.seconds_left, ms);
}

void Console::draw_bar(const Progress& progress) {
  std::string bar(size_t(progress.fraction * kBarWidth), '#');
  bar.resize(kBarWidth, '.');
  std::fprintf(stderr, "\r%-12s [%s] %3d %%, %s left  ", progress.stage, bar.c_str(), int(progress.fraction * 100),
               duration(progress.seconds_left).c_str());
  std::fflush(stderr);
  bar_drawn_ = true;
}

void Console::clear_bar() {
  if (!bar_drawn_) return;
  std::fprintf(stderr, "\r%*s\r", kBarWidth + 42, "");
  std::fflush(stderr);
  bar_drawn_ = false;
}

}  // namespace isoshell::tool
