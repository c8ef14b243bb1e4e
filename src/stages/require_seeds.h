// What stages require of fixed seeds before they run, where their kernels could not tell.
#pragma once

#include <string>

#include "isoshell/advanced/seed_set.h"
#include "isoshell/advanced/surface_mesh.h"
#include "isoshell/error.h"

namespace isoshell {

/// Of stages that take fixed seeds: their arrays are of this surface and of these seeds. Arrays may lie anywhere.
inline void require_fixed_seeds(const SurfaceMesh& surface, const SeedSet& seeds, const char* stage) {
  const FixedSeeds& fixed = seeds.fixed;
  const auto require = [&](const std::string& name, int64_t value, const std::string& must_be, bool holds) {
    if (holds) return;
    throw Error(ErrorCode::usage, stage,
                name + " is " + std::to_string(value) + "; it must be " + must_be + ": see FixedSeeds");
  };
  require("fixed.count", fixed.count, "0 to the number of seeds, " + std::to_string(seeds.size()),
          fixed.count >= 0 && fixed.count <= seeds.size());
  if (fixed.count == 0) return;
  require("fixed.of_vertex.size()", fixed.of_vertex.size(),
          "the number of vertices, " + std::to_string(surface.vertex_count()),
          fixed.of_vertex.size() == surface.vertex_count());
  require("fixed.joined.size()", fixed.joined.size(), "fixed.count, " + std::to_string(fixed.count),
          fixed.joined.size() == fixed.count);
}

}  // namespace isoshell
