// place_seeds: checks its arguments, then runs on the backend that the context asks for.
#include <algorithm>
#include <cmath>
#include <string>

#include "core/copy_product.h"
#include "core/seed_count.h"
#include "isoshell/error.h"
#include "stages/backend_table.h"
#include "voxel/leaf.h"

namespace isoshell {
namespace {

/// Longest side of the sites' box in voxels: that is what resolution means. Only asked for in a message.
int32_t resolution_of(const VoxelSet& voxels) {
  const OnHost<VoxelSet> sites(voxels);
  int32_t lo[3] = {INT32_MAX, INT32_MAX, INT32_MAX}, hi[3] = {-1, -1, -1}, longest = 0;
  const VoxelSetView view = sites->view();
  for (int64_t l = 0; l < sites->leaf_count(); ++l)
    for_each_active(view, l, [&](int offset, int64_t) {
      const Voxel v = voxel_at(leaf_of_key(view.leaf_key[l]), offset);
      const int32_t at[3] = {v.x, v.y, v.z};
      for (int axis = 0; axis < 3; ++axis) {
        lo[axis] = std::min(lo[axis], at[axis]);
        hi[axis] = std::max(hi[axis], at[axis]);
      }
    });
  for (int axis = 0; axis < 3; ++axis) longest = std::max(longest, hi[axis] - lo[axis] + 1);
  return longest;
}

}  // namespace

SeedSet place_seeds(const SurfaceMesh& surface, const SeedOptions& options, Context& context) {
  const int64_t most = surface.vertex_count() / 2;
  if (options.count < 4 || options.count > most)
    throw NoRoom("seeds", std::to_string(options.count) + " seeds for a surface of " +
                              std::to_string(surface.vertex_count()) +
                              " vertices; there must be 4 to half as many as vertices, " + std::to_string(most) +
                              ": use a finer surface or fewer seeds");
  return backend_for(context).place_seeds_on_surface(surface, options, context);
}

SeedSet place_seeds(const Sheet& sheet, const SeedOptions& options, Context& context) {
  require_seed_count(sheet, options.count);
  return backend_for(context).place_seeds_on_surface(sheet, options, context);
}

SeedSet place_seeds(const SiteSet& sites, const SiteSamples& samples, const SeedOptions& options, Context& context) {
  const int64_t most = sites.voxels.voxel_count() / 2;
  if (options.count < 4)
    throw NoRoom("seeds", std::to_string(options.count) + " vertices are too few; it takes at least 4");
  if (options.count > most) {
    const int32_t resolution = resolution_of(sites.voxels);
    const double factor = std::sqrt(double(options.count) / double(std::max<int64_t>(1, most)));
    throw NoRoom("seeds", std::to_string(options.count) + " vertices are too many for resolution " +
                              std::to_string(resolution) + ", which can carry " + std::to_string(most) +
                              "; use a resolution of at least " +
                              std::to_string(int64_t(std::ceil(resolution * factor))));
  }
  return backend_for(context).place_seeds_on_sites(sites, samples, options, context);
}

}  // namespace isoshell
