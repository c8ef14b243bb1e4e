// See side_places.h.
#include "features/walls/side_places.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "features/mesh/refine_mesh.h"
#include "voxel/random.h"

namespace isoshell {
namespace {

int32_t along(const PointQ8& p, int axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

WorldPoint position(const CutSurface& cut, const PlaceOnCurve& p) {
  const uint32_t place = cut.curves[p.curve].place[p.at];
  const PointQ8 at = cut.surface.position[cut.copies[size_t(cut.copies_first[place])]];
  return {double(at.x), double(at.y), double(at.z)};
}

uint64_t key(int64_t x, int64_t y, int64_t z) { return mix64(uint64_t(x) << 42 ^ uint64_t(y) << 21 ^ uint64_t(z)); }

}  // namespace

PeriodicSides::PeriodicSides(const CutSurface& cut) : of_patch_(patch_count(cut), 0) {
  const FaceRegions& regions = *cut.regions;
  for (size_t t = 0; t < cut.fine->triangles.size(); ++t) {
    const uint8_t side = regions.side[cut.fine->source_face[t]];
    if (!regions.is_periodic_side(side)) continue;
    const uint32_t corner = cut.corner[3 * t];
    of_patch_[cut.surface.patch[corner]] = side;
    plane_q8_[side] = along(cut.surface.position[corner], (side - 1) / 2);
  }
}

WorldPoint PeriodicSides::on_plane(int side, WorldPoint p) const {
  const int axis = (side - 1) / 2;
  (axis == 0 ? p.x : axis == 1 ? p.y : p.z) = *plane_q8_[size_t(side)];
  return p;
}

WorldPoint PeriodicSides::within(WorldPoint p) const {
  for (size_t axis = 0; axis < 3; ++axis) {
    double& at = axis == 0 ? p.x : axis == 1 ? p.y : p.z;
    const auto &low = plane_q8_[2 * axis + 1], &high = plane_q8_[2 * axis + 2];
    if (low && at < *low) at = *low + 1;
    if (high && at > *high) at = *high - 1;
  }
  return p;
}

WorldPoint PeriodicSides::inside(WorldPoint p, double way_q8) const {
  for (size_t axis = 0; axis < 3; ++axis) {
    double& at = axis == 0 ? p.x : axis == 1 ? p.y : p.z;
    const auto &low = plane_q8_[2 * axis + 1], &high = plane_q8_[2 * axis + 2];
    at = std::floor(at);
    const bool is_low = low && at == *low, is_high = high && at == *high;
    at += is_low ? std::ceil(way_q8) : is_high ? -std::ceil(way_q8) : 0;
  }
  return p;
}

bool PeriodicSides::hold(const std::array<WorldPoint, 3>& corners) const {
  for (int side = 1; side <= 6; ++side)
    if (has(side) &&
        std::all_of(corners.begin(), corners.end(), [&](const WorldPoint& p) { return p == on_plane(side, p); }))
      return true;
  return false;
}

WorldPoint PeriodicSides::period_q8(int axis) const {
  const double period = *plane_q8_[size_t(2 * axis + 2)] - *plane_q8_[size_t(2 * axis + 1)];
  return {axis == 0 ? period : 0, axis == 1 ? period : 0, axis == 2 ? period : 0};
}

PlacesOfSide::PlacesOfSide(const CutSurface& cut, const PeriodicSides& sides, int side)
    : cut_(cut), cell_q8_(std::max(cut.longest_edge_q8, 1.)) {
  for (uint32_t c = 0; c < cut.curves.size(); ++c) {
    const std::vector<uint32_t>& beside = cut.curves[c].patches;
    if (std::none_of(beside.begin(), beside.end(), [&](uint32_t p) { return sides.of_patch(p) == side; })) continue;
    for (size_t i = 0; i < cut.curves[c].place.size(); ++i) {
      const auto [x, y, z] = cell_of(position(cut, {c, i}));
      in_cell_[key(x, y, z)].push_back({c, i});
    }
  }
}

std::array<int64_t, 3> PlacesOfSide::cell_of(const WorldPoint& p) const {
  const auto on_axis = [&](double at) { return int64_t(std::floor(at / cell_q8_)) + (int64_t(1) << 20); };
  return {on_axis(p.x), on_axis(p.y), on_axis(p.z)};
}

std::optional<PlaceOnCurve> PlacesOfSide::nearest(const WorldPoint& to) const {
  const auto [x, y, z] = cell_of(to);
  std::optional<PlaceOnCurve> best;
  double least = cell_q8_ * cell_q8_ / 4;
  const auto offer = [&](const PlaceOnCurve& p) {
    const double d = distance_sq(position(cut_, p), to);
    const bool is_first = best && (p.curve != best->curve ? p.curve < best->curve : p.at < best->at);
    if (d < least || (d == least && is_first)) least = d, best = p;
  };
  for (int64_t i = 0; i < 27; ++i) {
    const auto cell = in_cell_.find(key(x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1));
    if (cell == in_cell_.end()) continue;
    for (const PlaceOnCurve& p : cell->second) offer(p);
  }
  return best;
}

}  // namespace isoshell
