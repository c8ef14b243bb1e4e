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

constexpr uint32_t kNotCoarse = uint32_t(1) << 31;  ///< first number of vertices that coarse patches have not
constexpr int64_t kAtFirst = 2;  ///< vertices for one: so many still lie where the walls do, beside relaxed triangles
constexpr int64_t kFewest = 4;   ///< vertices that coarse patches are asked for at least

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
    count_ = std::count(is_used.begin(), is_used.end(), 1);
    for (uint32_t v = 0; v < vertices_.size(); ++v)
      if (is_used[v] && vertices_[v].kind != Kind::free) at_place_[cut.place[vertices_[v].home]] = v;
  }

  int64_t count() const { return count_; }
  /// The vertex that is where one of the fine mesh is, on a curve; kNone where there is none.
  uint32_t at(const RegionVertex& v) const { return v.kind == Kind::free ? kNone : at_place_[cut_.place[v.home]]; }
  /// With the numbers that a mesh of coarse patches has for its vertices, and numbers that it never has for others.
  std::vector<RegionTriangle> triangles(const WallMesh& coarse) const {
    std::vector<uint32_t> number(vertices_.size());
    for (uint32_t v = 0; v < number.size(); ++v) number[v] = kNotCoarse + v;
    for (uint32_t v = 0; v < coarse.vertices().size(); ++v)
      if (const uint32_t here = coarse.around(v).empty() ? kNone : at(coarse.vertex(v)); here != kNone)
        number[here] = v;
    std::vector<RegionTriangle> out = triangles_;
    for (RegionTriangle& t : out)
      for (uint32_t& v : t.corner) v = number[v];
    return out;
  }
  std::vector<CornersOfTriangle> corners(const std::vector<RegionTriangle>& numbered) const {
    std::vector<CornersOfTriangle> out(numbered.size());
    for (size_t t = 0; t < out.size(); ++t)
      for (size_t i = 0; i < 3; ++i)
        out[t].id[i] = numbered[t].corner[i], out[t].at[i] = rounded(vertices_[triangles_[t].corner[i]].position);
    return out;
  }
  /// Together with coarse patches whose curves have the same vertices.
  PatchMesh with(const WallMesh& coarse, const JoinOptions& options) && {
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
    return PatchMesh(cut_, std::move(vertices_), std::move(triangles_), options);
  }

 private:
  const CutSurface& cut_;
  std::vector<RegionVertex> vertices_;
  std::vector<RegionTriangle> triangles_;
  std::vector<uint32_t> at_place_;  ///< per place of a curve the vertex there
  int64_t count_ = 0;
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

/// Keeps the vertices of curves beside relaxed patches that these have. Result: the other ones of such curves.
std::vector<uint32_t> keep_seeds(const RelaxedPart& relaxed, const std::vector<char>& is_coarse, WallMesh& coarse) {
  const std::vector<CutCurve>& curves = coarse.lookup().cut().curves;
  const auto is_shared = [&](uint32_t curve) {
    const std::vector<uint32_t>& patches = curves[curve].patches;
    return !std::all_of(patches.begin(), patches.end(), [&](uint32_t patch) { return is_coarse[patch]; });
  };
  std::vector<uint32_t> others;
  for (uint32_t v = 0; v < coarse.vertices().size(); ++v) {
    const RegionVertex& vertex = coarse.vertex(v);
    if (coarse.around(v).empty() || vertex.kind == Kind::free) continue;
    if (relaxed.at(vertex) != kNone) {
      coarse.keep(v);
    } else if (vertex.kind == Kind::on_curve && is_shared(vertex.curve)) {
      others.push_back(v);
    }
  }
  return others;
}

int64_t count_kept(const RelaxedPart& relaxed, const WallMesh& coarse) {
  int64_t count = 0;
  for (uint32_t v = 0; v < coarse.vertices().size(); ++v)
    count += !coarse.around(v).empty() && relaxed.at(coarse.vertex(v)) != kNone ? 1 : 0;
  return count;
}

/// Takes vertices into those beside them on their curves. Result: those that cannot go.
std::vector<uint32_t> without(std::vector<uint32_t> vertices, WallMesh& mesh) {
  WallScratch scratch;
  std::vector<uint32_t> targets;
  for (const WallMesh::Shapes shapes : {WallMesh::Shapes::good, WallMesh::Shapes::any}) {
    const auto is_gone = [&](uint32_t v) {
      if (mesh.around(v).empty()) return true;
      mesh.list_targets(v, targets);
      return std::any_of(targets.begin(), targets.end(),
                         [&](uint32_t into) { return mesh.collapse(v, into, scratch, shapes); });
    };
    for (size_t before = vertices.size() + 1; vertices.size() < before;) {
      before = vertices.size();
      vertices.erase(std::remove_if(vertices.begin(), vertices.end(), is_gone), vertices.end());
    }
  }
  return vertices;
}

/// From now on coarse triangles come to meet no relaxed ones. Result: the patches of those that they meet already.
std::vector<uint32_t> list_met(const RelaxedPart& relaxed, const std::vector<RegionTriangle>& numbered,
                               WallMesh& coarse) {
  coarse.avoid(relaxed.corners(numbered));
  std::vector<uint32_t> patches;
  for (const RegionTriangle& t : coarse.triangles())
    if (!t.is_gone()) coarse.for_each_met(t, [&](uint32_t other) { patches.push_back(numbered[other].patch); });
  return patches;
}

}  // namespace

std::optional<PatchMesh> coarsen_patches(const CutSurface& cut, const PatchMesh& relaxed, std::vector<char>& is_coarse,
                                         const JoinOptions& options, const Context& context) {
  return run_with_threads(context, [&]() -> std::optional<PatchMesh> {
    RelaxedPart others(cut, relaxed, is_coarse);
    const FinePatches fine(cut, is_coarse);
    WallMesh coarse(cut, {fine.triangles, fine.source_face});
    std::vector<uint32_t> between = keep_seeds(others, is_coarse, coarse);
    const int64_t vertices = std::max(options.vertices - others.count() + count_kept(others, coarse), kFewest);
    const std::vector<RegionTriangle> around = others.triangles(coarse);
    coarse.avoid_twins_of(around);
    coarsen(coarse, kAtFirst * vertices, context);
    between = without(std::move(between), coarse);
    std::vector<uint32_t> more;
    for (const uint32_t v : between) {
      const std::vector<uint32_t>& patches = cut.curves[coarse.vertex(v).curve].patches;
      more.insert(more.end(), patches.begin(), patches.end());
    }
    if (between.empty()) more = list_met(others, around, coarse);
    for (const uint32_t patch : more) is_coarse[patch] = 1;
    if (!more.empty()) return {};
    coarsen(coarse, vertices, context);
    even_out(coarse, vertices, context);
    return std::move(others).with(coarse, options);
  });
}

}  // namespace isoshell
