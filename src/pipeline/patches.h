// A run whose result keeps the input's creases: on the input's own triangles, cut along its curves into patches.
#pragma once

#include <optional>

#include "isoshell/remesh.h"

namespace isoshell {

/// Finds the features that the options ask for, and cuts the surface along them. Leaves p.cut empty where there are
/// none, and says in the report why where there are some that cannot be kept.
void cut_into_patches(const RemeshOptions& options, Prepared& p, RemeshReport& report, Context& context);

/// Fixes seeds on the curves, and relaxes the others between them. `seeds.count` is that of the result's vertices: a
/// place of a curve counts once, though each patch there has a seed.
RelaxedSeeds relax_in_patches(const Prepared& p, const SeedOptions& seeds, const RelaxOptions& relax, Context& context);

/// The mesh of the patches, joined along their curves; its vertices are as many as seeds were relaxed, each place of a
/// curve counted once. None where cells are no disks, triangles intersect, or patches touch elsewhere than along a
/// curve: report.features says so.
std::optional<TriangleMesh> triangulate_patches(const Prepared& p, SeededMesh& made, const OptimizeOptions& options,
                                                RemeshReport& report, Context& context);

}  // namespace isoshell
