#include "options/check_options.h"

#include "isoshell/error.h"
#include "isoshell/options/option_table.h"

namespace isoshell {
RemeshOptions checked(RemeshOptions values) {
  RequestedOptions options{std::move(values), "", {}};
  for (const OptionRow& row : option_rows()) {
    if (const TextOption* text = std::get_if<TextOption>(&row.member)) {
      if (text->check) text->check(options.values);
      continue;
    }
    set_value(row, row.member_name, value_of(row, options), options);
  }
  check_together(options);
  return std::move(options.values);
}

void check_together(const RequestedOptions& options) {
  const RunOptions& o = options.values;
  const auto refuse = [](const char* what) { throw Error(ErrorCode::usage, "options", what); };
  if (o.snap_world && o.regions.empty())
    refuse(
        "--snap is for the parts of a mesh: say what they are by --regions, as --regions components, or leave it out");
  if (o.method != Method::shell) return;
  if (o.features.creases == Features::Creases::threshold)
    refuse("--features DEG needs --method sheet: the paper's loop on the shell knows no curves");
  if (o.has_lines()) refuse("lines in --features need --method sheet: the paper's loop on the shell knows no curves");
  if (o.boundary == Boundary::keep)
    refuse("--boundary keep needs --method sheet: the paper's loop on the shell knows no borders");
  if (o.previous)
    refuse("frames that follow one another need --method sheet: the paper's loop on the shell places its seeds anew");
  if (!options.sizing.empty() || o.sizing || o.adaptivity > 0)
    refuse("--sizing and --adaptivity need --method sheet: the paper's loop on the shell has even cells");
}

}  // namespace isoshell
