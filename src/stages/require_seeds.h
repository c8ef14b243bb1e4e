// What stages require of seeds before they run, where their kernels could not tell.
#pragma once

#include <algorithm>
#include <string>

#include "isoshell/advanced/seed_set.h"
#include "isoshell/advanced/surface_mesh.h"
#include "isoshell/error.h"

namespace isoshell {

/// Of stages that begin where seeds are: each has a home on this surface. Homes are looked at in host memory, where
/// callers may write, and where seeds of another surface would be: see require_blocks.
inline void require_homes(const SurfaceMesh& surface, const SeedSet& seeds, const char* stage) {
  const Buffer<uint32_t>& home = seeds.home;
  const int64_t vertices = surface.vertex_count();
  if (home.size() != seeds.size())
    throw Error(ErrorCode::usage, stage,
                "home.size() is " + std::to_string(home.size()) + "; it must be the number of seeds, " +
                    std::to_string(seeds.size()) + ": see SeedSet");
  if (home.empty() || home.space() != MemorySpace::host) return;
  const auto wrong = std::find_if(home.begin(), home.end(), [&](uint32_t v) { return v >= vertices; });
  if (wrong == home.end()) return;
  throw Error(ErrorCode::usage, stage,
              "home[" + std::to_string(wrong - home.begin()) + "] is " + std::to_string(*wrong) +
                  "; it must be one of the " + std::to_string(vertices) + " vertices of the surface: see SeedSet");
}

/// Of stages that take fixed seeds: homes, and arrays that are of this surface and of these seeds. Arrays may lie
/// anywhere.
inline void require_fixed_seeds(const SurfaceMesh& surface, const SeedSet& seeds, const char* stage) {
  require_homes(surface, seeds, stage);
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
