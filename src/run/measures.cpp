// See measures.h.
#include "run/measures.h"

#include <utility>

#include "isoshell/advanced/to_host.h"
#include "isoshell/gaps.h"
#include "isoshell/io/file_format.h"
#include "isoshell/mesh_census.h"
#include "run/warnings.h"

namespace isoshell {

namespace {

/// A file without numbers of vertices.
bool joins_vertices(const RunRecord& record) {
  if (record.files.empty()) return false;
  const FileFormat* const format = find_format(record.files.front().format);
  return format && format->joins_vertices;
}

/// What should not be of a result, whatever the input is; empty where all is well.
std::string flaw_of(const RunRecord& record) {
  const int64_t borders = record.report.features.border_loops;
  if (record.regions)
    return record.regions->every_region_closed ? "" : "the walls of the result do not close every region";
  if (record.topology->is_manifold_with(borders)) return "";
  return std::string("the result is not a ") + (borders > 0 ? "" : "closed ") + "2-manifold";
}

}  // namespace

std::optional<RegionChanges> region_changes_of(const RunRecord& record) {
  if (!record.regions || record.input.regions.walls.empty()) return std::nullopt;
  return find_region_changes(record.input.regions, *record.regions);
}

std::vector<WorldPoint> put_as_in_file(TriangleMesh& mesh, RunRecord& record) {
  record.vertices = int64_t(mesh.vertices.size());
  record.triangles = int64_t(mesh.triangles.size());
  OutputRequest& output = record.output;
  if (output.recenter.is_asked && !output.recenter.offset_world) output.recenter.offset_world = offset_to_origin(mesh);
  if (output.path.empty()) return {};
  FilePositions in_file = positions_in_file(mesh, output.format, output.recenter.offset());
  record.files.push_back({output.path, output.format, in_file.held});
  return std::exchange(mesh.vertices, std::move(in_file.vertices));
}

bool is_coarse(const RunRecord& record) { return !record.files.empty() && record.files.front().held.is_coarse(); }

void move_by(const WorldPoint& offset, std::vector<WorldPoint>& positions) {
  if (offset.x == 0 && offset.y == 0 && offset.z == 0) return;
  for (WorldPoint& p : positions) p = {p.x + offset.x, p.y + offset.y, p.z + offset.z};
}

bool measures_all(const RunRequest& request) {
  return request.measures == Measures::all || !request.statistics.empty() || !request.report.empty();
}

bool measures_distance(const RunRequest& request) { return measures_all(request) || request.gates.needs_distance(); }

namespace {

/// What there is to warn of.
std::vector<std::string> check_triangles(const TriangleMesh& mesh, RunRecord& record, Context& context) {
  record.topology = check_mesh(mesh);
  if (!mesh.regions.empty())
    record.regions = take_region_census(mesh, context);
  else if (record.report.is_optimized && !record.files.empty())  // without a file the optimisation's count holds
    record.report.optimize.self_intersections = count_intersecting_pairs(mesh, context);
  std::vector<std::string> warnings;
  const std::string flaw = flaw_of(record);
  if (joins_vertices(record)) record.topology = check_mesh(with_joined_vertices(mesh));
  if (!flaw.empty() && record.report.dual.failed_cells == 0)
    warnings.push_back(flaw + ", which should not be: please report the input");
  if (const std::optional<RegionChanges> changes = region_changes_of(record)) {
    if (changes->any()) warnings.push_back(words_of(*changes));
    if (const std::string text = words_of(changes->volumes); !text.empty()) warnings.push_back(text);
  }
  return warnings;
}

}  // namespace

std::vector<std::string> measure_mesh(TriangleMesh& mesh, std::vector<WorldPoint>& exact, bool is_asked,
                                      RunRecord& record, Context& context) {
  const bool coarse = is_coarse(record), is_measured = is_asked || coarse;
  std::vector<std::string> warnings;
  if (is_measured) warnings = check_triangles(mesh, record, context);
  if (coarse)
    move_by(record.output.recenter.offset(), mesh.vertices);
  else if (!exact.empty())
    mesh.vertices.swap(exact);
  if (is_measured) record.quality = measure_quality(mesh);
  if (is_measured && !coarse)  // which is a reason of its own for small angles
    for (std::string& text : warnings_of_quality(record)) warnings.push_back(std::move(text));
  return warnings;
}

void measure_distances(const Prepared& prepared, const TriangleSoup& soup, const TriangleMesh& mesh, RunRecord& record,
                       Context& context) {
  const bool has_regions = !soup.regions.empty();
  const TriangleMesh input =
      has_regions ? TriangleMesh{soup.vertices, soup.triangles} : to_world(to_host(prepared.surface()));
  record.distance = measure_distance(mesh, input, context);
  if (record.report.features.border_loops > 0) record.borders = measure_borders(mesh, input, context);
}

int64_t count_risky_sites(const Prepared& p, Context& context) {
  const bool has_sites = p.sites().voxels.voxel_count() > 0;  // a frame of a sequence may have done without
  const SiteSamples made =
      has_sites ? SiteSamples{} : sample_sites(p.surface(), voxelize(p.surface(), context), context);
  int64_t count = 0;
  for (const uint8_t risky : find_risks(p.surface(), has_sites ? p.samples() : made)) count += risky;
  return count;
}

}  // namespace isoshell
