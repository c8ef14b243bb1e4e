// What is done with any option of the table.
#include <locale>
#include <sstream>
#include <type_traits>

#include "isoshell/options/option_table.h"
#include "isoshell/options/option_text.h"

namespace isoshell {
namespace {

template <class T>
struct Plain {
  using Type = T;
  static constexpr bool is_optional = false;
};
template <class T>
struct Plain<std::optional<T>> {
  using Type = T;
  static constexpr bool is_optional = true;
};
/// Of what OptionValue holds.
template <class T>
using Held = std::conditional_t<std::is_same_v<T, int32_t>, int64_t, T>;

/// Calls `text(option)` or `value(member)`.
template <class Text, class Value>
decltype(auto) visit_member(const OptionRow& row, Text&& text, Value&& value) {
  return std::visit(
      [&](const auto& member) {
        if constexpr (std::is_same_v<std::decay_t<decltype(member)>, TextOption>)
          return text(member);
        else
          return value(member);
      },
      row.member);
}

template <class T>
T parsed(const std::string& shown_name, const std::string& text) {
  if constexpr (std::is_same_v<T, bool>)
    return true;
  else if constexpr (std::is_same_v<T, uint64_t>)
    return parse_seed(shown_name, text);
  else if constexpr (std::is_same_v<T, int64_t>)
    return parse_whole(shown_name, text);
  else
    return parse_real(shown_name, text);
}

}  // namespace

bool OptionRow::is_real() const {
  return std::holds_alternative<double RunOptions::*>(member) ||
         std::holds_alternative<std::optional<double> RunOptions::*>(member);
}

bool OptionRow::repeats() const {
  return visit_member(
      *this, [](const TextOption& option) { return option.repeats; }, [](auto) { return false; });
}

bool OptionRow::may_be_open() const {
  return visit_member(
      *this, [](const TextOption&) { return false; },
      [](auto value) { return Plain<std::decay_t<decltype(RunOptions().*value)>>::is_optional; });
}

OptionValue value_of(const OptionRow& row, const RequestedOptions& options) {
  return visit_member(
      row, [&](const TextOption& text) -> OptionValue { return text.text(options); },
      [&](auto member) -> OptionValue {
        const auto& value = options.values.*member;
        using Member = Plain<std::decay_t<decltype(value)>>;
        if constexpr (Member::is_optional)
          return value && double(*value) != row.former ? OptionValue(Held<typename Member::Type>(*value))
                                                       : OptionValue();
        else
          return Held<typename Member::Type>(value);
      });
}

void set_value(const OptionRow& row, const std::string& shown_name, const OptionValue& value,
               RequestedOptions& options) {
  visit_member(
      row, [&](const TextOption& text) { text.parse(shown_name, std::get<std::string>(value), options); },
      [&](auto member) {
        auto& to = options.values.*member;
        using Member = Plain<std::decay_t<decltype(to)>>;
        using T = typename Member::Type;
        if constexpr (Member::is_optional)
          if (std::holds_alternative<std::monostate>(value)) return to.reset();
        const Held<T> given = std::get<Held<T>>(value);
        if constexpr (!std::is_same_v<T, bool> && !std::is_same_v<T, uint64_t>)
          check_range(shown_name, double(given), row.range);
        to = T(given);
      });
}

void set_from_text(const OptionRow& row, const std::string& shown_name, const std::string& text,
                   RequestedOptions& options) {
  const OptionValue value = visit_member(
      row, [&](const TextOption&) -> OptionValue { return text; },
      [&](auto member) -> OptionValue {
        using Member = Plain<std::decay_t<decltype(options.values.*member)>>;
        return parsed<Held<typename Member::Type>>(shown_name, text);
      });
  set_value(row, shown_name, value, options);
}

std::string shown_value(const OptionRow& row, const RequestedOptions& options) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  std::visit(
      [&](const auto& value) {
        using T = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<T, bool>)
          text << (value ? "given" : "");
        else if constexpr (!std::is_same_v<T, std::monostate>)
          text << value;
      },
      value_of(row, options));
  return text.str().empty() ? "not given" : text.str();
}

}  // namespace isoshell
