// Sums of distances: what both backends need of the mesh, then the one that the context asks for.
#include <vector>

#include "isoshell/error.h"
#include "stages/backend_table.h"

namespace isoshell {
namespace {

std::vector<double> areas_until(const TriangleMesh& mesh) {
  std::vector<double> until;
  until.reserve(mesh.triangles.size());
  double sum = 0;
  for (const auto& t : mesh.triangles)
    until.push_back(sum += triangle_area(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]));
  return until;
}

}  // namespace

DistanceSums sum_distances(const TriangleMesh& from, const TriangleGrid& to, const DistancePlaces& places,
                           Context& context) {
  const std::vector<double> area_until = areas_until(from);
  try {
    return backend_for(context).sum_distances(from, area_until, to.view(), places, context);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::out_of_memory || context.backend == Backend::cpu) throw;
    return cpu_backend().sum_distances(from, area_until, to.view(), places, context);
  }
}

}  // namespace isoshell
