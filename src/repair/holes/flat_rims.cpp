#include "repair/holes/flat_rims.h"

#include <algorithm>
#include <cmath>

namespace isoshell::repair {
namespace {

constexpr double kFlat = 1e-5;          // of the loop's reach: coordinates are floats in most files
constexpr double kSameSide = .99;       // cosine between a face and the plane that it lies in
constexpr double kStraight = .8;        // cosine between edges of one side, which may be round: 37 degrees
constexpr double kLeastShare = 1. / 3;  // of a loop, beside which pieces of its face are

/// Tells which faces lie in the plane of a loop.
class FacesInPlane {
 public:
  FacesInPlane(const RepairMesh& mesh, const FlatRim& rim) : mesh_(mesh), rim_(rim) {}

  bool has(uint32_t f) const {
    const WorldPoint n = mesh_.doubled_area(f);
    return dot(n, rim_.normal) > kSameSide * length(n) &&
           std::all_of(mesh_.face[f].begin(), mesh_.face[f].end(),
                       [&](uint32_t v) { return rim_.holds(mesh_.position[v]); });
  }

  /// The half-edge at the other end of a face's pieces around the start of a boundary one, and which arrives there.
  uint32_t last_before(uint32_t out) const {
    uint32_t in = next_in_triangle(next_in_triangle(out));
    for (uint32_t other; (other = across(in)) != kNoFace; in = next_in_triangle(next_in_triangle(other))) {
    }
    return in;
  }
  /// The same around the end of a boundary half-edge; it leaves there.
  uint32_t first_after(uint32_t in) const {
    uint32_t out = next_in_triangle(in);
    for (uint32_t other; (other = across(out)) != kNoFace; out = next_in_triangle(other)) {
    }
    return out;
  }

 private:
  /// kNoFace where no piece of the face is on the other side. Around a vertex with a boundary the way ends.
  uint32_t across(uint32_t h) const {
    if (mesh_.faces_at(mesh_.edge_of(h)) != 2 || !mesh_.agrees(h)) return kNoFace;
    const uint32_t twin = mesh_.twin(h);
    return has(twin / 3) ? twin : kNoFace;
  }

  const RepairMesh& mesh_;
  const FlatRim& rim_;
};

bool go_straight(const RepairMesh& mesh, uint32_t from, uint32_t by, uint32_t to) {
  const WorldPoint in = mesh.position[by] - mesh.position[from], out = mesh.position[to] - mesh.position[by];
  return dot(in, out) > kStraight * length(in) * length(out);
}

}  // namespace

std::optional<FlatRim> flat_rim(const RepairMesh& mesh, const Loop& loop) {
  FlatRim rim = {mesh.position[mesh.from(loop[0])], {0, 0, 0}};
  double reach_sq = 0;
  for (const uint32_t h : loop) {
    const WorldPoint p = mesh.position[mesh.from(h)] - rim.at, q = mesh.position[mesh.to(h)] - rim.at;
    rim.normal = rim.normal + cross(q, p);  // a face passes the loop the other way
    reach_sq = std::max(reach_sq, length_sq(p));
  }
  const double size = length(rim.normal);
  rim.tolerance = kFlat * std::sqrt(reach_sq);
  if (!(size > rim.tolerance * rim.tolerance)) return {};
  rim.area = size / 2;
  rim.normal = 1 / size * rim.normal;
  const auto is_off = [&](uint32_t h) { return !rim.holds(mesh.position[mesh.from(h)]); };
  if (std::any_of(loop.begin(), loop.end(), is_off)) return {};
  return rim;
}

bool is_piece_of_face(const RepairMesh& mesh, const Loop& loop, const FlatRim& rim) {
  const FacesInPlane pieces(mesh, rim);
  double whole = 0, beside = 0;
  std::vector<uint8_t> is_piece;
  for (const uint32_t h : loop) {
    const double size = length(mesh.position[mesh.to(h)] - mesh.position[mesh.from(h)]);
    is_piece.push_back(pieces.has(h / 3));
    whole += size;
    if (is_piece.back()) beside += size;
  }
  if (beside < kLeastShare * whole) return false;
  bool turns = false;
  for (size_t i = 0, before = loop.size() - 1; i < loop.size(); before = i++) {
    if (is_piece[i] == is_piece[before]) continue;
    const uint32_t in = loop[before], out = loop[i];
    turns = is_piece[i] ? !go_straight(mesh, mesh.from(in), mesh.from(out), mesh.from(pieces.last_before(out)))
                        : !go_straight(mesh, mesh.to(out), mesh.from(out), mesh.to(pieces.first_after(in)));
    if (!turns) return false;
  }
  return turns;
}

}  // namespace isoshell::repair
