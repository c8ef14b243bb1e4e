// What a surface with fixed seeds says of labels: where it is cut into patches, seeds label vertices of their own patch
// only; on borders labels are prescribed.
#pragma once

#include <string>

#include "isoshell/advanced/seed_set.h"
#include "isoshell/advanced/surface_mesh.h"
#include "isoshell/error.h"
#include "voxel/atomic.h"

namespace isoshell {
namespace label {

/// Which seeds may label which vertices. Empty where the surface is not cut: then all may.
struct PatchesView {
  View<const uint32_t> of_vertex;
  View<const uint32_t> of_seed;

  /// kNone where the surface is not cut.
  ISOSHELL_HD uint32_t at(int64_t vertex) const { return of_vertex.size > 0 ? of_vertex[vertex] : kNone; }
  /// Whether a seed may label vertices of a patch.
  ISOSHELL_HD bool has(uint32_t patch, uint32_t seed) const { return patch == kNone || of_seed[seed] == patch; }
};

struct FindPatchOfSeed {
  View<const uint32_t> of_vertex;
  View<const uint32_t> home;
  View<uint32_t> of_seed;
  View<uint32_t> has_seed;  ///< per patch; there are no more patches than seeds
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t patch = of_vertex[home[i]];
    of_seed[i] = patch;
    if (patch < has_seed.size) atomic_max(has_seed[patch], uint32_t(1));
  }
};

struct IsBlockWithoutSeed {
  View<const int64_t> block_first;
  View<const uint32_t> of_vertex;
  View<const uint32_t> has_seed;
  ISOSHELL_HD bool operator()(int64_t block) const {
    const uint32_t patch = of_vertex[block_first[block]];
    return patch >= has_seed.size || has_seed[patch] == 0;
  }
};

struct PrescribeLabel {
  View<const uint32_t> fixed;  ///< per vertex
  View<uint32_t> labels;
  ISOSHELL_HD void operator()(int64_t v) const {
    if (fixed[v] != kNone) labels[v] = fixed[v];
  }
};

}  // namespace label

/// The patch of every seed, that of its home; empty where the surface is not cut. Throws: usage for a patch without a
/// seed, in which a search for the nearest would not end.
template <class Exec>
Buffer<uint32_t> find_patches_of_seeds(Exec& exec, const SurfaceMesh& surface, const SeedSet& seeds) {
  if (surface.patch.empty()) return {};
  const View<const uint32_t> of_vertex = surface.patch.view();
  const View<const int64_t> block_first = surface.blocks.first.view();
  Buffer<uint32_t> of_seed = exec.template make<uint32_t>(seeds.size()),
                   has_seed = exec.template make<uint32_t>(seeds.size());
  exec.fill(has_seed.view(), uint32_t(0));
  exec.for_each("patches of seeds", seeds.size(),
                label::FindPatchOfSeed{of_vertex, seeds.home.view(), of_seed.view(), has_seed.view()});
  const Buffer<uint32_t> without =
      exec.select(surface.blocks.count(), label::IsBlockWithoutSeed{block_first, of_vertex, has_seed.view()});
  if (without.empty()) return of_seed;
  const int64_t vertex = exec.value(block_first, exec.value(without.view(), int64_t(0)));
  throw NoRoom("labels", "patch " + std::to_string(exec.value(of_vertex, vertex)) + " has 0 of the " +
                             std::to_string(seeds.size()) +
                             " seeds; patches are numbered from 0 on, and each needs at least 1: place a seed in it");
}

/// Gives vertices on borders the fixed seeds whose cells they are in, whatever seeds are near.
template <class Exec>
void prescribe_labels(Exec& exec, const FixedSeeds& fixed, View<uint32_t> labels) {
  if (fixed.count == 0) return;
  exec.for_each("prescribe labels", labels.size, label::PrescribeLabel{fixed.of_vertex.view(), labels});
}

}  // namespace isoshell
