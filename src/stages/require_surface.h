// What stages require of a surface before they run, where its kernels could not tell.
#pragma once

#include <string>

#include "isoshell/error.h"
#include "isoshell/surface_mesh.h"

namespace isoshell {

/// Of stages that can not do with a border.
inline void require_closed(const SurfaceMesh& surface, const char* stage) {
  if (surface.is_closed()) return;
  throw Error(ErrorCode::usage, stage,
              "the surface has " + std::to_string(surface.chains.count()) +
                  " borders; this stage needs a closed one, as build_sheet makes it");
}

/// Of stages that go through the vertices block by block.
inline void require_blocks(const SurfaceMesh& surface, const char* stage) {
  const int64_t blocks = surface.blocks.count(), vertices = surface.vertex_count();
  const int64_t fewest = (vertices + VertexBlocks::kMostVertices - 1) / VertexBlocks::kMostVertices;
  if (blocks >= fewest && blocks <= vertices && surface.blocks.first.size() == blocks + 1) return;
  throw Error(ErrorCode::usage, stage,
              "the surface has " + std::to_string(blocks) + " blocks for " + std::to_string(vertices) +
                  " vertices; every vertex must be in one of 1 to " + std::to_string(VertexBlocks::kMostVertices) +
                  " vertices: see VertexBlocks");
}

}  // namespace isoshell
