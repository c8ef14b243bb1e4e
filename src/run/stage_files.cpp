// See stage_files.h.
#include "run/stage_files.h"

#include <algorithm>
#include <utility>

#include "isoshell/error.h"
#include "isoshell/gaps.h"
#include "run/outputs.h"

namespace isoshell {

std::string left_out_of_stage_files(const Input& input, const std::optional<std::vector<std::string>>& requested) {
  if (input.stage) return input.stage->info.left_out;
  std::string names;
  for (const Attribute& a : input.soup.attributes)
    if (!requested || std::count(requested->begin(), requested->end(), a.name) > 0)
      names += (names.empty() ? "" : ", ") + a.name;
  return names.empty() ? "" : names + " of " + input.facts.name();
}

std::vector<std::string> stage_files(const RunRequest& request, const std::string& saved, StopAfter stage) {
  std::vector<std::string> files;
  if (!saved.empty()) files.push_back(saved);
  if (request.stop_after == stage && !request.output.path.empty()) files.push_back(request.output.path);
  return files;
}

std::vector<std::string> level_set_files(const RunRequest& request) {
  return stage_files(request, request.save_level_set, StopAfter::level_set);
}

bool makes_level_set(const RunRequest& request) { return request.keep_level_set || !level_set_files(request).empty(); }

StageWriteOptions stage_write_options(const Prepared& prepared, const std::string& options_json,
                                      const std::string& left_out, bool overwrite) {
  StageWriteOptions options;
  options.options_json = options_json;
  options.closing_vox = prepared.closing_vox();
  options.overwrite = overwrite;
  options.left_out = left_out;
  if (prepared.has_bridges())
    options.bridges = bridging_voxels(prepared.sheet(), find_bridges(prepared.sites(), prepared.sheet()));
  return options;
}

void save_with_preview(const std::string& path, const Prepared& prepared, const SeedSet& seeds,
                       const VoronoiLabels& labels, const StageWriteOptions& options) {
  const LatticeSurface& surface = prepared.surface();
  save_voronoi(path, surface, prepared.samples(), prepared.shell(), seeds, labels, options);
  if (const std::string preview = preview_path(path); !preview.empty())
    save_preview(preview, surface.frame, prepared.shell(), labels, options);
}

Relaxed seeds_of_stage(Input& input, const Prepared& prepared) {
  Relaxed relaxed{std::move(*input.stage->seeds), prepared.report()};
  relaxed.report.seeds = relaxed.seeds.size();
  const int64_t vertices = prepared.sheet().vertex_count();
  for (const uint32_t home : relaxed.seeds.home)
    if (int64_t(home) >= vertices)
      throw Error(ErrorCode::unreadable_input, input.facts.path,
                  "a seed sits on vertex " + std::to_string(home) + " of a sheet that has " + std::to_string(vertices) +
                      "; the file's surface and seeds do not belong together: save it anew");
  return relaxed;
}

}  // namespace isoshell
