// Tells meshes, point clouds, volumes and stage files apart, reads them, and says what they held.
#include "io/input_reader.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <unordered_set>

#include "core/file_format.h"
#include "geometry/box.h"
#include "geometry/given_surface.h"
#include "geometry/world_vector.h"
#include "implicit/labels/label_surface.h"
#include "implicit/level_sets/level_set_labels.h"
#include "implicit/level_sets/reference_faces.h"
#include "implicit/level_sets/united_field.h"
#include "io/faces/face_collector.h"
#include "io/level_sets.h"
#include "io/vdb/grid_fields.h"
#include "io/vdb/stage_reader.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/error.h"
#include "isoshell/io/file_format.h"
#include "isoshell/io/memory_input.h"
#include "isoshell/io/mesh_file.h"
#include "isoshell/io/python_formats.h"
#include "isoshell/io/volume_file.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

constexpr double kNotableOpenPart = 0.01;  // of a surface of points that no point supports
constexpr double kNotableLostPart = 0.05;  // of points, by area, that no surface goes through
constexpr double kParticlePart = 0.65;     // of points without a flat neighbourhood, where they fill a volume
constexpr double kNotableJumps = 0.01;     // of the cells that the surface of a volume crosses

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::unreadable_input, "read", message); }
[[noreturn]] void refuse_use(const std::string& message) { throw Error(ErrorCode::usage, "read", message); }

void check_exists(const std::string& path) {
  std::error_code code;
  const std::filesystem::file_status status = std::filesystem::status(path, code);
  if (!std::filesystem::exists(status)) {
    const bool is_pattern = path.find_first_of("#%*") != std::string::npos;
    refuse(path + ": no such file" +
           (is_pattern
                ? "; only vdb_isomesh with --frames, as 1-240, takes a pattern, as mesh.####.ply or mesh.%04d.ply"
                : ""));
  }
  if (std::filesystem::is_directory(status)) refuse(path + ": is a folder, not a file");
  if (access(path.c_str(), R_OK) != 0) refuse(path + ": " + std::strerror(errno));  // a pipe opens only once
}

/// Names of grids without a file of theirs.
std::vector<std::string> own_grids(const std::vector<std::string>& names) {
  std::vector<std::string> own;
  std::copy_if(names.begin(), names.end(), std::back_inserter(own),
               [](const std::string& name) { return grid_name_of(name).file.empty(); });
  return own;
}

[[noreturn]] void refuse_iso() { refuse_use("--iso is for volumes; leave it out"); }

void check_no_labels(const LabelReading& labels) {
  if (const char* const option = labels.given())
    refuse_use(std::string(option) + " is for volumes of labels; leave it out");
}

/// What marks faces needs of a reference.
TriangleSoup triangles_of(TriangleSoup surface) {
  TriangleSoup alone;
  alone.vertices = std::move(surface.vertices);
  alone.triangles = std::move(surface.triangles);
  return alone;
}

int64_t bytes_of(const TriangleSoup& surface) {
  return int64_t(surface.vertices.size() * sizeof surface.vertices[0] +
                 surface.triangles.size() * sizeof surface.triangles[0]);
}

VolumeReadOptions options_of(const InputRequest& request, const Context& context) {
  return {request.grid,        request.iso, context.memory_limit_bytes, request.creases,
          VolumeSides::sample, false,       request.keep_open};
}

}  // namespace

void check_several(const InputRequest& request) {
  const bool is_for_several = is_for_level_sets(request);
  if (!is_for_several && (request.unite || !request.reference.empty()))
    refuse_use(std::string(request.unite ? "--union" : "--reference") +
               " is for several level sets; name them as FILE.vdb:*, or more files as INPUT");
  if (request.unite && !request.reference.empty()) refuse_use("--reference is for regions; leave it out, or --union");
  const auto& grids = request.grids;
  if (is_for_several && std::find(grids.begin(), grids.end(), kAllGrids) != grids.end())
    refuse_use("--grids all would be the level sets, too; name the grids whose values are wanted");
}

InputReader::InputReader(const std::string& path, const Context& context, const Tell& tell)
    : context_(context), tell_(tell) {
  input_.facts.path = path;
}

void InputReader::read(const InputRequest& request) {
  const std::string& path = request.path;
  check_several(request);
  if (path != "-") check_exists(path);
  const std::string format = request.format.empty() ? format_of_path(path) : request.format;
  const FileFormat* const known = find_format(format);
  if (!known)
    refuse(path + ": the format '" + format + "' is not one of " + listed_formats(reads_anything, ", ") +
           "; say which by --input-format" + python_remedy(path, false));
  if (is_for_level_sets(request))
    read_volume_file(request);
  else if (known->reads_mesh && known->reads_points)
    read_ply(request);
  else if (known->reads_mesh)
    hold(read_mesh(path, format, context_.memory_limit_bytes));
  else if (known->reads_points)
    hold(read_points(path, format, context_.memory_limit_bytes), request);
  else
    read_volume_file(request);
  check_fits(request);
}

void InputReader::read(const MeshSource& source, const InputRequest& request) {
  check_several(request);
  read_any_volume(source, request);
  check_fits(request);
}

void InputReader::check_fits(const InputRequest& request) const {
  if (request.iso && input_.facts.kind != InputKind::volume) refuse_iso();
  if (input_.facts.kind != InputKind::labels) check_no_labels(request.labels);
}

void InputReader::hold(TriangleSoup soup) {
  InputFacts& facts = input_.facts;
  facts.vertices = int64_t(soup.vertices.size());
  facts.faces = soup.faces_in_file;
  const WorldBox box = bounding_box(soup);
  facts.box_min = box.min;
  facts.box_max = box.max;
  facts.regions = regions_of_surface(soup);
  note(counted(facts.vertices, "vertex", "vertices") + ", " + counted(facts.faces, "face"));
  input_.soup = std::move(soup);
}

void InputReader::hold_points(PointCloud cloud) {
  std::vector<WorldPoint>& points = input_.points = std::move(cloud.position);
  std::sort(points.begin(), points.end(), is_before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.empty()) throw Error(ErrorCode::nothing_to_mesh, "points", input_.facts.path + ": holds no point");
  const WorldBox box = box_of(points);
  InputFacts& facts = input_.facts;
  facts.kind = InputKind::points;
  facts.vertices = int64_t(points.size());
  facts.faces = 0;
  facts.box_min = box.min;
  facts.box_max = box.max;
  note(counted(facts.vertices, "point"));
}

void InputReader::hold(const PointCloud& cloud, VolumeCreases creases, bool keep_open) {
  input_.facts.kind = InputKind::points;
  PointSurfaceInfo points;
  hold(surface_of_points(cloud, context_.memory_limit_bytes, points, creases, keep_open));
  input_.facts.vertices = points.points;
  std::ostringstream text;
  text << counted(points.points, "point") << ", spacing " << points.spacing_world << ", surface from voxels of "
       << points.voxel_size_world << ", normals "
       << (points.normals_given && !points.normals_ignored ? "given" : "estimated")
       << (points.normals_turned ? " and turned" : "") << (points.sharp ? ", sides with creases" : "");
  note(text.str());
  if (points.normals_ignored) warn("its normals do not fit its points; others were estimated");
  if (points.unflat_part >= kParticlePart)
    warn("the points fill a volume, as particles of a fluid do: " +
         std::to_string(std::lround(100 * points.unflat_part)) +
         " % of them have no flat neighbourhood; a surface around particles is made by a tool such as splashsurf, " +
         "whose mesh can be the input here");
  if (points.outliers > 0) warn(counted(points.outliers, "point") + " left out, far from all others");
  if (1 - points.held_part >= kNotableLostPart)
    warn(std::to_string(std::lround(100 * (1 - points.held_part))) +
         " % of the points, by area, are far from the surface that was found" +
         (points.normals_given ? "" : "; normals of their own may tell their sides"));
  if (points.open_part >= kNotableOpenPart)
    warn(std::to_string(std::lround(100 * points.open_part)) + " % of the surface has no points near it and " +
         (keep_open ? "was left out" : "was closed smoothly; --boundary keep leaves it open"));
}

void InputReader::hold_volume(bool keep_open, const std::function<TriangleSoup(VolumeInfo&)>& extract) {
  input_.facts.kind = InputKind::volume;
  VolumeInfo volume;
  hold(extract(volume));
  std::ostringstream text;
  text << "grid " << volume.grid << ", " << volume.grid_class << ", surface at " << volume.iso << ", voxel size "
       << volume.voxel_size_world << ", " << counted(volume.blocks, "block")
       << (volume.kind == VolumeKind::at_value ? "" : ", unsigned distances");
  note(text.str());
  if (volume.open_cells > 0) {
    const WorldPoint& at = volume.first_open_world;
    std::ostringstream open;
    if (volume.unknown_values > 0)
      open << counted(volume.unknown_values, "value")
           << (volume.unknown_values == 1 ? " is not known" : " are not known") << ", and its";
    else
      open << "its distances jump, and its";
    open << " surface is open in " << counted(volume.open_cells, "cell") << " there, the first near " << at.x << ' '
         << at.y << ' ' << at.z << (keep_open ? "" : ": holes there are closed, or kept by --boundary keep");
    warn(open.str());
  } else if (volume.jumping_part >= kNotableJumps) {
    warn(std::to_string(std::lround(100 * volume.jumping_part)) +
         " % of its surface is where its distances jump: it has one side of an open surface alone, or was clipped; "
         "--boundary keep leaves it open there");
  }
  if (volume.kind == VolumeKind::open_unsigned_distance)
    warn(
        "the zero set of its unsigned distances encloses nothing; the closed crust around it is meshed, 0.9 voxels "
        "from it");
}

void InputReader::hold(LabelVolume labels, const std::string& origin, std::vector<WallCrossing>* of_triangles) {
  input_.facts.kind = InputKind::labels;
  const std::array<int32_t, 3> size_vox = labels.size_vox;
  const Tell told = [&](MessageKind kind, const std::string& text) { tell(kind, text); };
  hold(surface_of_labels(std::move(labels), input_.facts.name(), context_, told, of_triangles));
  std::unordered_set<int32_t> regions;
  for (const auto& pair : input_.soup.regions.labels) regions.insert(pair.begin(), pair.end());
  regions.erase(input_.soup.regions.background);
  note(origin + counted(int64_t(regions.size()), "region") + ", " + std::to_string(size_vox[0]) + " x " +
       std::to_string(size_vox[1]) + " x " + std::to_string(size_vox[2]) + " voxels");
}

void InputReader::hold(PointCloud cloud, const InputRequest& request) {
  if (request.keep_points)
    hold_points(std::move(cloud));
  else
    hold(cloud, request.creases, request.keep_open);
}

void InputReader::read_ply(const InputRequest& request) {
  PlyContent content = read_ply_content(input_.facts.path, context_.memory_limit_bytes);
  if (!content.is_points) return hold(std::move(content.mesh));
  if (content.unusable_faces > 0)
    warn("none of its faces is usable (" + with_commas(content.unusable_faces) + "); it is read as a point cloud");
  hold(std::move(content.points), request);
}

void InputReader::read_volume_file(const InputRequest& request) {
  ReadingBudget budget(context_.memory_limit_bytes);
  read_any_volume(MeshSource(request.path, budget), request);
}

void InputReader::read_any_volume(const MeshSource& source, const InputRequest& request) {
  if (is_for_level_sets(request)) {
    read_several(source, request);
    return read_grids(source, request, "");
  }
  if (holds_stage({source.begin(), source.size()})) return read_stage_file(source);
  if (holds_labels(source, request.grid))
    read_labels_of(source, request);
  else
    read_level_set(source, request);
  if (!request.grids.empty() && !is_nano_file(source)) read_grids(source, request, meshed_grid(source, request.grid));
}

void InputReader::read_level_set(const MeshSource& source, const InputRequest& request) {
  hold_volume(request.keep_open,
              [&](VolumeInfo& info) { return read_volume(source, options_of(request, context_), info); });
}

void InputReader::read_several(const MeshSource& source, const InputRequest& request) {
  if (request.iso) refuse_use("--iso is for one volume; several level sets are meshed where their values are 0");
  std::optional<TriangleSoup> reference;  // read first: what is wrong with it is said before the long work
  if (!request.reference.empty())
    reference = triangles_of(read_input(named_input(request.reference), context_, tell_).soup);
  input_.facts.also = request.also;
  std::vector<std::unique_ptr<MeshSource>> others;
  std::vector<LevelSetFile> files{{&source, request.grid}};
  for (const std::string& name : request.also) {
    const InputRequest other = named_input(name);
    check_exists(other.path);
    others.push_back(std::make_unique<MeshSource>(other.path, source.budget()));
    files.push_back({others.back().get(), other.grid});
  }
  LevelSets sets = read_level_sets(files, context_.memory_limit_bytes, reference ? bytes_of(*reference) : 0);
  for (const std::string& warning : sets.warnings) warn(warning);
  const std::string origin = counted(int64_t(sets.names.size()), "level set") + ", ";
  if (request.unite)
    return hold_volume(request.keep_open, [&](VolumeInfo& volume) {
      const std::unique_ptr<ScalarField> field = united_level_sets(std::move(sets));
      return surface_of_field(*field, options_of(request, context_), volume);
    });
  if (const char* const option = request.labels.given_of_labels())
    refuse_use(std::string(option) + " is for volumes of labels; level sets have places of their own for walls");
  auto [labels, warnings] = labels_of_level_sets(sets, context_);
  for (const std::string& warning : warnings) warn(warning);
  if (request.labels.smallest_island_vox) labels.smallest_island_vox = *request.labels.smallest_island_vox;
  const LabelVolume lattice{labels.size_vox, {}, labels.origin_world, labels.step_world};
  std::vector<WallCrossing> crossings;
  hold(std::move(labels), origin, reference ? &crossings : nullptr);
  if (!reference) return;
  const double off_vox = mark_faces_on_reference(*reference, request.reference, crossings, lattice, input_.soup);
  if (off_vox > 0)
    warn("no face lies on the reference " + request.reference + ", so all are inner: the nearest is " +
         readable_length(off_vox) +
         " voxels from it, or faces the other way; is it what the level sets were cut from?");
}

void InputReader::read_grids(const MeshSource& source, const InputRequest& request, const std::string& meshed) {
  const std::vector<std::string> names = own_grids(request.grids);
  if (names.empty()) return;
  input_.grids = read_grid_fields(source, names, meshed);
  for (const auto& grid : *input_.grids) note("grid " + grid->name() + " is sampled at the vertices");
}

void InputReader::read_labels_of(const MeshSource& source, const InputRequest& request) {
  if (request.iso) refuse_iso();  // before the labels are read
  hold(read_label_grid(source, {request.grid, context_.memory_limit_bytes, request.labels.background}), request.labels);
}

void InputReader::hold(LabelGrid grid, const LabelReading& reading) {
  if (reading.smallest_island_vox) grid.volume.smallest_island_vox = *reading.smallest_island_vox;
  if (reading.smoothing_vox) grid.volume.smoothing_vox = *reading.smoothing_vox;
  if (reading.is_periodic) grid.volume.is_periodic = *reading.is_periodic;
  hold(std::move(grid.volume), "grid " + grid.name + ", ");
}

void InputReader::hold(const HeldGrid& grid, const InputRequest& request) {
  check_several(request);
  const std::string name = input_.facts.name();
  const LabelReadOptions as_labels{"", context_.memory_limit_bytes, request.labels.background};
  if (grid.volume().flaw.empty()) {
    hold_volume(request.keep_open,
                [&](VolumeInfo& info) { return read_volume(grid.field(), name, options_of(request, context_), info); });
  } else if (grid.labels().flaw.empty()) {
    if (request.iso) refuse_iso();
    hold({grid.labels().name, grid.label_volume(name, as_labels)}, request.labels);
  } else {
    throw Error(ErrorCode::nothing_to_mesh, "read", name + ": grid " + grid.volume().text() + " " + grid.volume().flaw);
  }
  check_fits(request);
}

void InputReader::read_stage_file(const MeshSource& source) {
  input_.facts.kind = InputKind::stage;
  input_.stage = read_stage(source);
  note("stage " + input_.stage->info.stage + ", " + counted(input_.stage->shell.voxels.voxel_count(), "active voxel"));
}

void InputReader::tell(MessageKind kind, const std::string& text) const {
  if (tell_) tell_(kind, input_.facts.name() + ": " + text);
}

}  // namespace isoshell
