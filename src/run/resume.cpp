#include "run/resume.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "isoshell/error.h"
#include "isoshell/run/option_text.h"

namespace isoshell {
namespace {

AskedOptions kept_options(const std::string& json, const std::string& path) {
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

/// Whether voxels of that size would give the file's grid: LatticeFrame::around turned round.
bool gives_grid(double voxel_size_world, const LatticeFrame& frame) {
  const double longest_world = frame.voxel_size * (frame.resolution - 1);
  return std::floor(longest_world / voxel_size_world + 0.5) + 1 == frame.resolution;
}

bool is_chosen(const RemeshOptions& o) { return !o.closing_vox && !o.closing_world; }

/// Whether a run that asks for this closing would have made the file.
bool gives_closing(const RemeshOptions& asked, const AskedOptions& kept, const StageFile& file) {
  if (is_chosen(asked)) return kept.was_given("close-gaps") && is_chosen(kept.values);
  const double closing_vox =
      asked.closing_world
          ? std::min<double>(std::ceil(*asked.closing_world / file.surface.frame.voxel_size / 2), kMaxClosingVox)
          : double(*asked.closing_vox);
  return closing_vox == file.info.closing_vox;
}

/// Refuses options that differ from what made the file. JSON may give an option and leave its value open, as what
/// options_json writes does: such an option asks for nothing.
class Held {
 public:
  Held(const StageFile& file, const AskedOptions& asked) : stage_(file.info.stage), asked_(asked) {}

  template <class T>
  void check(const char* option, bool same, const T& there) const {
    if (!asked_.was_given(option) || same) return;
    std::ostringstream text;
    text << "--" << option << " is fixed by the " << stage_ << " stage file: it was " << there << "; leave it out";
    throw Error(ErrorCode::usage, "options", text.str());
  }
  template <class T>
  void check(const char* option, const std::optional<T>& asked, const std::optional<T>& kept) const {
    const bool same = !asked || asked == kept;
    if (kept)
      check(option, same, *kept);
    else
      check(option, same, "not given");
  }

 private:
  const std::string& stage_;
  const AskedOptions& asked_;
};

void check_shell(const Held& held, const StageFile& file, const RemeshOptions& asked, const AskedOptions& kept) {
  const LatticeFrame& frame = file.surface.frame;
  held.check("resolution", !asked.resolution || asked.resolution == frame.resolution, frame.resolution);
  held.check("voxel-size", !asked.voxel_size_world || gives_grid(*asked.voxel_size_world, frame), frame.voxel_size);
  held.check("band", asked.band_vox == file.shell.band_vox, file.shell.band_vox);
  held.check("close-gaps", gives_closing(asked, kept, file), std::to_string(2 * file.info.closing_vox) + "vox");
  held.check("boundary", asked.boundary == kept.values.boundary, boundary_name(kept.values.boundary));
  held.check("outer-only", asked.outer_only == kept.values.outer_only, kept.values.outer_only ? "given" : "not given");
}

void check_seeds(const Held& held, int64_t seeds, const AskedOptions& a, const AskedOptions& k) {
  const RemeshOptions &asked = a.values, &kept = k.values;
  held.check("vertices", !asked.vertices || asked.vertices == seeds, seeds);
  held.check("edge-length", asked.edge_length_world, kept.edge_length_world);
  held.check("sizing", a.sizing == k.sizing, k.sizing.empty() ? "not given" : k.sizing);
  held.check("adaptivity", asked.adaptivity == kept.adaptivity, kept.adaptivity);
  held.check("gradation", asked.gradation == kept.gradation, kept.gradation);
  held.check("method", asked.method == kept.method, method_name(kept.method));
  held.check("iterations", asked.max_passes, kept.max_passes);
  held.check("tolerance", asked.tolerance, kept.tolerance);
  held.check("step", asked.max_step_vox, kept.max_step_vox);
  held.check("seed", asked.seed == kept.seed, kept.seed);
  held.check("features", features_text(asked.features) == features_text(kept.features), features_text(kept.features));
}

}  // namespace

AskedOptions adopt_options(const StageFile& file, const std::string& path, const AskedOptions& asked) {
  const AskedOptions kept = kept_options(file.info.options_json, path);
  const Held held(file, asked);
  check_shell(held, file, asked.values, kept);
  if (file.seeds) check_seeds(held, file.seeds->size(), asked, kept);

  AskedOptions settled = asked;
  RemeshOptions& o = settled.values;
  o.band_vox = file.shell.band_vox;
  o.outer_only = kept.values.outer_only;
  o.boundary = kept.values.boundary;
  o.resolution = kept.values.resolution;
  o.voxel_size_world = kept.values.voxel_size_world;
  o.closing_vox = kept.values.closing_vox;
  o.closing_world = kept.values.closing_world;
  const auto keep = [&](const char* option, auto RemeshOptions::*value) {
    if (!asked.was_given(option)) o.*value = kept.values.*value;
  };
  const bool size_given = asked.was_given("vertices") || asked.was_given("edge-length") || asked.was_given("sizing");
  if (!size_given || file.seeds) {
    o.vertices = kept.values.vertices;
    o.edge_length_world = kept.values.edge_length_world;
  }
  keep("iterations", &RemeshOptions::max_passes);
  keep("tolerance", &RemeshOptions::tolerance);
  keep("step", &RemeshOptions::max_step_vox);
  keep("seed", &RemeshOptions::seed);
  keep("uniform-area", &RemeshOptions::uniform_area);
  keep("features", &RemeshOptions::features);
  keep("color-features", &RemeshOptions::color_features);
  keep("adaptivity", &RemeshOptions::adaptivity);
  keep("gradation", &RemeshOptions::gradation);
  keep("fit", &RemeshOptions::fit);
  keep("method", &RemeshOptions::method);
  if (!asked.was_given("sizing")) settled.sizing = kept.sizing;
  return settled;
}

}  // namespace isoshell
