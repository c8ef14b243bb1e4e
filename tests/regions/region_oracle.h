// What makes regions of a mesh valid, looked at edge by edge.
#pragma once

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// What is wrong with the boundaries of regions: each has two faces at each edge, which pass it in opposite directions,
/// and no face is there twice. Empty where all is right.
inline std::string fault_of_regions(const std::vector<std::array<uint32_t, 3>>& triangles, const FaceRegions& regions) {
  std::map<std::array<int64_t, 3>, int> passes;  // label, from, to
  std::set<std::array<uint32_t, 3>> seen;
  std::ostringstream fault;
  for (size_t t = 0; t < triangles.size(); ++t) {
    const auto& [inside, outside] = regions.labels[t];
    if (inside == outside || inside == regions.background) fault << "face " << t << " parts nothing; ";
    if (outside != regions.background && outside < inside) fault << "face " << t << " looks the wrong way; ";
    std::array<uint32_t, 3> corners = triangles[t];
    std::sort(corners.begin(), corners.end());
    if (!seen.insert(corners).second) fault << "face " << t << " is there twice; ";
    for (size_t i = 0; i < 3; ++i) {
      const int64_t a = triangles[t][i], b = triangles[t][(i + 1) % 3];
      if (a == b) fault << "face " << t << " has a corner twice; ";
      ++passes[{inside, a, b}];
      if (outside != regions.background) ++passes[{outside, b, a}];
    }
  }
  for (const auto& [pass, count] : passes) {
    const auto back = passes.find({pass[0], pass[2], pass[1]});
    if (count == 1 && back != passes.end() && back->second == 1) continue;
    fault << "region " << pass[0] << " is passed " << count << " times from " << pass[1] << " to " << pass[2] << "; ";
    if (fault.tellp() > 400) break;
  }
  return fault.str();
}

/// Per region the volume inside.
inline std::map<int32_t, double> volumes_of_regions(const std::vector<WorldPoint>& vertices,
                                                    const std::vector<std::array<uint32_t, 3>>& triangles,
                                                    const FaceRegions& regions) {
  std::map<int32_t, double> volume;
  for (size_t t = 0; t < triangles.size(); ++t) {
    const WorldPoint &a = vertices[triangles[t][0]], &b = vertices[triangles[t][1]], &c = vertices[triangles[t][2]];
    const double v =
        (a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x)) / 6;
    volume[regions.labels[t][0]] += v;
    volume[regions.labels[t][1]] -= v;
  }
  volume.erase(regions.background);
  return volume;
}

/// Pairs of regions that have a wall, each with the smaller label first.
inline std::set<std::array<int32_t, 2>> pairs_of(const FaceRegions& regions) {
  std::set<std::array<int32_t, 2>> pairs;
  for (const auto& [a, b] : regions.labels) pairs.insert({std::min(a, b), std::max(a, b)});
  return pairs;
}

/// The same of voxels that share a face, with the background around the array.
inline std::set<std::array<int32_t, 2>> pairs_of(const LabelVolume& volume) {
  const int nx = volume.size_vox[0], ny = volume.size_vox[1], nz = volume.size_vox[2];
  const auto at = [&](int x, int y, int z) {
    if (x < 0 || y < 0 || z < 0 || x >= nx || y >= ny || z >= nz) return volume.background;
    return volume.labels[(size_t(z) * size_t(ny) + size_t(y)) * size_t(nx) + size_t(x)];
  };
  std::set<std::array<int32_t, 2>> pairs;
  for (int z = 0; z <= nz; ++z)
    for (int y = 0; y <= ny; ++y)
      for (int x = 0; x <= nx; ++x)
        for (const int32_t other : {at(x - 1, y, z), at(x, y - 1, z), at(x, y, z - 1)})
          if (const int32_t own = at(x, y, z); own != other) pairs.insert({std::min(own, other), std::max(own, other)});
  return pairs;
}

}  // namespace isoshell
