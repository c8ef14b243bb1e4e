#include "options/check_options.h"

#include <sstream>

#include "isoshell/error.h"
#include "isoshell/options/option_table.h"

namespace isoshell {
namespace {

/// All digits that a count or a bound has, where a stream would round to six.
std::string number_text(double value) {
  std::ostringstream text;
  text.precision(10);
  text << value;
  return text.str();
}

}  // namespace

std::string OptionRange::refusal(const std::string& option, double value) const {
  std::string text =
      option + " is " + number_text(value) + "; it must be " + (above ? "more than " : "") + number_text(low);
  if (high == std::numeric_limits<double>::max())
    text += above ? "" : " or more";
  else
    text += (above ? " and at most " : " to ") + number_text(high);
  return text;
}

RemeshOptions checked(RemeshOptions values) {
  AskedOptions options{std::move(values), "", {}};
  for (const OptionRow& row : option_rows()) {
    if (const TextOption* text = std::get_if<TextOption>(&row.member)) {
      if (text->check) text->check(options.values);
      continue;
    }
    set_value(row, row.member_name, value_of(row, options), options);
  }
  check_method(options);
  return std::move(options.values);
}

void check_method(const AskedOptions& options) {
  const RemeshOptions& o = options.values;
  if (o.method != Method::shell) return;
  const auto refuse = [](const char* what) { throw Error(ErrorCode::usage, "options", what); };
  if (o.features.creases == Features::Creases::threshold)
    refuse("--features DEG needs --method sheet: the paper's loop on the shell knows no curves");
  if (o.features.has_lines())
    refuse("lines in --features need --method sheet: the paper's loop on the shell knows no curves");
  if (o.boundary == Boundary::keep)
    refuse("--boundary keep needs --method sheet: the paper's loop on the shell knows no borders");
  if (o.previous)
    refuse("frames that follow one another need --method sheet: the paper's loop on the shell places its seeds anew");
  if (!options.sizing.empty() || o.sizing || o.adaptivity > 0)
    refuse("--sizing and --adaptivity need --method sheet: the paper's loop on the shell has even cells");
}

}  // namespace isoshell
