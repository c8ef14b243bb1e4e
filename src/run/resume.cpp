#include "run/resume.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "isoshell/error.h"
#include "isoshell/options/option_table.h"

namespace isoshell {
namespace {

RequestedOptions kept_options(const std::string& json, const std::string& path) {
  try {
    return parse_options_json(json, UnknownOptions::pass_over);
  } catch (const Error& e) {
    const std::string what = e.what();
    throw Error(
        ErrorCode::unreadable_input, "read",
        e.code() == ErrorCode::usage
            ? path + ": of the options that this stage file keeps, " + what + ": make the file again"
            : path + ": the options kept in this stage file cannot be read (" + what + "); make the file again");
  }
}

bool is_chosen(const RemeshOptions& o) { return !o.closing_vox && !o.closing_world; }

/// Whether a run that asks for this closing would have made the file.
bool gives_closing(const RemeshOptions& requested, const RequestedOptions& kept, const StageFile& file) {
  if (is_chosen(requested)) return kept.was_given("close-gaps") && is_chosen(kept.values);
  const double closing_vox =
      requested.closing_world
          ? std::min<double>(std::ceil(*requested.closing_world / file.surface.frame.voxel_size / 2), kMaxClosingVox)
          : double(*requested.closing_vox);
  return closing_vox == file.info.closing_vox;
}

/// What a stage file holds says of an option more than what made it: whether that agrees with what is asked, and what
/// it was.
struct InFile {
  bool agrees;
  std::string was;
};

/// Of the options whose value the file itself shows.
std::optional<InFile> shown_in_file(const OptionRow& row, const StageFile& file, const RequestedOptions& requested,
                                    const RequestedOptions& kept) {
  const std::string name = row.name;
  const RemeshOptions& o = requested.values;
  const LatticeFrame& frame = file.surface.frame;
  const auto text = [](auto value) {
    std::ostringstream digits;
    digits << value;
    return digits.str();
  };
  if (name == "resolution") return InFile{!o.resolution || o.resolution == frame.resolution, text(frame.resolution)};
  if (name == "band") return InFile{o.band_vox == file.shell.band_vox, text(file.shell.band_vox)};
  if (name == "close-gaps") return InFile{gives_closing(o, kept, file), text(2 * file.info.closing_vox) + "vox"};
  if (name == "vertices") return InFile{!o.vertices || o.vertices == file.seeds->size(), text(file.seeds->size())};
  return std::nullopt;
}

bool is_fixed(const OptionRow& row, const StageFile& file) {
  return row.on_resume == OnResume::of_shell || (row.on_resume == OnResume::of_seeds && file.seeds);
}

/// Refuses an option that differs from what made the file. JSON may give an option and leave its value open, as what
/// options_json writes does: such an option asks for nothing.
void check_fixed(const OptionRow& row, const StageFile& file, const RequestedOptions& requested,
                 const RequestedOptions& kept) {
  const OptionValue value = value_of(row, requested);
  const bool is_open = std::holds_alternative<std::monostate>(value);
  const InFile in_file = shown_in_file(row, file, requested, kept)
                             .value_or(InFile{is_open || value == value_of(row, kept), shown_value(row, kept)});
  if (!in_file.agrees)
    throw Error(ErrorCode::usage, "options",
                "--" + std::string(row.name) + " is fixed by the " + file.info.stage + " stage file: it was " +
                    in_file.was + "; leave it out");
}

}  // namespace

RequestedOptions adopt_options(const StageFile& file, const std::string& path, const RequestedOptions& requested) {
  const RequestedOptions kept = kept_options(file.info.options_json, path);
  RequestedOptions adopted = requested;
  const bool size_given =
      requested.was_given("vertices") || requested.was_given("edge-length") || requested.was_given("sizing");
  for (const OptionRow& row : option_rows()) {
    const std::string name = row.name;
    const bool fixed = is_fixed(row, file);
    if (fixed && requested.was_given(name)) check_fixed(row, file, requested, kept);
    const bool given = name == "vertices" || name == "edge-length" ? size_given : requested.was_given(name);
    // A lattice that is there takes no more than what made it.
    if (row.on_resume != OnResume::of_run && (!given || fixed)) set_value(row, name, value_of(row, kept), adopted);
  }
  adopted.values.band_vox = file.shell.band_vox;
  return adopted;
}

}  // namespace isoshell
