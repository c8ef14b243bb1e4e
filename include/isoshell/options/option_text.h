// Values of options from text, as a command line, a keyword or a job gives them. Every refusal names the option, what
// was given and what may be.
#pragma once

#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "isoshell/error.h"
#include "isoshell/options/option_range.h"
#include "isoshell/remesh.h"

namespace isoshell {

/// Any whole number of 64 bits. Throws: usage.
int64_t parse_whole(const std::string& option, const std::string& text);

/// A whole number from 0 on, of all 64 bits, which a double does not hold. Throws: usage.
uint64_t parse_seed(const std::string& option, const std::string& text);

/// Any number, "nan" and "inf" too, which ranges refuse. Throws: usage.
double parse_real(const std::string& option, const std::string& text);

/// A finite number. Throws: usage.
double parse_number(const std::string& option, const std::string& text);

/// A whole number, 0 to 10^15. Throws: usage.
int64_t parse_count(const std::string& option, const std::string& text);

/// Throws: usage when the value is outside of the range.
void check_range(const std::string& option, double value, const OptionRange& range);

constexpr OptionRange kCreaseDegrees{1, 179};                                 ///< by which faces at a crease may turn
constexpr OptionRange kLengths{0, std::numeric_limits<double>::max(), true};  ///< of edges and voxels

/// The value beside `text` among the choices. Throws: usage, which lists them.
template <class Value>
Value parse_choice(const std::string& option, const std::string& text,
                   std::initializer_list<std::pair<const char*, Value>> choices) {
  std::string names;
  for (const auto& [name, value] : choices) {
    if (text == name) return value;
    names += names.empty() ? name : std::string(", ") + name;
  }
  throw Error(ErrorCode::usage, "options", option + " is '" + text + "'; it must be one of " + names);
}

/// "sheet" or "shell". Throws: usage.
Method parse_method(const std::string& option, const std::string& text);
const char* method_name(Method method);

/// "balanced" or "surface". Throws: usage.
Fit parse_fit(const std::string& option, const std::string& text);
const char* fit_name(Fit fit);

/// "close" or "keep". Throws: usage.
Boundary parse_boundary(const std::string& option, const std::string& text);
const char* boundary_name(Boundary boundary);

/// "off", "auto", or the angle in degrees from which on edges are creases. Throws: usage.
Features parse_features(const std::string& option, const std::string& text);
std::string features_text(const Features& features);

/// Lines of REGION=L; a name may have an equals sign in it. Throws: usage.
std::vector<RegionEdgeLength> parse_region_edge_lengths(const std::string& option, const std::string& text);
std::string region_edge_lengths_text(const std::vector<RegionEdgeLength>& lengths);

/// "keep" or "ignore". Throws: usage.
UvSeams parse_uv_seams(const std::string& option, const std::string& text);
const char* uv_seams_name(UvSeams seams);

/// "all", "none", or names separated by commas. Throws: usage.
std::optional<std::vector<std::string>> parse_attributes(const std::string& option, const std::string& text);
/// Names separated by commas, of which none is empty; `others` are words that stand for them. Throws: usage.
std::vector<std::string> parse_names(const std::string& option, const std::string& text, const std::string& others);
std::string attributes_text(const std::optional<std::vector<std::string>>& attributes);

/// Sets the closing to gaps of this width: "auto", world units, or voxels as "4vox". Throws: usage.
void set_gap_width(const std::string& option, const std::string& text, RemeshOptions& options);
std::string gap_width_text(const RemeshOptions& options);

/// Bytes of "2G", "512M", "1.5k", "4GiB" or plain bytes. Throws: usage.
int64_t parse_size_bytes(const std::string& text);

}  // namespace isoshell
