// The joined mesh of patches, to be changed region by region.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "features/angles/mesh_region.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// The mesh of patches put together, and what its vertices and edges lie on.
struct JoinedPatches {
  DualMesh mesh;
  Buffer<uint32_t> home;  ///< per vertex one of the surface, one of the copies where it has several
  MeshFeatures features;
  int64_t on_curves = 0;   ///< vertices on curves and corners
  int64_t left_alone = 0;  ///< poor triangles that there were too many of to look at
};

/// What becomes of the mesh of patches.
struct JoinOptions {
  int64_t vertices;  ///< that it is to have
  /// In a frame that follows another: vertices come and go only where no triangle is poor then, or that halves a cost.
  bool is_steady = false;
  /// Looks at poor triangles, beside some thousands: what bounds the time. Few meshes take a third of it.
  int64_t tries_per_vertex = 1;
};

/// Changes are made only where no triangle comes to meet another one outside of corners that they share.
class PatchMesh : public EditableMesh {
 public:
  PatchMesh(const CutSurface& cut, const SeededMesh& made, const JoinOptions& options);
  /// Of such a mesh, of many triangles; vertices without triangles are none of it.
  PatchMesh(std::shared_ptr<const CutLookup> lookup, EditableMesh mesh, const JoinOptions& options);

  const CutLookup& lookup() const { return *lookup_; }
  const std::shared_ptr<const CutLookup>& shared_lookup() const { return lookup_; }
  /// Triangles with an angle below 30 degrees, the worst first.
  std::vector<uint32_t> poor_triangles() const;
  /// For each of the triangles the change of what is around it that leaves the least cost, where one leaves less.
  /// Result: whether anything was changed. The same for every number of threads.
  bool improve(std::vector<uint32_t> triangles);
  const JoinOptions& options() const { return options_; }
  /// Poor triangles that were not looked at.
  int64_t left_alone() const { return left_alone_; }
  int64_t surplus() const { return vertex_count() - options_.vertices; }
  /// Collapses or splits edges until there is no surplus, as far as that spoils no triangles.
  void meet_count(const Context& context);

  JoinedPatches joined() const;

 private:
  /// Triangles around some vertices, the first ones of the region.
  struct Cutout {
    std::vector<uint32_t> triangles;  ///< of the mesh
    MeshRegion region;
  };
  /// What an edge less, or a vertex in it, makes of what is around it.
  struct Recount {
    std::optional<Cutout> cutout;  ///< none: the edge does not take part
    std::optional<MeshRegion> made;
  };
  struct Change {
    enum { split, collapse } what;
    uint32_t u, v;
  };
  /// Which edges are split and collapsed: those at the corners of a triangle, or the others that are two rings around.
  enum class Reach { corners, beyond };

  std::vector<uint64_t> edges_by_length() const;
  bool may_recount(uint64_t edge, size_t pass) const;
  Recount recount_at(uint64_t edge) const;
  bool is_stale(const Recount& recount) const;
  void recount_edges(const std::vector<uint64_t>& edges, size_t pass, int64_t tries, const Context& context);

  std::vector<uint32_t> triangles_around(std::vector<uint32_t> vertices) const;
  Cutout cut_out(const std::vector<uint32_t>& vertices, const std::vector<uint32_t>& triangles) const;
  std::vector<uint32_t> take_apart(std::vector<uint32_t>& triangles) const;
  bool put_back(const Cutout& cutout, const MeshRegion& region);
  void note(const std::vector<uint32_t>& triangles);

  static std::vector<Change> changes_of(const MeshRegion& region, Reach reach);
  static bool make_change(MeshRegion& region, const Change& change);
  static std::vector<MeshRegion> promising(const MeshRegion& region, Reach reach);
  static void search(const MeshRegion& start, const MeshRegion& from, Reach reach, MeshRegion& best,
                     std::vector<MeshRegion>* made);
  std::optional<MeshRegion> improved(const MeshRegion& start) const;
  std::optional<MeshRegion> recounted(const MeshRegion& start) const;

  PatchMesh(const std::shared_ptr<const CutLookup>& lookup, const SeededMesh& made, const JoinOptions& options);

  std::shared_ptr<const CutLookup> lookup_;
  std::vector<char> is_hopeless_;      ///< per triangle: nothing changed since it was tried
  std::vector<uint32_t> replaced_at_;  ///< per vertex when one of its triangles was replaced last
  uint32_t clock_ = 0;                 ///< edges looked at together so far
  JoinOptions options_;
  bool are_last_ = false;   ///< few triangles of the mesh are poor
  int64_t tries_ = 0;       ///< that are left
  int64_t left_alone_ = 0;  ///< triangles without one
};

}  // namespace isoshell
