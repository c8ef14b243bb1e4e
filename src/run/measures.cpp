// See measures.h.
#include "run/measures.h"

#include "isoshell/advanced/to_host.h"
#include "isoshell/gaps.h"
#include "run/warnings.h"

namespace isoshell {

namespace {

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
  if (!record.regions || record.input.walls.empty()) return std::nullopt;
  const InputFacts& input = record.input;
  return find_region_changes(input.walls, input.absorbed_walls, input.region_names, *record.regions);
}

std::vector<std::string> measure_mesh(const TriangleMesh& mesh, RunRecord& record, Context& context) {
  record.topology = check_mesh(mesh);
  record.quality = measure_quality(mesh);
  if (!mesh.regions.empty()) record.regions = take_region_census(mesh, context);
  std::vector<std::string> warnings;
  const std::string flaw = flaw_of(record);
  if (!flaw.empty() && record.report.dual.failed_cells == 0)
    warnings.push_back(flaw + ", which should not be: please report the input");
  if (const std::optional<RegionChanges> changes = region_changes_of(record); changes && changes->any())
    warnings.push_back(words_of(*changes));
  for (std::string& text : warnings_of_quality(*record.quality)) warnings.push_back(std::move(text));
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
