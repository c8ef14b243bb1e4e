// Messages and progress.
#include "vdb_isomesh/console.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>

namespace isoshell::tool {
namespace {

constexpr auto kRedrawAfter = std::chrono::milliseconds(80);
constexpr int kBarWidth = 30;

bool is_terminal() { return isatty(STDERR_FILENO) != 0; }

bool wants_colour() {
  const char* no_colour = std::getenv("NO_COLOR");
  const char* term = std::getenv("TERM");
  return is_terminal() && !(no_colour && *no_colour) && term && std::string(term) != "dumb";
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
  clear_bar();
  const bool coloured = colour_ && *colour;
  std::fprintf(stderr, "%s: %s%s%s%s\n", program_, coloured ? colour : "", label, coloured ? "\033[0m" : "",
               message.c_str());
}

void Console::progress(const std::string& stage, double fraction) {
  if (progress_ == ProgressMode::never) return;
  const auto now = std::chrono::steady_clock::now();
  const bool same = stage == last_stage_;
  if (same && (fraction == last_fraction_ || (fraction < 1 && now - last_drawn_ < kRedrawAfter))) return;
  last_stage_ = stage;
  last_fraction_ = fraction;
  last_drawn_ = now;
  if (progress_ == ProgressMode::json) {
    const double ms = std::chrono::duration<double, std::milli>(now - start_).count();
    std::fprintf(stderr, "{\"stage\": \"%s\", \"fraction\": %.3f, \"ms\": %.1f}\n", stage.c_str(), fraction, ms);
  } else {
    draw_bar(stage, fraction);
  }
}

void Console::draw_bar(const std::string& stage, double fraction) {
  const int full = int(fraction * kBarWidth + 0.5);
  std::string bar(size_t(full), '#');
  bar.resize(kBarWidth, '.');
  std::fprintf(stderr, "\r%-12s [%s] %3d %%", stage.c_str(), bar.c_str(), int(fraction * 100 + 0.5));
  std::fflush(stderr);
  bar_drawn_ = true;
}

void Console::clear_bar() {
  if (!bar_drawn_) return;
  std::fprintf(stderr, "\r%*s\r", kBarWidth + 24, "");
  std::fflush(stderr);
  bar_drawn_ = false;
}

}  // namespace isoshell::tool
