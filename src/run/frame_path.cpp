// Numbers of frames in names of files (see run/sequence.h).
#include <algorithm>
#include <regex>

#include "isoshell/options/option_text.h"
#include "isoshell/run/sequence.h"

namespace isoshell {
namespace {

constexpr int64_t kMostFrames = 10'000'000;

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, "frames", message); }

const std::regex& place() {
  static const std::regex place("#+|%0?([1-9]?)d");
  return place;
}

std::string padded(int64_t number, size_t digits) {
  std::string text = std::to_string(number);
  return std::string(digits > text.size() ? digits - text.size() : 0, '0') + text;
}

}  // namespace

FrameRange parse_frames(const std::string& text) {
  static const std::regex form("([0-9]{1,15})(-([0-9]{1,15})(x([0-9]{1,15}))?)?");
  std::smatch part;
  if (!std::regex_match(text, part, form))
    refuse("--frames is '" + text + "'; it must be as 1-240, 1-240x2 for every second frame, or 7");
  FrameRange frames;
  frames.first = frames.last = std::stoll(part[1]);
  if (part[3].matched) frames.last = std::stoll(part[3]);
  if (part[5].matched) frames.step = std::stoll(part[5]);
  if (frames.last < frames.first) refuse("--frames is '" + text + "'; the last frame comes before the first");
  if (frames.step < 1) refuse("--frames is '" + text + "'; the step must be 1 or more");
  const int64_t count = (frames.last - frames.first) / frames.step + 1;
  if (count > kMostFrames)
    refuse("--frames is '" + text + "', which are " + std::to_string(count) + " frames; at most " +
           std::to_string(kMostFrames) + " go into one sequence");
  return frames;
}

std::string path_of_frame(const std::string& pattern, int64_t frame) {
  std::string path;
  std::smatch found;
  auto from = pattern.cbegin();
  int places = 0;
  for (; std::regex_search(from, pattern.cend(), found, place()); from = found[0].second, ++places) {
    const std::string sign = found[0];
    const size_t digits = sign[0] == '#'          ? sign.size()
                          : found[1].length() > 0 ? size_t(sign[sign.size() - 2] - '0')
                                                  : 1;
    path.append(from, found[0].first);
    path += padded(frame, digits);
  }
  path.append(from, pattern.cend());
  if (places != 1)
    refuse("'" + pattern + "' has " + (places == 0 ? "no place" : "more than one place") +
           " for the number of a frame; with --frames, every file has one, as in mesh.####.ply or mesh.%04d.ply");
  return path;
}

std::string grid_of_frame(const std::string& name, int64_t frame) {
  const GridName named = grid_name_of(name);
  return std::regex_search(named.file, place()) ? path_of_frame(named.file, frame) + ":" + named.grid : name;
}

}  // namespace isoshell
