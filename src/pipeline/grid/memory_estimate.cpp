// Memory from area. The coefficients are bytes an element, set so that the estimate lies above the peaks that whole
// processes showed (0.1 to 2.6 million sites, open and closed surfaces, with and without stage files) by a quarter or
// more.
#include "pipeline/grid/memory_estimate.h"

#include <algorithm>
#include <string>

#include "isoshell/readable.h"

namespace isoshell {
namespace {

constexpr double kSitesPerArea = 1.74;        // sqrt(3): a plane along the diagonal; 1 along an axis
constexpr double kBytesPerSheetVertex = 260;  // and its site: leaves, samples, triangle lists, scratch
constexpr double kBytesPerActiveVoxel = 14;
constexpr double kBytesPerKeptVoxel = 80;  // of a shell that is kept to be written: OpenVDB's grids beside ours
constexpr double kBytesPerTriangle = 150;  // soup, surface, welding and edge keys
constexpr double kBytesPerSeed = 1000;
constexpr double kBytesPerSignedVoxel = 20;  // of a level set, beside what the sheet has taken
constexpr double kFixedBytes = 64 << 20;     // lookup tables, thread-local scratch

}  // namespace

RunEstimate estimate_plan(const Plan& plan, const TriangleSoup& soup, int32_t resolution) {
  const RemeshOptions& options = plan.options;
  const InputTopology& input = plan.input;
  RunEstimate e;
  e.resolution = resolution > 0 ? resolution : plan.first_resolution();
  const LatticeFrame frame = plan.frame(e.resolution);
  e.voxel_size_world = frame.voxel_size;
  e.vertices = plan.target.vertices;

  const double area_vox = input.area_world / (frame.voxel_size * frame.voxel_size);
  double box_vox = 1;
  for (int32_t side : frame.extent_vox) box_vox *= side;
  const double sites = std::min(kSitesPerArea * area_vox + double(e.resolution), box_vox);
  const bool shell = options.want_shell || options.method == Method::shell;
  const double active = shell ? std::min(area_vox * (2 * options.band_vox + 1.74), box_vox) : 0;
  const double band = options.level_set_band_vox;
  const double signed_voxels = band > 0 ? std::min(area_vox * (2 * band + 2.74), box_vox) : 0;
  e.sites = int64_t(sites);
  e.sheet_vertices = input.closed ? int64_t(sites) : int64_t(2 * sites);
  e.active_voxels = int64_t(active);
  e.vertex_bytes = int64_t(kBytesPerSeed * double(e.vertices));
  e.bytes = e.vertex_bytes + int64_t(kFixedBytes + kBytesPerSheetVertex * double(e.sheet_vertices) +
                                     (options.want_shell ? kBytesPerKeptVoxel : kBytesPerActiveVoxel) * active +
                                     kBytesPerSignedVoxel * signed_voxels +
                                     kBytesPerTriangle * double(soup.triangles.size() + soup.vertices.size()));
  return e;
}

std::string over_memory_limit(const RunEstimate& e, int64_t limit_bytes) {
  const bool is_of_vertices = 2 * e.vertex_bytes > e.bytes;
  const std::string who = is_of_vertices ? "a result of " + counted(e.vertices, "vertex", "vertices")
                                         : "resolution " + std::to_string(e.resolution);
  const char* const remedy = is_of_vertices                 ? "; ask for fewer by --vertices or longer edges, or "
                             : e.resolution > kCoarsestGrid ? "; lower --resolution or "
                                                            : ", which its faces take; ";
  return who + " needs about " + readable_bytes(e.bytes) + ", more than the limit of " + readable_bytes(limit_bytes) +
         remedy + "raise --max-memory";
}

}  // namespace isoshell
