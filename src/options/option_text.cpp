#include "isoshell/options/option_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <locale>
#include <sstream>

#include "core/file_format.h"

namespace isoshell {
namespace {

constexpr int kShownDigits = 10;  // of a count or a bound all, where a stream would round to six

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, "options", message); }

/// Of all of `text`, before which one plus may stand.
template <class Number>
bool holds_number(const std::string& text, Number& value) {
  const char *end = text.data() + text.size(), *begin = text.data() + (text.size() > 1 && text[0] == '+');
  const auto [stop, failed] = std::from_chars(begin, end, value);
  return failed == std::errc() && stop == end;
}

/// With all digits that a double has, or fewer.
std::string number_text(double value, int digits = 17) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(digits);
  text << value;
  return text.str();
}

}  // namespace

int64_t parse_whole(const std::string& option, const std::string& text) {
  int64_t value = 0;
  if (!holds_number(text, value)) refuse(option + " is '" + text + "'; it must be a whole number");
  return value;
}

uint64_t parse_seed(const std::string& option, const std::string& text) {
  uint64_t value = 0;
  if (!holds_number(text, value))
    refuse(option + " is '" + text + "'; it must be a whole number, 0 to 18446744073709551615");
  return value;
}

double parse_real(const std::string& option, const std::string& text) {
  double value = 0;
  if (!holds_number(text, value)) refuse(option + " is '" + text + "'; it must be a number");
  return value;
}

double parse_number(const std::string& option, const std::string& text) {
  double value = 0;
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  if (!(stream >> value) || !stream.eof() || !std::isfinite(value))
    refuse(option + " is '" + text + "'; it must be a number");
  return value;
}

int64_t parse_count(const std::string& option, const std::string& text) {
  const double value = parse_number(option, text);
  if (value != std::floor(value) || value < 0 || value > 1e15)
    refuse(option + " is '" + text + "'; it must be a whole number, 0 or more");
  return int64_t(value);
}

std::string OptionRange::refusal(const std::string& option, double value) const {
  std::string text = option + " is " + number_text(value, kShownDigits) + "; it must be " +
                     (above ? "more than " : "") + number_text(low, kShownDigits);
  if (high == std::numeric_limits<double>::max())
    text += above ? "" : " or more";
  else
    text += (above ? " and at most " : " to ") + number_text(high, kShownDigits);
  if (!std::isfinite(value)) text += " and finite";
  return text;
}

void check_range(const std::string& option, double value, const OptionRange& range) {
  if (!range.holds(value)) refuse(range.refusal(option, value));
}

Method parse_method(const std::string& option, const std::string& text) {
  return parse_choice<Method>(option, text, {{"sheet", Method::sheet}, {"shell", Method::shell}});
}

const char* method_name(Method method) { return method == Method::shell ? "shell" : "sheet"; }

Fit parse_fit(const std::string& option, const std::string& text) {
  return parse_choice<Fit>(option, text, {{"balanced", Fit::balanced}, {"surface", Fit::surface}});
}

const char* fit_name(Fit fit) { return fit == Fit::surface ? "surface" : "balanced"; }

Boundary parse_boundary(const std::string& option, const std::string& text) {
  return parse_choice<Boundary>(option, text, {{"close", Boundary::close}, {"keep", Boundary::keep}});
}

const char* boundary_name(Boundary boundary) { return boundary == Boundary::keep ? "keep" : "close"; }

UvSeams parse_uv_seams(const std::string& option, const std::string& text) {
  return parse_choice<UvSeams>(option, text, {{"keep", UvSeams::keep}, {"ignore", UvSeams::ignore}});
}

const char* uv_seams_name(UvSeams seams) { return seams == UvSeams::ignore ? "ignore" : "keep"; }

Features parse_features(const std::string& option, const std::string& text) {
  Features features;
  if (text == "off") {
    features.creases = Features::Creases::off;
  } else if (text != "auto") {
    features.creases = Features::Creases::threshold;
    features.degrees = parse_number(option + " is neither off nor auto: the angle of creases", text);
    check_range(option, features.degrees, kCreaseDegrees);
  }
  return features;
}

std::string features_text(const Features& features) {
  if (features.creases == Features::Creases::threshold) return number_text(features.degrees);
  return features.creases == Features::Creases::off ? "off" : "auto";
}

std::vector<RegionEdgeLength> parse_region_edge_lengths(const std::string& option, const std::string& text) {
  std::vector<RegionEdgeLength> lengths;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const size_t equals = line.rfind('=');
    if (equals == std::string::npos || equals == 0)
      refuse(option + " is '" + line + "'; it must be a label or a name of a region, = and a length, as 7=0.5");
    const std::string region = line.substr(0, equals);
    lengths.push_back({region, parse_real(option + " of region " + region, line.substr(equals + 1))});
    check_range(option + " of region " + region, lengths.back().edge_length_world, kLengths);
  }
  return lengths;
}

std::string region_edge_lengths_text(const std::vector<RegionEdgeLength>& lengths) {
  std::string text;
  for (const RegionEdgeLength& l : lengths)
    text += (text.empty() ? "" : "\n") + l.region + "=" + number_text(l.edge_length_world);
  return text;
}

std::optional<std::vector<std::string>> parse_attributes(const std::string& option, const std::string& text) {
  if (text == "all") return std::nullopt;
  if (text == "none") return std::vector<std::string>();
  return parse_names(option, text, "all, none, or ");
}

std::vector<std::string> parse_names(const std::string& option, const std::string& text, const std::string& others) {
  std::vector<std::string> names;
  std::istringstream parts(text + ",");
  for (std::string name; std::getline(parts, name, ',');) {
    if (name.empty()) refuse(option + " is '" + text + "'; it must be " + others + "names separated by commas");
    names.push_back(name);
  }
  return names;
}

std::string attributes_text(const std::optional<std::vector<std::string>>& attributes) {
  if (!attributes) return "all";
  if (attributes->empty()) return "none";
  std::string text;
  for (const std::string& name : *attributes) text += (text.empty() ? "" : ",") + name;
  return text;
}

void set_gap_width(const std::string& option, const std::string& text, RemeshOptions& options) {
  options.closing_vox.reset();
  options.closing_world.reset();
  if (text == "auto") return;
  const size_t unit = text.find("vox");
  const bool voxels = unit != std::string::npos && unit + 3 == text.size();
  const double width = parse_number(option, voxels ? text.substr(0, unit) : text);
  if (width < 0) refuse(option + " is " + text + "; a width is 0 or more");
  if (voxels) check_range(option + " in voxels", width, {0, 2 * kMaxClosingVox});
  if (voxels || width == 0)
    options.closing_vox = int32_t(std::ceil(width / 2));
  else
    options.closing_world = width;
}

std::string gap_width_text(const RemeshOptions& options) {
  if (options.closing_world >= 0.) return number_text(*options.closing_world);
  return options.closing_vox >= 0 ? std::to_string(2 * *options.closing_vox) + "vox" : "auto";
}

int64_t parse_size_bytes(const std::string& text) {
  const size_t end = std::min(text.find_first_not_of("0123456789.+-eE"), text.size());
  const std::string unit = lower_case(text.substr(end));
  const int64_t scale = parse_choice<int64_t>("the unit of a size", unit.empty() ? "bytes" : unit,
                                              {{"bytes", 1},
                                               {"b", 1},
                                               {"k", 1ll << 10},
                                               {"kb", 1ll << 10},
                                               {"kib", 1ll << 10},
                                               {"m", 1ll << 20},
                                               {"mb", 1ll << 20},
                                               {"mib", 1ll << 20},
                                               {"g", 1ll << 30},
                                               {"gb", 1ll << 30},
                                               {"gib", 1ll << 30},
                                               {"t", 1ll << 40},
                                               {"tb", 1ll << 40},
                                               {"tib", 1ll << 40}});
  const double bytes = parse_number("the size", text.substr(0, end)) * double(scale);
  if (!(bytes >= 1) || bytes > 9e18) refuse("the size '" + text + "' must be more than 0");
  return int64_t(bytes);
}

}  // namespace isoshell
