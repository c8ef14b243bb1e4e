// The options of a run that a stage file keeps, and those of a run that goes on from it.
#include "vdb_isomesh/stage_options.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "isoshell/error.h"
#include "isoshell/option_range.h"

namespace isoshell::tool {
namespace {

using Json = nlohmann::ordered_json;

const char* method_name(Method method) { return method == Method::shell ? "shell" : "sheet"; }
const char* fit_name(Fit fit) { return fit == Fit::surface ? "surface" : "balanced"; }

struct Kept {
  RemeshOptions options;
  std::string sizing;
};

Kept parse_kept(const std::string& json, const std::string& path) {
  try {
    const Json j = Json::parse(json);
    Kept kept;
    RemeshOptions& o = kept.options;
    const auto take = [&](const char* name, auto& value) { value = j.at(name).get<std::decay_t<decltype(value)>>(); };
    /// `unset` stands for an option that was not given.
    const auto take_within = [&](const char* name, auto& value, const OptionRange& range, double unset) {
      const double number = j.at(name).get<double>();
      if (number != unset && !range.holds(number))
        throw Error(ErrorCode::unreadable_input, "read",
                    path + ": of the options that this stage file keeps, " + range.refusal(name, number) +
                        ": make the file again");
      take(name, value);
    };
    take_within("vertices", o.vertices, option_range::vertices, 0);
    take_within("edge-length", o.edge_length_world, option_range::length, 0);
    take_within("iterations", o.max_passes, option_range::iterations, 0);
    take_within("tolerance", o.tolerance, option_range::tolerance, -1);
    take_within("step", o.max_step_vox, option_range::step, 0);
    take("seed", o.seed);
    take("uniform-area", o.uniform_area);
    if (j.contains("adaptivity")) take_within("adaptivity", o.adaptivity, option_range::adaptivity, 0);
    if (j.contains("gradation")) take_within("gradation", o.gradation, option_range::gradation, 1.2);
    o.outer_only = j.value("outer-only", false);
    o.fit = j.at("fit") == "surface" ? Fit::surface : Fit::balanced;
    o.method = j.at("method") == "shell" ? Method::shell : Method::sheet;
    kept.sizing = j.value("sizing", "");
    return kept;
  } catch (const Json::exception& e) {
    throw Error(ErrorCode::unreadable_input, "read",
                path + ": the options kept in this stage file cannot be read (" + e.what() + "); make the file again");
  }
}

/// Whether voxels of that size would give the file's grid: LatticeFrame::around turned round.
bool gives_grid(double voxel_size_world, const LatticeFrame& frame) {
  const double longest_world = frame.voxel_size * (frame.resolution - 1);
  return std::floor(longest_world / voxel_size_world + 0.5) + 1 == frame.resolution;
}

/// -1 when the run may choose: which it did, the file does not say.
double closing_vox(const RemeshOptions& o, const LatticeFrame& frame) {
  return o.closing_world >= 0 ? std::ceil(o.closing_world / frame.voxel_size / 2) : o.closing_vox;
}

/// Refuses options that differ from what made the file.
class Held {
 public:
  Held(const StageFile& file, const Arguments& a) : stage_(file.info.stage), a_(a) {}

  template <class T>
  void check(const char* option, bool same, const T& there) const {
    if (!a_.was_given(option) || same) return;
    std::ostringstream text;
    text << "--" << option << " is fixed by the " << stage_ << " stage file: it was " << there << "; leave it out";
    throw Error(ErrorCode::usage, "command line", text.str());
  }
  /// `unset` stands for an option that was not given.
  template <class T>
  void check(const char* option, const T& asked, const T& kept, const T& unset) const {
    if (kept == unset)
      check(option, asked == kept, "not given");
    else
      check(option, asked == kept, kept);
  }

 private:
  const std::string& stage_;
  const Arguments& a_;
};

void check_shell(const Held& held, const StageFile& file, const RemeshOptions& asked, const RemeshOptions& kept) {
  const LatticeFrame& frame = file.surface.frame;
  held.check("resolution", asked.resolution == frame.resolution, frame.resolution);
  held.check("voxel-size", gives_grid(asked.voxel_size_world, frame), frame.voxel_size);
  held.check("band", asked.band_vox == file.shell.band_vox, file.shell.band_vox);
  held.check("close-gaps", closing_vox(asked, frame) == file.info.closing_vox,
             std::to_string(2 * file.info.closing_vox) + "vox");
  held.check("outer-only", kept.outer_only, "not given");
}

void check_seeds(const Held& held, int64_t seeds, const Arguments& a, const Kept& kept) {
  const RemeshOptions &asked = a.remesh, &o = kept.options;
  held.check("vertices", asked.vertices == seeds, seeds);
  held.check("edge-length", asked.edge_length_world, o.edge_length_world, 0.);
  held.check("sizing", a.sizing, kept.sizing, std::string());
  held.check("adaptivity", asked.adaptivity == o.adaptivity, o.adaptivity);
  held.check("gradation", asked.gradation == o.gradation, o.gradation);
  held.check("method", asked.method == o.method, method_name(o.method));
  held.check("iterations", asked.max_passes, o.max_passes, 0);
  held.check("tolerance", asked.tolerance, o.tolerance, -1.);
  held.check("step", asked.max_step_vox, o.max_step_vox, 0.);
  held.check("seed", asked.seed == o.seed, o.seed);
}

}  // namespace

std::string options_json(const RemeshOptions& o) {
  const Json j = {{"vertices", o.vertices},
                  {"edge-length", o.edge_length_world},
                  {"band", o.band_vox},
                  {"outer-only", o.outer_only},
                  {"method", method_name(o.method)},
                  {"iterations", o.max_passes},
                  {"tolerance", o.tolerance},
                  {"step", o.max_step_vox},
                  {"seed", o.seed},
                  {"fit", fit_name(o.fit)},
                  {"uniform-area", o.uniform_area},
                  {"adaptivity", o.adaptivity},
                  {"gradation", o.gradation},
                  {"sizing", o.sizing ? o.sizing->source() : ""}};
  return j.dump();
}

std::string adopt_options(const StageFile& file, const Arguments& a, RemeshOptions& o) {
  const Kept kept = parse_kept(file.info.options_json, a.input);
  const Held held(file, a);
  check_shell(held, file, a.remesh, kept.options);
  if (file.seeds) check_seeds(held, file.seeds->size(), a, kept);

  o.band_vox = file.shell.band_vox;
  o.outer_only = kept.options.outer_only;
  const auto keep = [&](const char* option, auto RemeshOptions::*value) {
    if (!a.was_given(option)) o.*value = kept.options.*value;
  };
  const bool size_given = a.was_given("vertices") || a.was_given("edge-length") || a.was_given("sizing");
  if (!size_given || file.seeds) {
    o.vertices = kept.options.vertices;
    o.edge_length_world = kept.options.edge_length_world;
  }
  keep("iterations", &RemeshOptions::max_passes);
  keep("tolerance", &RemeshOptions::tolerance);
  keep("step", &RemeshOptions::max_step_vox);
  keep("seed", &RemeshOptions::seed);
  keep("uniform-area", &RemeshOptions::uniform_area);
  keep("adaptivity", &RemeshOptions::adaptivity);
  keep("gradation", &RemeshOptions::gradation);
  keep("fit", &RemeshOptions::fit);
  keep("method", &RemeshOptions::method);
  return a.was_given("sizing") ? a.sizing : kept.sizing;
}

}  // namespace isoshell::tool
