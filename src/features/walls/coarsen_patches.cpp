// coarsen_patches (see coarsen_patches.h).
#include "features/walls/coarsen_patches.h"

#include <algorithm>
#include <utility>

#include "core/watched.h"
#include "features/mesh/feature_mesh.h"
#include "features/walls/coarsen.h"
#include "features/walls/even_out.h"

namespace isoshell {
namespace {

using Kind = RegionVertex::Kind;

/// Vertices of relaxed patches that coarse ones do not have are numbered from here on where both are looked at.
constexpr uint32_t kFirstOfRelaxed = uint32_t(1) << 31;
/// Vertices before seeds alone are left on shared curves, for one that coarse patches will have. Triangles of half the
/// edge lie about where the walls do, so that few meet relaxed ones.
constexpr int64_t kAtFirst = 2;

/// The triangles of relaxed patches, and which of their vertices are on curves.
class RelaxedPart {
 public:
  RelaxedPart(const CutSurface& cut, const PatchMesh& mesh, const std::vector<char>& is_coarse)
      : cut_(cut), vertices_(mesh.vertices()), at_place_(cut.copies_first.size() - 1, kNone) {
    std::vector<char> is_used(vertices_.size(), 0);
    for (const RegionTriangle& t : mesh.triangles()) {
      if (t.is_gone() || is_coarse[t.patch]) continue;
      triangles_.push_back(t);
      for (const uint32_t v : t.corner) is_used[v] = 1;
    }
    others_ = std::count(is_used.begin(), is_used.end(), 0);
    for (uint32_t v = 0; v < vertices_.size(); ++v)
      if (is_used[v] && vertices_[v].kind != Kind::free) at_place_[cut.place[vertices_[v].home]] = v;
  }

  /// Vertices of the patches that are not here, but those that are shared.
  int64_t count_others() const { return others_; }
  /// The vertex that is where one of the fine mesh is, on a curve; kNone where there is none.
  uint32_t at(const RegionVertex& v) const { return v.kind == Kind::free ? kNone : at_place_[cut_.place[v.home]]; }
  /// The triangles with the numbers that a mesh of coarse patches has for vertices, or numbers that it never has.
  std::vector<RegionTriangle> numbered_as(const WallMesh& coarse) const {
    std::vector<uint32_t> number(vertices_.size());
    for (uint32_t v = 0; v < number.size(); ++v) number[v] = kFirstOfRelaxed + v;
    for (uint32_t v = 0; v < coarse.vertices().size(); ++v)
      if (const uint32_t here = coarse.around(v).empty() ? kNone : at(coarse.vertex(v)); here != kNone)
        number[here] = v;
    std::vector<RegionTriangle> out = triangles_;
    for (RegionTriangle& t : out)
      for (uint32_t& v : t.corner) v = number[v];
    return out;
  }
  /// Where the triangles are, with those numbers.
  std::vector<CornersOfTriangle> corners(const std::vector<RegionTriangle>& numbered) const {
    std::vector<CornersOfTriangle> out(triangles_.size());
    for (size_t t = 0; t < out.size(); ++t)
      for (size_t i = 0; i < 3; ++i) {
        out[t].id[i] = numbered[t].corner[i];
        out[t].at[i] = rounded(vertices_[triangles_[t].corner[i]].position);
      }
    return out;
  }
  /// Together with coarse patches whose curves have the same vertices.
  PatchMesh joined_with(const WallMesh& coarse, const JoinOptions& options) && {
    std::vector<uint32_t> number(coarse.vertices().size(), kNone);
    for (uint32_t v = 0; v < number.size(); ++v) {
      if (coarse.around(v).empty()) continue;
      number[v] = at(coarse.vertex(v));
      if (number[v] != kNone) continue;
      number[v] = uint32_t(vertices_.size());
      vertices_.push_back(coarse.vertex(v));
    }
    for (RegionTriangle t : coarse.triangles()) {
      if (t.is_gone()) continue;
      for (uint32_t& v : t.corner) v = number[v];
      triangles_.push_back(t);
    }
    return PatchMesh(coarse.shared_lookup(), {std::move(vertices_), std::move(triangles_), EditableMesh::Size::many},
                     options);
  }

 private:
  const CutSurface& cut_;
  std::vector<RegionVertex> vertices_;
  std::vector<RegionTriangle> triangles_;
  std::vector<uint32_t> at_place_;  ///< per place of a curve the vertex there
  int64_t others_ = 0;
};

/// The fine triangles of some patches.
struct FinePatches {
  MeshTriangles triangles;
  std::vector<uint32_t> source_face;

  FinePatches(const CutSurface& cut, const std::vector<char>& is_chosen) {
    for (size_t t = 0; t < cut.fine->triangles.size(); ++t) {
      if (!is_chosen[cut.surface.patch[cut.corner[3 * t]]]) continue;
      triangles.push_back(cut.fine->triangles[t]);
      source_face.push_back(cut.fine->source_face[t]);
    }
  }
};

/// Of the vertices on curves that coarse patches share with relaxed ones.
struct SharedVertices {
  int64_t seeds = 0;              ///< that relaxed patches have; they stay
  std::vector<uint32_t> between;  ///< the others, which must go
};

SharedVertices keep_seeds(const RelaxedPart& relaxed, const std::vector<char>& is_coarse, WallMesh& coarse) {
  const std::vector<CutCurve>& curves = coarse.lookup().cut().curves;
  const auto is_shared = [&](uint32_t curve) {
    const std::vector<uint32_t>& patches = curves[curve].patches;
    return !std::all_of(patches.begin(), patches.end(), [&](uint32_t patch) { return is_coarse[patch]; });
  };
  SharedVertices shared;
  for (uint32_t v = 0; v < coarse.vertices().size(); ++v) {
    const RegionVertex& vertex = coarse.vertex(v);
    if (coarse.around(v).empty() || vertex.kind == Kind::free) continue;
    if (relaxed.at(vertex) != kNone) {
      coarse.keep(v);
      ++shared.seeds;
    } else if (vertex.kind == Kind::on_curve && is_shared(vertex.curve)) {
      shared.between.push_back(v);
    }
  }
  return shared;
}

/// Takes vertices into those beside them on their curves. Result: those that cannot go.
std::vector<uint32_t> left_of(std::vector<uint32_t> vertices, WallMesh& mesh, const Context& context) {
  MeshChange scratch;
  std::vector<uint32_t> targets;
  for (const WallMesh::Shapes shapes : {WallMesh::Shapes::good, WallMesh::Shapes::any}) {
    const auto goes = [&](uint32_t v) {
      if (mesh.around(v).empty()) return true;
      mesh.list_targets(v, targets);
      return std::any_of(targets.begin(), targets.end(),
                         [&](uint32_t into) { return mesh.collapse(v, into, scratch, shapes); });
    };
    for (size_t before = vertices.size() + 1; vertices.size() < before;) {
      check_cancel(context, "features");
      before = vertices.size();
      vertices.erase(std::remove_if(vertices.begin(), vertices.end(), goes), vertices.end());
    }
  }
  return vertices;
}

std::vector<uint32_t> patches_beside(const std::vector<uint32_t>& vertices, const WallMesh& mesh) {
  std::vector<uint32_t> patches;
  for (const uint32_t v : vertices) {
    const std::vector<uint32_t>& beside = mesh.lookup().cut().curves[mesh.vertex(v).curve].patches;
    patches.insert(patches.end(), beside.begin(), beside.end());
  }
  return patches;
}

/// The patches of relaxed triangles that meet coarse ones, or have an edge that these have at another place. From now
/// on no change makes more of them.
std::vector<uint32_t> patches_met(const RelaxedPart& relaxed, const std::vector<RegionTriangle>& numbered,
                                  WallMesh& coarse) {
  coarse.avoid(coarse.lookup().cut().longest_edge_q8, relaxed.corners(numbered));
  std::vector<uint32_t> patches;
  for (const RegionTriangle& t : coarse.triangles())
    if (!t.is_gone()) coarse.for_each_met(t, [&](uint32_t other) { patches.push_back(numbered[other].patch); });
  for (const RegionTriangle& t : numbered)
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t u = t.corner[i], v = t.corner[(i + 1) % 3];
      if (std::max(u, v) >= kFirstOfRelaxed) continue;
      const std::optional<uint32_t> curve = coarse.curve_between(u, v);
      if (curve && (t.curve[i] == kNone || *curve != t.curve[i])) patches.push_back(t.patch);
    }
  return patches;
}

}  // namespace

std::optional<PatchMesh> coarsen_patches(const CutSurface& cut, const PatchMesh& relaxed, std::vector<char>& is_coarse,
                                         const JoinOptions& options, const Context& context) {
  return run_with_threads(context, [&]() -> std::optional<PatchMesh> {
    RelaxedPart part(cut, relaxed, is_coarse);
    const FinePatches fine(cut, is_coarse);
    WallMesh coarse(cut, {fine.triangles, fine.source_face, cut.fine->position.size()});
    SharedVertices shared = keep_seeds(part, is_coarse, coarse);
    const int64_t vertices = shared.seeds + part.count_others();
    const std::vector<RegionTriangle> numbered = part.numbered_as(coarse);
    coarse.avoid_twins_of(numbered);
    coarsen(coarse, kAtFirst * vertices, context);
    const std::vector<uint32_t> left = left_of(std::move(shared.between), coarse, context);
    const std::vector<uint32_t> more =
        left.empty() ? patches_met(part, numbered, coarse) : patches_beside(left, coarse);
    for (const uint32_t patch : more) is_coarse[patch] = 1;
    if (!more.empty()) return {};
    coarsen(coarse, vertices, context);
    even_out(coarse, vertices, context);
    return std::move(part).joined_with(coarse, options);
  });
}

}  // namespace isoshell
