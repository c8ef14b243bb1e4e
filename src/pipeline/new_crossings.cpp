// See new_crossings.h.
#include "pipeline/new_crossings.h"

#include "core/copy_product.h"
#include "core/watched.h"
#include "features/cut_surface.h"
#include "measure/crossings.h"
#include "pipeline/cut_curves.h"

namespace isoshell {

TrianglePairs NewCrossings::all(const DualMesh& mesh, View<const uint32_t> joined) const {
  TrianglePairs pairs = run_with_threads(
      context_, [&] { return crossing_pairs(mesh.position.view(), mesh.triangles.view(), joined, context_.cancel); });
  check_cancel(context_, "features");
  return pairs;
}

TrianglePairs NewCrossings::wrong_of(const DualMesh& mesh, const TrianglePairs& pairs) {
  if (pairs.empty() || p_.surface.topology.closed || p_.cut->source->is_sheet) return pairs;
  if (!of_input_) {
    const OnHost<LatticeSurface> input(p_.surface);
    of_input_ = find_crossings(input->points.view(), input->triangles.view(), context_);
  }
  std::vector<BoxOfPoints> boxes;
  for (const auto& pair : pairs) boxes.push_back(common_box(mesh.position.view(), mesh.triangles.view(), pair));
  TrianglePairs wrong;
  for (const size_t i : which_apart(boxes, *of_input_, int32_t(p_.cut->longest_edge_q8))) wrong.push_back(pairs[i]);
  return wrong;
}

}  // namespace isoshell
