// Meshes from files and to files, whatever their format.
#include "isoshell/io/mesh_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "core/attribute_values.h"
#include "core/file_format.h"
#include "core/parallel_ranges.h"
#include "geometry/box.h"
#include "geometry/triangle_list.h"
#include "geometry/world_vector.h"
#include "io/file_formats.h"
#include "isoshell/error.h"
#include "isoshell/io/python_formats.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

const FormatRow& row_of(const std::string& path, const std::string& format, bool (*is_one)(const FileFormat&),
                        const char* stage) {
  if (format.empty() && path == "-")
    throw Error(ErrorCode::usage, stage, "a standard stream has no name to tell the format; name one");
  const FormatRow* row = find_row(format.empty() ? format_of_path(path) : format_name(format));
  if (row && is_one(row->format)) return *row;
  const std::string remedy = format.empty() ? python_remedy(path, is_one == writes_mesh) : "";
  throw Error(ErrorCode::usage, stage,
              path +
                  (format.empty() ? ": the name does not tell the format; it must end in one of " +
                                        listed_endings(is_one) + ", or name a format"
                                  : ": the format '" + format + "' must be one of " + listed_formats(is_one)) +
                  remedy);
}

const char* bits_of(const Placement& placement) { return placement.is_double() ? "64-bit" : "32-bit"; }

[[noreturn]] void refuse_numbers(const std::string& what, const Placement& placement, const std::string& why) {
  throw Error(ErrorCode::unwritable_output, "write",
              what + ": the format's " + bits_of(placement) + " floats do not hold the mesh: " + why +
                  "; subtract an offset from what is written (--recenter), or write PLY or OBJ");
}

/// As positions_in_file() found it.
Placement placement_of(const HeldPositions& held) {
  return {held.is_single ? NumberType::f32 : NumberType::f64, held.offset_world, held.origin_world};
}

int64_t count_lost(const TriangleMesh& mesh, const Placement& placement) {
  return placement.is_double() && is_origin(placement.offset) ? 0 : count_lost_triangles(mesh, placement);
}

void require_held(const std::string& path, const Placement& placement, int64_t lost) {
  if (lost > 0)
    refuse_numbers(path, placement,
                   counted(lost, "triangle tilts by more than 60 degrees or loses its area",
                           "triangles tilt by more than 60 degrees or lose their area"));
}

double shortest_edge_world(const TriangleMesh& mesh) {
  double shortest_sq = mesh.triangles.empty() ? 0 : std::numeric_limits<double>::infinity();
  for (const auto& t : mesh.triangles)
    for (size_t c = 0; c < 3; ++c)
      shortest_sq = std::min(shortest_sq, distance_sq(mesh.vertices[t[c]], mesh.vertices[t[(c + 1) % 3]]));
  return std::sqrt(shortest_sq);
}

}  // namespace

TriangleSoup read_mesh(const std::string& path, const std::string& format, int64_t memory_limit_bytes) {
  const FormatRow& row = row_of(path, format, reads_mesh, "read_mesh");
  ReadingBudget budget(memory_limit_bytes);
  const MeshSource source(path, budget);
  if (source.size() == 0) source.nothing_to_mesh("is empty (0 bytes); give a file with faces");
  try {
    return row.read(source);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::out_of_memory, "read_mesh",
                source.name() + ": " + std::to_string(source.size()) +
                    " bytes do not fit into memory as a mesh; split the file");
  }
}

void write_mesh(const std::string& path, const TriangleMesh& mesh, const MeshWriteOptions& options) {
  const FormatRow& row = row_of(path, options.format, writes_mesh, "write_mesh");
  if (!mesh.gap.empty() && mesh.gap.size() != mesh.vertices.size())
    throw Error(ErrorCode::usage, "write_mesh", "the mesh has another number of gap flags than of vertices");
  if (!mesh.regions.empty() && mesh.regions.labels.size() != mesh.triangles.size())
    throw Error(ErrorCode::usage, "write_mesh", "the mesh has regions of another number of faces than it has");
  for (const Attribute& a : mesh.attributes)
    if (const std::string misfit = misfit_of(a, mesh.vertices.size(), mesh.triangles.size()); !misfit.empty())
      throw Error(ErrorCode::usage, "write_mesh", misfit);
  const std::optional<HeldPositions>& held = options.held;
  const Placement placement = held ? placement_of(*held) : row.place(mesh, options.offset_world);
  if (!options.may_lose_triangles)
    require_held(path, placement, held ? held->lost_triangles : count_lost(mesh, placement));
  OutputFile file(path, options.overwrite);
  row.write(file, mesh, placement, options);
  file.commit();
}

FilePositions positions_in_file(const TriangleMesh& mesh, const std::string& format, const WorldPoint& offset_world) {
  const Placement placement = row_of(format, format, writes_mesh, "write_mesh").place(mesh, offset_world);
  FilePositions in_file;
  HeldPositions& held = in_file.held;
  held.is_single = !placement.is_double();
  held.offset_world = offset_world;
  held.origin_world = placement.origin;
  held.shortest_edge_world = shortest_edge_world(mesh);
  in_file.vertices.resize(mesh.vertices.size());
  for_each_index(size_t(0), mesh.vertices.size(),
                 [&](size_t v) { in_file.vertices[v] = placement.in_file(mesh.vertices[v]); });
  for (size_t v = 0; v < mesh.vertices.size(); ++v)
    if (is_finite(mesh.vertices[v]) && !is_finite(in_file.vertices[v]))
      refuse_numbers(format, placement,
                     "vertex " + std::to_string(v) + " at " + exact_place(mesh.vertices[v]) + " would be infinite");
  if (placement.is_double() && is_origin(offset_world)) return in_file;
  held.moved_world = largest_move_world(mesh, placement);
  held.lost_triangles = count_lost(mesh, placement);
  return in_file;
}

WorldPoint offset_to_origin(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return {0, 0, 0};
  const WorldBox box = box_of(mesh.vertices);
  const WorldPoint side = box.max - box.min;
  const double longest = std::max({side.x, side.y, side.z});
  const double step = std::pow(10, std::ceil(std::log10(longest)));
  const auto rounded = [&](double low, double high) {
    const double steps = std::nearbyint((low / 2 + high / 2) / step);
    return std::isfinite(steps) ? steps * step + 0.0 : 0;  // no -0
  };
  return {rounded(box.min.x, box.max.x), rounded(box.min.y, box.max.y), rounded(box.min.z, box.max.z)};
}

}  // namespace isoshell
