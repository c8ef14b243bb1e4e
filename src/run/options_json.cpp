#include "isoshell/run/options_json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "isoshell/run/option_text.h"

namespace isoshell {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kCloseGaps = "close-gaps";
constexpr const char* kSizing = "sizing";

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, "options", message); }

/// Less than 0 is what stood for no value.
Json gap_width(const RemeshOptions& o) {
  if (o.closing_world >= 0.) return *o.closing_world;
  return o.closing_vox >= 0 ? std::to_string(2 * *o.closing_vox) + "vox" : "auto";
}

/// Reads the members of one object by name.
class Members {
 public:
  Members(const Json& object, std::vector<std::string>& given) : object_(object), given_(given) {}

  /// `former` stands for an option that has no value, in files of every version.
  template <class T>
  void take(const char* name, std::optional<T>& value, const OptionRange& range, T former) {
    const Json* member = find(name);
    if (!member) return;
    const double number = number_in(name, *member, std::is_integral_v<T>);
    value.reset();
    if (number == double(former)) return;
    check_range(name, number, range);
    value = member->get<T>();
  }
  template <class T>
  void take(const char* name, T& value, const OptionRange& range) {
    const Json* member = find(name);
    if (!member) return;
    check_range(name, number_in(name, *member, std::is_integral_v<T>), range);
    value = member->get<T>();
  }
  void take(const char* name, bool& value) {
    const Json* member = find(name);
    if (!member) return;
    if (!member->is_boolean()) refuse_type(name, *member, "true or false");
    value = member->get<bool>();
  }
  /// All 64 bits, which a double does not hold.
  void take(const char* name, uint64_t& value) {
    const Json* member = find(name);
    if (!member) return;
    const bool fits = member->is_number_float() ? is_whole(*member) && *member >= 0. && *member < 0x1p64
                                                : member->is_number_unsigned();
    if (!fits) refuse_type(name, *member, "a whole number, 0 to 18446744073709551615");
    value = member->get<uint64_t>();
  }
  std::optional<std::string> text(const char* name) {
    const Json* member = find(name);
    if (!member) return std::nullopt;
    if (!member->is_string()) refuse_type(name, *member, "text");
    return member->get<std::string>();
  }
  /// Text, or a number as text.
  std::optional<std::string> text_or_number(const char* name) {
    const Json* member = find(name);
    if (!member) return std::nullopt;
    return member->is_number() ? member->dump() : text(name);
  }

  void refuse_others() const {
    for (const auto& item : object_.items())
      if (std::find(known_.begin(), known_.end(), item.key()) == known_.end())
        refuse("there is no option '" + item.key() + "'");
  }

 private:
  const Json* find(const char* name) {
    if (std::find(known_.begin(), known_.end(), name) == known_.end()) known_.push_back(name);
    const auto at = object_.find(name);
    if (at == object_.end() || at->is_null()) return nullptr;
    if (std::find(given_.begin(), given_.end(), name) == given_.end()) given_.push_back(name);
    return &*at;
  }

  [[noreturn]] static void refuse_type(const char* name, const Json& member, const char* wanted) {
    refuse(std::string(name) + " is " + member.dump() + "; it must be " + wanted);
  }

  /// 10000.0 is whole: some writers of JSON know only one kind of number.
  static bool is_whole(const Json& member) {
    return member.is_number() && std::floor(member.get<double>()) == member.get<double>();
  }

  static double number_in(const char* name, const Json& member, bool whole) {
    if (!(whole ? is_whole(member) : member.is_number()))
      refuse_type(name, member, whole ? "a whole number" : "a number");
    return member.get<double>();
  }

  const Json& object_;
  std::vector<std::string>& given_;
  std::vector<std::string> known_;
};

Json json_of(const RemeshOptions& o) {
  return {{"vertices", o.vertices.value_or(0)},
          {"edge-length", o.edge_length_world.value_or(0)},
          {"band", o.band_vox},
          {"outer-only", o.outer_only},
          {"method", method_name(o.method)},
          {"iterations", o.max_passes.value_or(0)},
          {"tolerance", o.tolerance.value_or(-1)},
          {"step", o.max_step_vox.value_or(0)},
          {"seed", o.seed},
          {"fit", fit_name(o.fit)},
          {"uniform-area", o.uniform_area},
          {"features", features_text(o.features)},
          {"boundary", boundary_name(o.boundary)},
          {"attributes", attributes_text(o.attributes)},
          {"color-features", o.color_features},
          {"adaptivity", o.adaptivity},
          {"gradation", o.gradation},
          {kSizing, o.sizing ? o.sizing->source() : ""},
          {"resolution", o.resolution.value_or(0)},
          {"voxel-size", o.voxel_size_world.value_or(0)},
          {kCloseGaps, gap_width(o)}};
}

Json parse_object(const std::string& json) {
  try {
    Json object = Json::parse(json);
    if (object.is_object()) return object;
  } catch (const Json::exception& e) {
    throw Error(ErrorCode::unreadable_input, "options", e.what());
  }
  throw Error(ErrorCode::unreadable_input, "options", "they are no JSON object");
}

}  // namespace

bool AskedOptions::was_given(const std::string& name) const {
  return std::find(given.begin(), given.end(), name) != given.end();
}

AskedOptions asked_options(RemeshOptions values, std::string sizing) {
  AskedOptions asked{std::move(values), std::move(sizing), {}};
  Json options = json_of(asked.values);
  if (!asked.sizing.empty()) options[kSizing] = asked.sizing;
  const Json unasked = json_of({});
  for (const auto& option : options.items())
    if (option.value() != unasked[option.key()]) asked.given.push_back(option.key());
  return asked;
}

std::string options_json(const RemeshOptions& o) {
  return json_of(o).dump(-1, ' ', false, Json::error_handler_t::replace);  // a file's name may be any bytes
}

AskedOptions parse_options_json(const std::string& json, UnknownOptions unknown) {
  const Json object = parse_object(json);
  AskedOptions asked;
  RemeshOptions& o = asked.values;
  Members members(object, asked.given);
  members.take<int64_t>("vertices", o.vertices, option_range::vertices, 0);
  members.take<double>("edge-length", o.edge_length_world, option_range::length, 0);
  members.take("band", o.band_vox, option_range::band);
  members.take("outer-only", o.outer_only);
  if (const auto text = members.text("method")) o.method = parse_method("method", *text);
  members.take<int32_t>("iterations", o.max_passes, option_range::iterations, 0);
  members.take<double>("tolerance", o.tolerance, option_range::tolerance, -1);
  members.take<double>("step", o.max_step_vox, option_range::step, 0);
  members.take("seed", o.seed);
  if (const auto text = members.text("fit")) o.fit = parse_fit("fit", *text);
  members.take("uniform-area", o.uniform_area);
  if (const auto text = members.text_or_number("features")) o.features = parse_features("features", *text);
  if (const auto text = members.text("boundary")) o.boundary = parse_boundary("boundary", *text);
  if (const auto text = members.text("attributes")) o.attributes = parse_attributes("attributes", *text);
  members.take("color-features", o.color_features);
  members.take("adaptivity", o.adaptivity, option_range::adaptivity);
  members.take("gradation", o.gradation, option_range::gradation);
  asked.sizing = members.text(kSizing).value_or("");
  members.take<int32_t>("resolution", o.resolution, option_range::resolution, 0);
  members.take<double>("voxel-size", o.voxel_size_world, option_range::length, 0);
  if (const auto text = members.text_or_number(kCloseGaps)) set_gap_width(kCloseGaps, *text, o);
  if (unknown == UnknownOptions::refuse) members.refuse_others();
  return asked;
}

void check_method(const AskedOptions& options) {
  if (options.values.method == Method::shell && options.values.features.creases == Features::Creases::threshold)
    refuse("--features DEG needs --method sheet: the paper's loop on the shell knows no curves");
  if (options.values.method == Method::shell && options.values.features.has_lines())
    refuse("lines in --features need --method sheet: the paper's loop on the shell knows no curves");
  if (options.values.method == Method::shell && options.values.boundary == Boundary::keep)
    refuse("--boundary keep needs --method sheet: the paper's loop on the shell knows no borders");
  if (options.values.method == Method::shell &&
      (!options.sizing.empty() || options.values.sizing || options.values.adaptivity > 0))
    refuse("--sizing and --adaptivity need --method sheet: the paper's loop on the shell has even cells");
}

}  // namespace isoshell
