// Surfaces that are cut into patches, and seeds that are fixed on borders.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include "support/open_surfaces.h"

namespace isoshell {

/// A box cut along its edges into six patches of squares, two triangles each.
inline NamedMesh cut_box(std::array<int, 3> squares, int32_t step_q8) {
  NamedMesh mesh{"cut box", {}, {}, {}};
  constexpr int32_t kCorner = 10000;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      const auto begin = uint32_t(mesh.position.size());
      const auto n = size_t(squares[size_t(u)]), m = size_t(squares[size_t(v)]);
      for (size_t i = 0; i <= n; ++i)
        for (size_t j = 0; j <= m; ++j) {
          int32_t at[3];
          at[axis] = kCorner + side * squares[size_t(axis)] * step_q8;
          at[u] = kCorner + int32_t(i) * step_q8;
          at[v] = kCorner + int32_t(j) * step_q8;
          mesh.position.push_back({at[0], at[1], at[2]});
          mesh.patch.push_back(uint32_t(2 * axis + side));
        }
      const auto number = [&](size_t i, size_t j) { return begin + uint32_t(i * (m + 1) + j); };
      for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j < m; ++j) {
          const uint32_t a = number(i, j), b = number(i + 1, j), c = number(i + 1, j + 1), d = number(i, j + 1);
          mesh.triangles.push_back(side ? TriangleIndices{a, b, c} : TriangleIndices{a, c, b});
          mesh.triangles.push_back(side ? TriangleIndices{a, c, d} : TriangleIndices{a, d, c});
        }
    }
  return mesh;
}

/// Fixed seeds at the border vertices that `is_seed` is true of, at least one a loop; other border vertices belong to
/// the nearest of them along their loop, the one before where two are as near.
template <class IsSeed>
SeedSet fixed_on_borders(const SurfaceMesh& surface, IsSeed is_seed) {
  std::vector<uint32_t> home, of_vertex(size_t(surface.vertex_count()), kNone), joined;
  std::map<std::tuple<int32_t, int32_t, int32_t>, uint32_t> at_place;
  const Chains& chains = surface.chains;
  for (int64_t c = 0; c < chains.count(); ++c) {
    const int64_t begin = chains.first[c], size = chains.first[c + 1] - begin;
    const auto vertex = [&](int64_t i) { return chains.vertex[begin + (i + size) % size]; };
    std::vector<double> at{0};  // arclength
    std::vector<int64_t> seed_at;
    for (int64_t i = 0; i < size; ++i) {
      const PointQ8 p = surface.position[vertex(i)];
      at.push_back(at.back() + std::sqrt(double(distance_sq_q16(p, surface.position[vertex(i + 1)]))));
      if (is_seed(p)) seed_at.push_back(i);
    }
    for (int64_t i = 0; i < size; ++i) {
      double best = 1e300;
      for (size_t s = 0; s < seed_at.size(); ++s) {
        const double straight = std::abs(at[size_t(i)] - at[size_t(seed_at[s])]);
        const double along = std::min(straight, at.back() - straight);
        if (along < best) best = along, of_vertex[vertex(i)] = uint32_t(home.size() + s);
      }
    }
    for (const int64_t i : seed_at) {
      const PointQ8 p = surface.position[vertex(i)];
      joined.push_back(at_place.insert({{p.x, p.y, p.z}, uint32_t(home.size())}).first->second);
      home.push_back(vertex(i));
    }
  }
  SeedSet seeds;
  const auto count = int64_t(home.size());
  seeds.position = Buffer<PointQ8>(count);
  seeds.normal = Buffer<Normal8>(count);
  seeds.home = to_buffer(home);
  for (int64_t i = 0; i < count; ++i) {
    seeds.position[i] = surface.position[home[size_t(i)]];
    seeds.normal[i] = surface.normal[home[size_t(i)]];
  }
  seeds.fixed.count = count;
  seeds.fixed.of_vertex = to_buffer(of_vertex);
  seeds.fixed.joined = to_buffer(joined);
  return seeds;
}

/// The seeds, and free ones at vertices off the borders, spread by number.
inline SeedSet with_free_seeds(const SurfaceMesh& surface, SeedSet seeds, int64_t count) {
  std::vector<uint32_t> inside;
  for (int64_t v = 0; v < surface.vertex_count(); ++v)
    if (seeds.fixed.of_vertex[v] == kNone) inside.push_back(uint32_t(v));
  const int64_t fixed = seeds.size();
  SeedSet out;
  out.position = Buffer<PointQ8>(fixed + count);
  out.normal = Buffer<Normal8>(fixed + count);
  out.home = Buffer<uint32_t>(fixed + count);
  for (int64_t i = 0; i < fixed + count; ++i) {
    const uint32_t v = i < fixed ? seeds.home[i] : inside[size_t(i - fixed) * inside.size() / size_t(count)];
    out.position[i] = surface.position[v];
    out.normal[i] = surface.normal[v];
    out.home[i] = v;
  }
  out.fixed = std::move(seeds.fixed);
  return out;
}

}  // namespace isoshell
