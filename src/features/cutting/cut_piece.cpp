// See cut_piece.h.
#include "features/cutting/cut_piece.h"

#include <algorithm>
#include <array>

#include "core/vector_view.h"
#include "features/cutting/curve_seeds.h"
#include "features/cutting/cut_fine_mesh.h"
#include "features/mesh/refine_mesh.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

/// Numbers the vertices of a mesh that some triangles have, by their first corners.
class UsedVertices {
 public:
  explicit UsedVertices(const FineMesh& mesh) : mesh_(mesh), number_(mesh.position.size(), kNone) {}

  uint32_t operator()(uint32_t v, FineMesh& into) {
    if (number_[v] != kNone) return number_[v];
    number_[v] = uint32_t(into.position.size());
    into.position.push_back(mesh_.position[v]);
    into.edge_length.push_back(mesh_.edge_length[v]);
    return number_[v];
  }

 private:
  const FineMesh& mesh_;
  std::vector<uint32_t> number_;
};

std::vector<char> used_by(const DualMesh& mesh, int64_t vertices) {
  std::vector<char> is_used(size_t(vertices), 0);
  for (const TriangleIndices& t : mesh.triangles) is_used[t.a] = is_used[t.b] = is_used[t.c] = 1;
  return is_used;
}

/// What becomes of the seeds that a surface has on its curves once free ones are put behind them.
class GatheredMesh {
 public:
  explicit GatheredMesh(const CutSurface& to) : seeds_(seeds_on_curves(to, 0)) {
    position_.assign(seeds_.position.begin(), seeds_.position.end());
    normal_.assign(seeds_.normal.begin(), seeds_.normal.end());
    home_.assign(seeds_.home.begin(), seeds_.home.end());
    at_ = position_;
  }

  void add(const PatchesMade& from) {
    const SeedSet& seeds = from.made.seeds;
    std::vector<uint32_t> number(size_t(seeds.size()), kNone);
    const std::vector<char> is_used = used_by(from.made.mesh, seeds.size());
    for (int64_t s = 0; s < seeds.size(); ++s) {
      const uint32_t home = from.vertex[seeds.home[s]];
      if (home == kNone || (s >= seeds.fixed.count && !is_used[size_t(s)])) continue;
      number[size_t(s)] = s < seeds.fixed.count ? seeds_.fixed.of_vertex[home] : uint32_t(home_.size());
      if (number[size_t(s)] != home_.size()) continue;
      position_.push_back(seeds.position[s]);
      normal_.push_back(seeds.normal[s]);
      home_.push_back(home);
      at_.push_back(from.made.mesh.position[s]);
    }
    for (const TriangleIndices& t : from.made.mesh.triangles) {
      if (number[t.a] == kNone || number[t.b] == kNone || number[t.c] == kNone) continue;
      std::array<uint32_t, 3> corner{number[t.a], number[t.b], number[t.c]};
      std::rotate(corner.begin(), std::min_element(corner.begin(), corner.end()), corner.end());
      triangles_.push_back(corner);
    }
  }

  SeededMesh take() {
    std::sort(triangles_.begin(), triangles_.end());
    Buffer<TriangleIndices> triangles(int64_t(triangles_.size()));
    for (size_t t = 0; t < triangles_.size(); ++t)
      triangles[int64_t(t)] = {triangles_[t][0], triangles_[t][1], triangles_[t][2]};
    seeds_.position = buffer_of(position_);
    seeds_.normal = buffer_of(normal_);
    seeds_.home = buffer_of(home_);
    return {{buffer_of(at_), std::move(triangles)}, std::move(seeds_)};
  }

 private:
  SeedSet seeds_;
  std::vector<PointQ8> position_, at_;  ///< of the seeds, of the vertices of the mesh
  std::vector<Normal8> normal_;
  std::vector<uint32_t> home_;
  std::vector<std::array<uint32_t, 3>> triangles_;  ///< each from its smallest corner
};

}  // namespace

CutPiece piece_of(const CutSurface& whole, const std::vector<char>& is_chosen, Context& context) {
  const FineMesh& mesh = *whole.fine;
  const auto patch_of = [&](size_t t) { return whole.surface.patch[whole.corner[3 * t]]; };
  auto fine = std::make_shared<FineMesh>();
  UsedVertices used(mesh);
  std::vector<size_t> source;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!is_chosen[patch_of(t)]) continue;
    const auto& [a, b, c] = mesh.triangles[t];
    const uint32_t u = used(a, *fine), v = used(b, *fine), w = used(c, *fine);
    fine->triangles.push_back({u, v, w});
    source.push_back(t);
  }
  for (size_t c = 0; c < mesh.paths.size(); ++c) {
    const std::vector<uint32_t>& beside = whole.curves[c].patches;
    if (std::none_of(beside.begin(), beside.end(), [&](uint32_t p) { return is_chosen[p]; })) continue;
    fine->paths.push_back(mesh.paths[c]);
    for (uint32_t& v : fine->paths.back().vertex) v = used(v, *fine);
  }
  CutPiece piece{cut_fine_mesh(std::move(fine), whole.frame, context), {}};
  piece.cut.regions = whole.regions;
  piece.in_whole.resize(size_t(piece.cut.surface.vertex_count()));
  for (size_t t = 0; t < source.size(); ++t)
    for (size_t i = 0; i < 3; ++i) piece.in_whole[piece.cut.corner[3 * t + i]] = whole.corner[3 * source[t] + i];
  return piece;
}

std::vector<uint32_t> vertices_in(const CutSurface& cut, const std::vector<char>& stays) {
  std::vector<uint32_t> vertex(size_t(cut.surface.vertex_count()), kNone);
  for (size_t v = 0; v < vertex.size(); ++v)
    if (stays[cut.surface.patch[int64_t(v)]]) vertex[v] = uint32_t(v);
  return vertex;
}

std::vector<uint32_t> in_piece(const CutPiece& piece, const CutSurface& whole) {
  std::vector<uint32_t> vertex(size_t(whole.surface.vertex_count()), kNone);
  for (size_t v = 0; v < piece.in_whole.size(); ++v) vertex[piece.in_whole[v]] = uint32_t(v);
  return vertex;
}

SeededMesh gather_patches(const CutSurface& to, const std::vector<PatchesMade>& from) {
  GatheredMesh gathered(to);
  for (const PatchesMade& part : from) gathered.add(part);
  return gathered.take();
}

}  // namespace isoshell
