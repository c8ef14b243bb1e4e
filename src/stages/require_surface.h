// What stages require of a surface before they run, where its kernels could not tell.
#pragma once

#include <string>

#include "isoshell/advanced/surface_mesh.h"
#include "isoshell/error.h"
#include "stages/require_seeds.h"

namespace isoshell {

/// Of stages that can not do with a border.
inline void require_closed(const SurfaceMesh& surface, const char* stage) {
  if (surface.is_closed()) return;
  throw Error(ErrorCode::usage, stage,
              "the surface has " + std::to_string(surface.chains.count()) +
                  " borders; this stage needs a closed one, as build_sheet makes it");
}

/// Of stages that can do with borders that fixed seeds hold.
inline void require_closed_or_fixed(const SurfaceMesh& surface, const SeedSet& seeds, const char* stage) {
  require_fixed_seeds(surface, seeds, stage);
  if (seeds.fixed.count == 0) return require_closed(surface, stage);
  if (surface.is_closed())
    throw Error(ErrorCode::usage, stage,
                "fixed.count is " + std::to_string(seeds.fixed.count) +
                    " on a closed surface; it must be 0 there: see FixedSeeds");
}

/// Throws unless blocks in host memory hold every vertex once and are of a size that stages can take.
inline void require_block_sizes(const SurfaceMesh& surface, const char* stage) {
  const Buffer<int64_t>& first = surface.blocks.first;
  const auto refuse = [&](int64_t place, const std::string& must_be) {
    throw Error(ErrorCode::usage, stage,
                "blocks.first[" + std::to_string(place) + "] is " + std::to_string(first[place]) + "; it must be " +
                    must_be + ": see VertexBlocks");
  };
  if (first[0] != 0) refuse(0, "0");
  for (int64_t b = 0; b < surface.blocks.count(); ++b)
    if (first[b + 1] <= first[b] || first[b + 1] - first[b] > VertexBlocks::kMostVertices)
      refuse(b + 1, "1 to " + std::to_string(VertexBlocks::kMostVertices) + " more than the one before, " +
                        std::to_string(first[b]));
  const int64_t vertices = surface.vertex_count();
  if (first[surface.blocks.count()] != vertices)
    refuse(surface.blocks.count(), "the number of vertices, " + std::to_string(vertices));
}

/// Of stages that go through the vertices block by block. Where blocks begin is looked at in host memory, where callers
/// may write: what lies on a device was made by build_sheet, and asking for it would stall the device.
inline void require_blocks(const SurfaceMesh& surface, const char* stage) {
  const int64_t blocks = surface.blocks.count(), vertices = surface.vertex_count();
  const int64_t fewest = (vertices + VertexBlocks::kMostVertices - 1) / VertexBlocks::kMostVertices;
  if (blocks >= fewest && blocks <= vertices && surface.blocks.first.size() == blocks + 1) {
    if (surface.blocks.first.space() == MemorySpace::host) require_block_sizes(surface, stage);
    return;
  }
  throw Error(ErrorCode::usage, stage,
              "the surface has " + std::to_string(blocks) + " blocks for " + std::to_string(vertices) +
                  " vertices; every vertex must be in one of 1 to " + std::to_string(VertexBlocks::kMostVertices) +
                  " vertices: see VertexBlocks");
}

}  // namespace isoshell
