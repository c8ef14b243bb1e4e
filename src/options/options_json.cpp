#include "isoshell/options/options_json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "isoshell/error.h"
#include "isoshell/options/option_table.h"
#include "isoshell/options/option_text.h"

namespace isoshell {
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, "options", message); }

Json json_of(const OptionRow& row, const RequestedOptions& options) {
  const OptionValue value = value_of(row, options);
  if (std::holds_alternative<std::monostate>(value))
    return row.is_real() ? Json(row.former) : Json(int64_t(row.former));
  const TextOption* text = std::get_if<TextOption>(&row.member);
  if (text && text->number == TextOption::Number::written) {
    const Json number = Json::parse(std::get<std::string>(value), nullptr, false);
    if (number.is_number()) return number;
  }
  return std::visit(
      [](const auto& plain) -> Json {
        if constexpr (std::is_same_v<std::decay_t<decltype(plain)>, std::monostate>)
          return nullptr;
        else
          return plain;
      },
      value);
}

[[noreturn]] void refuse_type(const char* name, const Json& member, const char* wanted) {
  refuse(std::string(name) + " is " + member.dump() + "; it must be " + wanted);
}

/// 10000.0 is whole: some writers of JSON know only one kind of number.
bool is_whole(const Json& member) {
  return member.is_number() && std::floor(member.get<double>()) == member.get<double>();
}

OptionValue number_in(const OptionRow& row, const Json& member) {
  if (!(row.is_real() ? member.is_number() : is_whole(member)))
    refuse_type(row.name, member, row.is_real() ? "a number" : "a whole number");
  const double number = member.get<double>();
  if (row.may_be_open() && number == row.former) return {};
  if (row.is_real()) return number;
  check_range(row.name, number, row.range);  // before what a whole number does not hold
  return member.get<int64_t>();
}

/// All 64 bits, which a double does not hold.
OptionValue seed_in(const OptionRow& row, const Json& member) {
  const bool fits =
      member.is_number_float() ? is_whole(member) && member >= 0. && member < 0x1p64 : member.is_number_unsigned();
  if (!fits) refuse_type(row.name, member, "a whole number, 0 to 18446744073709551615");
  return member.get<uint64_t>();
}

OptionValue text_in(const OptionRow& row, const Json& member) {
  const bool may_be_number = std::get<TextOption>(row.member).number != TextOption::Number::refused;
  if (may_be_number && member.is_number()) return member.dump();
  if (!member.is_string()) refuse_type(row.name, member, "text");
  return member.get<std::string>();
}

OptionValue value_in(const OptionRow& row, const Json& member) {
  if (row.is_text()) return text_in(row, member);
  if (row.is_seed()) return seed_in(row, member);
  if (!row.is_flag()) return number_in(row, member);
  if (!member.is_boolean()) refuse_type(row.name, member, "true or false");
  return member.get<bool>();
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

void refuse_others(const Json& object) {
  const std::vector<OptionRow>& rows = option_rows();
  for (const auto& item : object.items())
    if (std::none_of(rows.begin(), rows.end(), [&](const OptionRow& row) { return item.key() == row.name; }))
      refuse("there is no option '" + item.key() + "'");
}

}  // namespace

bool RequestedOptions::was_given(const std::string& name) const {
  return std::find(given.begin(), given.end(), name) != given.end();
}

RequestedOptions requested_options(RunOptions values, std::string sizing) {
  RequestedOptions requested{std::move(values), std::move(sizing), {}};
  for (const OptionRow& row : option_rows())
    if (value_of(row, requested) != value_of(row, {})) requested.given.push_back(row.name);
  return requested;
}

std::string options_json(const RunOptions& options) {
  const RequestedOptions requested{options, "", {}};
  Json object = Json::object();
  for (const OptionRow& row : option_rows()) object[row.name] = json_of(row, requested);
  return object.dump(-1, ' ', false, Json::error_handler_t::replace);  // a file's name may be any bytes
}

RequestedOptions parse_options_json(const std::string& json, UnknownOptions unknown) {
  const Json object = parse_object(json);
  RequestedOptions requested;
  for (const OptionRow& row : option_rows()) {
    const auto at = object.find(row.name);
    if (at == object.end() || at->is_null()) continue;
    requested.given.push_back(row.name);
    set_value(row, row.name, value_in(row, *at), requested);
  }
  if (unknown == UnknownOptions::refuse) refuse_others(object);
  return requested;
}

}  // namespace isoshell
