// Some patches of a cut surface as a surface of their own, and meshes that go from one to the other.
#pragma once

#include "core/copy_product.h"
#include "features/cutting/cut_surface.h"
#include "isoshell/advanced/stages.h"

namespace isoshell {

struct CutPiece {
  CutSurface cut;
  std::vector<uint32_t> in_whole;  ///< per vertex of its surface that of the whole one
};

/// `is_chosen`: per patch of the whole surface, which patches the piece has. Cost: as cut_fine_mesh of these.
CutPiece piece_of(const CutSurface& whole, const std::vector<char>& is_chosen, Context& context);

/// Each vertex of a surface in the patches that stay; kNone in the others.
std::vector<uint32_t> vertices_in(const CutSurface& cut, const std::vector<char>& stays);

/// The inverse of where the vertices of a piece are in the whole: kNone off the piece.
std::vector<uint32_t> in_piece(const CutPiece& piece, const CutSurface& whole);

inline void bring_to_host(SeededMesh& made) {
  on_host(made.mesh);
  on_host(made.seeds);
}

/// A mesh of some patches, in host memory.
struct PatchesMade {
  const SeededMesh& made;
  const std::vector<uint32_t>& vertex;  ///< per vertex of its surface that of the surface it goes to; kNone: left out
};

/// The mesh of a surface from meshes of its patches, each of which is in one of them or in none: the seeds on its
/// curves, then the free ones as they come. Free seeds without triangles are left out. In host memory.
SeededMesh gather_patches(const CutSurface& to, const std::vector<PatchesMade>& from);

}  // namespace isoshell
