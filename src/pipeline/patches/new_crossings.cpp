// See new_crossings.h.
#include "pipeline/patches/new_crossings.h"

#include "core/copy_product.h"
#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "measure/crossings.h"
#include "pipeline/patches/cut_curves.h"

namespace isoshell {

TrianglePairs crossings_of(const FeatureMesh& mesh, const LatticeFrame& frame, const Context& context) {
  Buffer<PointQ8> points(int64_t(mesh.vertices.size()));
  Buffer<TriangleIndices> triangles(int64_t(mesh.triangles.size()));
  for_each_index(size_t(0), mesh.vertices.size(), [&](size_t v) { points[v] = frame.snap(mesh.vertices[v]); });
  for_each_index(size_t(0), mesh.triangles.size(), [&](size_t t) {
    triangles[t] = {mesh.triangles[t][0], mesh.triangles[t][1], mesh.triangles[t][2]};
  });
  return crossing_pairs(points.view(), triangles.view(), {}, context.cancel);
}

NewCrossings::NewCrossings(const PreparedSurface& p, const CutSurface& cut, Context& context)
    : p_(p),
      context_(context),
      may_be_old_(!p.surface.topology.closed && !cut.source->is_sheet),
      edge_q8_(int32_t(cut.longest_edge_q8)) {}

TrianglePairs NewCrossings::all(const DualMesh& mesh, View<const uint32_t> joined) const {
  TrianglePairs pairs = run_with_threads(
      context_, [&] { return crossing_pairs(mesh.position.view(), mesh.triangles.view(), joined, context_.cancel); });
  check_cancel(context_, "features");
  return pairs;
}

TrianglePairs NewCrossings::wrong_of(const DualMesh& mesh, const TrianglePairs& pairs) {
  if (pairs.empty() || !may_be_old_) return pairs;
  if (!of_input_) {
    const OnHost<LatticeSurface> input(p_.surface);
    of_input_ = find_crossings(input->points.view(), input->triangles.view(), context_);
  }
  std::vector<BoxQ8> boxes;
  for (const auto& pair : pairs) boxes.push_back(common_box(mesh.position.view(), mesh.triangles.view(), pair));
  TrianglePairs wrong;
  for (const size_t i : which_apart(boxes, *of_input_, edge_q8_)) wrong.push_back(pairs[i]);
  return wrong;
}

}  // namespace isoshell
