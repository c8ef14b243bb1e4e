// See measures.h.
#include "run/measures.h"

#include "isoshell/advanced/to_host.h"
#include "isoshell/gaps.h"
#include "run/warnings.h"

namespace isoshell {

std::vector<std::string> measure_mesh(const TriangleMesh& mesh, RunRecord& record) {
  record.topology = check_mesh(mesh);
  record.quality = measure_quality(mesh);
  std::vector<std::string> warnings;
  const RemeshReport& report = record.report;
  const int64_t borders = report.features.border_loops;
  if (!record.topology->is_manifold_with(borders) && report.dual.failed_cells == 0)
    warnings.push_back(std::string("the result is not a ") + (borders > 0 ? "" : "closed ") +
                       "2-manifold, which should not be: please report the input");
  for (std::string& text : warnings_of_quality(*record.quality)) warnings.push_back(std::move(text));
  return warnings;
}

void measure_distances(const Prepared& prepared, const TriangleMesh& mesh, RunRecord& record, Context& context) {
  const TriangleMesh input = to_world(to_host(prepared.surface()));
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
