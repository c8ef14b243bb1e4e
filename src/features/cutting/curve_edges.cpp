// See curve_edges.h.
#include "features/cutting/curve_edges.h"

#include <algorithm>

#include "geometry/half_edges.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {

CurveEdges curve_edges(const std::vector<CurvePath>& paths, const std::vector<uint32_t>& becomes) {
  CurveEdges edges;
  for (uint32_t c = 0; c < paths.size(); ++c) {
    std::vector<uint32_t> along;
    for (const uint32_t v : paths[c].vertex)
      if (becomes[v] != kNone && (along.empty() || along.back() != becomes[v])) along.push_back(becomes[v]);
    for (size_t i = 1; i < along.size(); ++i) edges.push_back({edge_key(along[i - 1], along[i]), c});
    if (paths[c].is_loop && along.size() > 1 && along.back() != along.front())
      edges.push_back({edge_key(along.back(), along.front()), c});
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

uint32_t curve_of(const CurveEdges& edges, uint32_t u, uint32_t v) {
  const uint64_t key = edge_key(u, v);
  const auto found = std::lower_bound(edges.begin(), edges.end(), std::make_pair(key, uint32_t(0)));
  return found != edges.end() && found->first == key ? found->second : kNone;
}

}  // namespace isoshell
