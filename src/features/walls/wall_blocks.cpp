// WallBlocks (see wall_blocks.h).
#include "features/walls/wall_blocks.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

constexpr double kLowestQ8 = double(1 << 24);  ///< that no lattice coordinate is as far below 0 as
constexpr int kBitsOfAxis = 21;
constexpr double kEdges = 16;

}  // namespace

WallBlocks::WallBlocks(const WallMesh& mesh, double side_q8, bool is_shifted)
    : mesh_(&mesh),
      side_q8_(std::max(side_q8, kLowestQ8 / double(1 << (kBitsOfAxis - 3)))),
      shift_q8_(kLowestQ8 + (is_shifted ? side_q8_ / 2 : 0)),
      block_of_(mesh.vertices().size(), kNone) {
  std::vector<std::pair<uint64_t, uint32_t>> found;
  for (uint32_t v = 0; v < block_of_.size(); ++v)
    if (!mesh.around(v).empty()) found.push_back({key(mesh.at(v)), v});
  std::sort(found.begin(), found.end());
  for (const auto& [at, v] : found) {
    if (keys_.empty() || keys_.back() != at) {
      keys_.push_back(at);
      first_.push_back(vertices_.size());
    }
    block_of_[v] = uint32_t(keys_.size() - 1);
    if (!mesh.vertex(v).is_settled) vertices_.push_back(v);
  }
  first_.push_back(vertices_.size());
}

uint64_t WallBlocks::key(const WorldPoint& p) const {
  const auto cell = [&](double at) { return uint64_t((at + shift_q8_) / side_q8_); };
  return cell(p.x) << (2 * kBitsOfAxis) | cell(p.y) << kBitsOfAxis | cell(p.z);
}

bool WallBlocks::holds_around(size_t block, uint32_t v) const {
  if (block_of_[v] != block) return false;
  const std::vector<uint32_t>& around = mesh_->around(v);
  return std::all_of(around.begin(), around.end(), [&](uint32_t t) {
    const auto& corner = mesh_->triangles()[t].corner;
    return block_of_[corner[0]] == block && block_of_[corner[1]] == block && block_of_[corner[2]] == block;
  });
}

double side_of_blocks_q8(const WallMesh& mesh, int64_t vertices) {
  double doubled = 0;
  for (const RegionTriangle& t : mesh.triangles())
    if (!t.is_gone()) doubled += length(mesh.normal(t));
  return kEdges * std::sqrt(2 * doubled / (kTwoRootThree * double(vertices)));
}

}  // namespace isoshell
