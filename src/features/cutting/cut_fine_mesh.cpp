// cut_fine_mesh (see cut_fine_mesh.h).
#include "features/cutting/cut_fine_mesh.h"

#include <algorithm>
#include <cmath>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "isoshell/advanced/stages.h"

namespace isoshell {
namespace {

MeshFans fans_between_paths(const FineMesh& mesh, MeshTwins twins) {
  const auto vertices = int64_t(mesh.position.size());
  const std::vector<uint64_t> cut_edges = path_edges(mesh.paths);
  return twins.of.empty() ? find_fans(mesh.triangles, vertices, cut_edges)
                          : find_fans(mesh.triangles, vertices, cut_edges, std::move(twins));
}

/// Every fan becomes a vertex.
SurfaceTriangles cut_triangles(const FineMesh& mesh, const MeshFans& fans, const LatticeFrame& frame) {
  SurfaceTriangles out;
  std::copy(frame.extent_vox, frame.extent_vox + 3, out.extent_vox);
  out.position.resize(fans.vertex.size());
  out.patch.resize(fans.vertex.size());
  out.triangles.resize(mesh.triangles.size());
  for_each_index(size_t(0), fans.vertex.size(),
                 [&](size_t f) { out.position[f] = rounded(mesh.position[fans.vertex[f]]); });
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (size_t i = 0; i < 3; ++i) out.patch[fans.of_corner[3 * t + i]] = fans.patch[t];
  for_each_index(size_t(0), mesh.triangles.size(), [&](size_t t) {
    const uint32_t* fan = &fans.of_corner[3 * t];
    out.triangles[t] = {fan[0], fan[1], fan[2]};
  });
  return out;
}

/// Numbers the points of the paths. Result: per fine vertex its place, or kNone.
std::vector<uint32_t> number_places(const FineMesh& mesh, CutSurface& cut) {
  std::vector<uint32_t> place(mesh.position.size(), kNone), corners;
  for (const CurvePath& path : mesh.paths)
    if (!path.is_loop) corners.insert(corners.end(), {path.vertex.front(), path.vertex.back()});
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  uint32_t count = 0;
  for (const uint32_t v : corners) place[v] = count++;
  cut.corner_count = count;
  for (const CurvePath& path : mesh.paths) {
    CutCurve curve{path.curve, path.kind, path.is_loop, {}, path.at, path.length, path.least_segments, {}, {}};
    for (const PathPoint& seed : path.seeds) curve.seeds.push_back(seed.edge);
    for (const uint32_t v : path.vertex) {
      if (place[v] == kNone) place[v] = count++;
      curve.place.push_back(place[v]);
    }
    cut.curves.push_back(std::move(curve));
  }
  return place;
}

/// Which border vertices are at a place.
void find_places(const MeshFans& fans, const std::vector<uint32_t>& place_of_fine, const std::vector<uint32_t>& number,
                 CutSurface& cut) {
  const SurfaceMesh& surface = cut.surface;
  cut.place.assign(size_t(surface.vertex_count()), kNone);
  if (surface.is_closed()) {
    cut.copies_first = {0};
    return;
  }
  uint32_t places = 0;
  for (const CutCurve& curve : cut.curves)
    for (const uint32_t p : curve.place) places = std::max(places, p + 1);
  for (size_t f = 0; f < number.size(); ++f)
    if (surface.border_before[number[f]] != kNone) cut.place[number[f]] = place_of_fine[fans.vertex[f]];
  list_copies(places, cut);
}

/// Gives the surface the lengths, where they vary.
void set_lengths(const FineMesh& mesh, const MeshFans& fans, const std::vector<uint32_t>& number,
                 SurfaceMesh& surface) {
  const auto [least, largest] = std::minmax_element(mesh.edge_length.begin(), mesh.edge_length.end());
  if (*least == *largest) return;
  EdgeLengths& lengths = surface.lengths;
  lengths.at = Buffer<uint32_t>(surface.vertex_count());
  const auto whole = [](double l) { return uint32_t(std::max(1.0, std::floor(l + 0.5))); };
  for (size_t f = 0; f < number.size(); ++f) lengths.at[number[f]] = whole(mesh.edge_length[fans.vertex[f]]);
  lengths.least = whole(*least);
  lengths.largest = whole(*largest);
}

/// Which patches are beside each curve.
void list_patches_beside(const FineMesh& mesh, const MeshFans& fans, std::vector<CutCurve>& curves) {
  std::vector<std::pair<uint64_t, uint32_t>> first_edge;  // all edges of a curve have the same patches beside them
  for (uint32_t c = 0; c < mesh.paths.size(); ++c)
    first_edge.push_back({edge_key(mesh.paths[c].vertex[0], mesh.paths[c].edge_end(0)), c});
  std::sort(first_edge.begin(), first_edge.end());
  for (const uint32_t h : fans.cut) {
    const uint32_t next = next_in_triangle(h);
    const uint64_t edge = edge_key(mesh.triangles[h / 3][h % 3], mesh.triangles[next / 3][next % 3]);
    const auto at = std::lower_bound(first_edge.begin(), first_edge.end(), std::make_pair(edge, uint32_t(0)));
    if (at != first_edge.end() && at->first == edge) curves[at->second].patches.push_back(fans.patch[h / 3]);
  }
  for (CutCurve& curve : curves) {
    std::sort(curve.patches.begin(), curve.patches.end());
    curve.patches.erase(std::unique(curve.patches.begin(), curve.patches.end()), curve.patches.end());
  }
}

}  // namespace

void list_copies(size_t places, CutSurface& cut) {
  cut.copies_first.assign(places + 1, 0);
  for (const uint32_t p : cut.place)
    if (p != kNone) ++cut.copies_first[p + 1];
  for (size_t p = 0; p < places; ++p) cut.copies_first[p + 1] += cut.copies_first[p];
  std::vector<int64_t> next(cut.copies_first.begin(), cut.copies_first.end());
  cut.copies.resize(size_t(cut.copies_first.back()));
  for (size_t v = 0; v < cut.place.size(); ++v)
    if (cut.place[v] != kNone) cut.copies[size_t(next[cut.place[v]]++)] = uint32_t(v);
}

CutSurface cut_fine_mesh(std::shared_ptr<const FineMesh> fine, const LatticeFrame& frame, Context& context,
                         MeshTwins twins) {
  return run_with_threads(context, [&] {
    const MeshFans fans = fans_between_paths(*fine, std::move(twins));
    check_cancel(context, "features");
    CutSurface cut;
    cut.frame = frame;
    MadeSurface made = make_surface_mesh(cut_triangles(*fine, fans, frame), context);
    cut.longest_edge_q8 = *std::max_element(fine->edge_length.begin(), fine->edge_length.end());
    cut.surface = std::move(made.surface);
    set_lengths(*fine, fans, made.number, cut.surface);
    find_places(fans, number_places(*fine, cut), made.number, cut);
    list_patches_beside(*fine, fans, cut.curves);
    cut.corner.resize(fans.of_corner.size());
    for_each_index(size_t(0), cut.corner.size(), [&](size_t c) { cut.corner[c] = made.number[fans.of_corner[c]]; });
    cut.fine = std::move(fine);
    return cut;
  });
}

}  // namespace isoshell
