// See stage_files.h.
#include "run/stage_files.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "isoshell/advanced/to_host.h"
#include "isoshell/error.h"
#include "isoshell/gaps.h"
#include "run/outputs.h"

namespace isoshell {
namespace {

constexpr int32_t kRoomVox = 24;  // the widest band, half the diagonal of a voxel, and voxels near the sheet

[[noreturn]] void refuse_use(const std::string& message) { throw Error(ErrorCode::usage, "level-set", message); }

[[noreturn]] void refuse_regions() {
  refuse_use(
      "a level set is of one solid, and the input parts regions; leave out the level set, unite several level sets by "
      "--union, or mesh one label after the other");
}

/// The same lattice, with room for a level set around the box.
LatticeFrame with_room_for(LatticeFrame frame, const WorldBox& box) {
  const auto grow = [&](int axis, double& origin, double low, double high) {
    const auto voxel_of = [&](double at) { return int32_t(std::floor((at - origin) / frame.voxel_size)); };
    const auto leaves = [](int32_t vox) { return std::max(0, vox + 7) / 8 * 8; };
    const int32_t before = leaves(kRoomVox - voxel_of(low));
    const int32_t behind = leaves(voxel_of(high) + 1 + kRoomVox - frame.extent_vox[axis]);
    origin -= before * frame.voxel_size;
    frame.extent_vox[axis] += before + behind;
  };
  grow(0, frame.origin.x, box.min.x, box.max.x);
  grow(1, frame.origin.y, box.min.y, box.max.y);
  grow(2, frame.origin.z, box.min.z, box.max.z);
  return frame;
}

/// What only finds the solid of a closed mesh: nothing is cut, closed or grown, as the mesh has its walls.
RemeshOptions options_of_solid() {
  RemeshOptions options;
  options.vertices = int64_t(1) << 26;  // none is placed; with few of them thin walls would be grown
  options.features = {Features::Creases::off, 0};
  return options;
}

/// Of a closed mesh, on the lattice of `frame`, which is made larger by whole leaves where the mesh reaches out of it.
LevelSet level_set_of_result(const TriangleMesh& mesh, const LatticeFrame& frame, double band_vox, Context& context) {
  if (!mesh.regions.empty()) refuse_regions();
  TriangleSoup soup;
  soup.vertices = mesh.vertices;
  soup.triangles = mesh.triangles;
  const InputTopology topology = measure_topology(soup, context).topology;
  if (!topology.closed)
    refuse_use("the result is not closed, so that nothing is inside of it; take the level set of the input");
  LatticeSurface surface = snap_surface(soup, with_room_for(frame, bounding_box(soup)), context);
  surface.topology = topology;
  const Prepared solid = prepare(std::move(surface), 0, options_of_solid(), context);
  const LevelSetSurface measured = level_set_surface(solid.surface(), &soup, solid.sheet(), SheetPart::none, context);
  return to_host(build_level_set(measured, solid.sites(), solid.sheet(), {band_vox, 0}, context));
}

}  // namespace

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
  return stage_files(request, request.level_set.path, StopAfter::level_set);
}

bool makes_level_set(const RunRequest& request) { return request.level_set.keep || !level_set_files(request).empty(); }

bool makes_level_set_of(const RunRequest& request, LevelSetOf of) {
  return makes_level_set(request) && request.level_set.of == of;
}

/// Of the input or the result, kept or written.
bool asks_for_level_set(const RunRequest& request) {
  return request.level_set.keep || !request.level_set.path.empty() || request.stop_after == StopAfter::level_set;
}

void check_level_set_is_asked(const RunRequest& request) {
  if (asks_for_level_set(request)) return;
  const LevelSetRequest& asked = request.level_set;
  const char* const option = asked.as_half                                 ? "--level-set-half"
                             : asked.of == LevelSetOf::result              ? "--level-set-of"
                             : request.options.was_given("level-set-band") ? "--level-set-band"
                                                                           : nullptr;
  if (option)
    refuse_use(std::string(option) +
               " is of a level set, and none is asked for; name its file by --save-level-set, or leave it out");
}

void check_level_set(const RunRequest& request) {
  const LevelSetRequest& asked = request.level_set;
  if (!asks_for_level_set(request)) return;
  if (!request.options.values.regions.empty())
    refuse_use("a level set is of one solid; leave out --regions, or the level set");
  if (asked.of == LevelSetOf::input) return;
  if (request.stop_after != StopAfter::mesh)
    refuse_use(
        "--level-set-of result needs a mesh; leave out --stop-after and name the level set's file by --save-level-set, "
        "or take that of the input");
  if (request.options.values.boundary == Boundary::keep)
    refuse_use(
        "--level-set-of result needs a closed mesh, which has an inside; leave out --boundary keep, or take the level "
        "set of the input");
}

void refuse_level_set_of_regions(const RunRequest& request) {
  if (makes_level_set(request)) refuse_regions();
}

LevelSet level_set_of_run(const RunRequest& request, const Prepared& prepared, const TriangleMesh& mesh,
                          Context& context) {
  const double band_vox = request.level_set.band_vox;
  LevelSet set = request.level_set.of == LevelSetOf::input
                     ? to_host(level_set(prepared, band_vox, context))
                     : level_set_of_result(mesh, prepared.surface().frame, band_vox, context);
  if (!level_set_files(request).empty()) check_level_set_write(set, level_set_write_options(request));
  return set;
}

LevelSetWriteOptions level_set_write_options(const RunRequest& request) {
  LevelSetWriteOptions options;
  options.as_half = request.level_set.as_half;
  options.overwrite = request.overwrite;
  return options;
}

void refuse_seeds_of_patches(const Prepared& prepared) {
  if (prepared.is_in_patches())
    throw Error(ErrorCode::usage, "options",
                "a Voronoi stage file does not hold the seeds of creases, borders and lines; give --features off and "
                "--boundary close, or save the shell");
}

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
