// lay_curves (see lay_curves.h).
#include "features/cutting/lay_curves.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/parallel_ranges.h"
#include "features/curves/face_normals.h"
#include "geometry/segment.h"
#include "geometry/triangle_grid.h"
#include "geometry/triangle_list.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

// In voxels: the sheet has a vertex about every voxel.
constexpr double kFarthest = 1.5;    ///< from the sheet, which cuts corners
constexpr double kNearest = .75;     ///< points of a curve, but for its ends
constexpr double kLongest = 2;       ///< from a point to the next
constexpr double kSameVertex = .25;  ///< what is nearer becomes one vertex

constexpr double kLeastDegrees = 20;  ///< that the sheet turns by at an edge of three faces that is a crease

/// Points along the curves of a network, and the segments between them.
struct SampledCurves {
  std::vector<WorldPoint> points;
  std::vector<std::array<uint32_t, 2>> segments;
  std::vector<uint32_t> curve;                            ///< per segment
  std::unordered_map<uint32_t, uint32_t> at_vertex = {};  ///< the point at a vertex where curves begin and end

  uint32_t add(const WorldPoint& p) {
    points.push_back(p);
    return uint32_t(points.size() - 1);
  }
  uint32_t at(const FeatureMesh& mesh, uint32_t vertex) {
    const auto [found, is_new] = at_vertex.emplace(vertex, uint32_t(points.size()));
    if (is_new) add(mesh.vertices[vertex]);
    return found->second;
  }
};

void sample(const FeatureMesh& mesh, const FeatureCurve& curve, uint32_t number, double voxel, SampledCurves& out) {
  const size_t edges = curve.vertex.size() - (curve.is_loop ? 0 : 1);
  const uint32_t end = curve.is_loop ? curve.vertex.front() : curve.vertex.back();
  uint32_t last = out.at(mesh, curve.vertex.front());
  const auto go_to = [&](uint32_t point) {
    out.segments.push_back({last, point});
    out.curve.push_back(number);
    last = point;
  };
  for (size_t i = 0; i < edges; ++i) {
    const WorldPoint &from = mesh.vertices[curve.vertex[i]],
                     &to = mesh.vertices[curve.vertex[(i + 1) % curve.vertex.size()]];
    const auto parts = int64_t(std::ceil(length(to - from) / (kLongest * voxel)));
    for (int64_t k = 1; k <= parts; ++k) {
      if (i + 1 == edges && k == parts) break;
      const WorldPoint p = from + double(k) / double(parts) * (to - from);
      if (length(p - out.points[last]) >= kNearest * voxel) go_to(out.add(p));
    }
  }
  go_to(out.at(mesh, end));
}

FeatureMesh mesh_of(const Sheet& sheet) {
  FeatureMesh mesh;
  for (const PointQ8& p : sheet.position) mesh.vertices.push_back(sheet.frame.to_world(p));
  mesh.triangles = list_of(sheet.triangles.view());
  mesh.source_face.assign(mesh.triangles.size(), 0);  // a sheet has no attributes
  return mesh;
}

/// The segments of which both ends and the middle are near to a mesh, and where their ends are on it.
struct NearSegments {
  LinesOnMesh lines;
  std::vector<uint32_t> point;  ///< per point of the lines that of the samples
  std::vector<size_t> segment;  ///< per segment likewise
};
NearSegments near_segments(const FeatureMesh& mesh, const SampledCurves& curves, double farthest) {
  const TriangleGrid grid(mesh.vertices, mesh.triangles);
  std::vector<MeshPoint> nearest(curves.points.size());
  for_each_index(size_t(0), nearest.size(), [&](size_t i) { nearest[i] = grid.nearest(curves.points[i]); });
  std::vector<uint8_t> is_near(curves.segments.size());
  const double limit = farthest * farthest;
  for_each_index(size_t(0), is_near.size(), [&](size_t s) {
    const auto [from, to] = curves.segments[s];
    is_near[s] = nearest[from].distance_sq <= limit && nearest[to].distance_sq <= limit &&
                 grid.distance_sq(.5 * (curves.points[from] + curves.points[to])) <= limit;
  });
  NearSegments near;
  std::vector<uint32_t> number(curves.points.size(), UINT32_MAX);
  for (size_t s = 0; s < is_near.size(); ++s) {
    if (!is_near[s]) continue;
    for (const uint32_t p : curves.segments[s]) {
      if (number[p] != UINT32_MAX) continue;
      number[p] = uint32_t(near.point.size());
      near.point.push_back(p);
      near.lines.points.push_back({nearest[p].triangle, grid.at(nearest[p])});
    }
    near.lines.segments.push_back({number[curves.segments[s][0]], number[curves.segments[s][1]]});
    near.segment.push_back(s);
  }
  return near;
}

/// Vertices on a segment's way go to the segment, those of its ends to the ends.
void move_to_curves(const SampledCurves& curves, const NearSegments& near, MeshWithLines& laid) {
  std::vector<WorldPoint>& vertices = laid.mesh.vertices;
  for (size_t s = 0; s < laid.ways.size(); ++s) {
    const auto [from, to] = curves.segments[near.segment[s]];
    for (const auto& edge : laid.ways[s])
      for (const uint32_t v : edge)
        vertices[v] = nearest_on_segment(vertices[v], curves.points[from], curves.points[to]);
  }
  std::vector<uint8_t> is_used(vertices.size(), 0);
  for (const auto& edge : laid.edges)
    for (const uint32_t v : edge) is_used[v] = 1;
  const auto move_point = [&](size_t i) {
    if (is_used[laid.vertex[i]]) vertices[laid.vertex[i]] = curves.points[near.point[i]];
  };
  for (size_t i = 0; i < near.point.size(); ++i) move_point(i);
  std::vector<uint8_t> is_end(curves.points.size(), 0);  // where several points are one vertex these are the ones
  for (const auto& [vertex, point] : curves.at_vertex) is_end[point] = 1;
  for (size_t i = 0; i < near.point.size(); ++i)
    if (is_end[near.point[i]]) move_point(i);
}

void sort_edges(EdgeList& edges) {
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
}

/// Tells which edges of a mesh turn as creases do, in the mean over their length.
class Turns {
 public:
  explicit Turns(const FeatureMesh& mesh)
      : mesh_(mesh), edges_(find_mesh_edges(mesh)), normals_(face_normals(mesh, edges_)) {}

  bool are_of_a_crease(const EdgeList& ends) const {
    double sum = 0, whole = 0;
    for (const auto& end : ends) {
      const auto at = std::lower_bound(edges_.edges.begin(), edges_.edges.end(), end,
                                       [](const FeatureEdge& e, const auto& key) { return e.end < key; });
      const double size = length(mesh_.vertices[end[1]] - mesh_.vertices[end[0]]);
      sum += size * turn_between(normals_[at->face[0]], normals_[at->face[1]]);
      whole += size;
    }
    return sum > turn_of_degrees(kLeastDegrees) * whole;
  }

 private:
  const FeatureMesh& mesh_;
  MeshEdges edges_;
  Buffer<WorldPoint> normals_;
};

}  // namespace

bool LaidCurves::take_back(uint32_t vertex) {
  if (mesh.vertices[vertex] == on_sheet[vertex]) return false;
  mesh.vertices[vertex] = on_sheet[vertex];
  is_back[vertex] = 1;
  return true;
}

std::vector<double> LaidCurves::lengths_world(size_t curves) const {
  std::vector<double> lengths(curves, 0);
  for (const LaidPiece& piece : pieces) {
    const auto is_off = [&](const std::array<uint32_t, 2>& edge) { return is_back[edge[0]] || is_back[edge[1]]; };
    if (std::none_of(piece.edges.begin(), piece.edges.end(), is_off)) lengths[piece.curve] += piece.length_world;
  }
  return lengths;
}

void LaidCurves::take_back_turned() {
  const auto normal_at = [](const std::vector<WorldPoint>& at, const std::array<uint32_t, 3>& t) {
    return doubled_area(at[t[0]], at[t[1]], at[t[2]]);
  };
  for (bool any = true; any;) {
    any = false;
    for (const auto& t : mesh.triangles)
      if (dot(normal_at(on_sheet, t), normal_at(mesh.vertices, t)) < 0)
        for (const uint32_t v : t) any |= take_back(v);
  }
}

LaidCurves lay_curves(const FeatureMesh& mesh, const CurveNetwork& network, const Sheet& sheet) {
  const double voxel = sheet.frame.voxel_size;
  SampledCurves curves;
  for (size_t c = 0; c < network.curves.size(); ++c)
    if (network.curves[c].kind != CurveKind::border) sample(mesh, network.curves[c], uint32_t(c), voxel, curves);
  FeatureMesh on = mesh_of(sheet);
  const NearSegments near = near_segments(on, curves, kFarthest * voxel);
  MeshWithLines embedded = embed_lines(std::move(on), near.lines, {}, kSameVertex * voxel);
  LaidCurves laid;
  laid.on_sheet = embedded.mesh.vertices;
  laid.is_back.assign(laid.on_sheet.size(), 0);
  move_to_curves(curves, near, embedded);
  laid.mesh = std::move(embedded.mesh);
  laid.take_back_turned();
  laid.mesh.rounding_world = voxel / (2 * kOneVoxelQ8);
  std::vector<EdgeList> edges_of(network.curves.size());
  for (size_t s = 0; s < near.segment.size(); ++s) {
    if (std::binary_search(embedded.lost_segments.begin(), embedded.lost_segments.end(), s)) continue;
    const auto [from, to] = curves.segments[near.segment[s]];
    const uint32_t curve = curves.curve[near.segment[s]];
    edges_of[curve].insert(edges_of[curve].end(), embedded.ways[s].begin(), embedded.ways[s].end());
    laid.pieces.push_back({curve, length(curves.points[to] - curves.points[from]), std::move(embedded.ways[s])});
  }
  const Turns turns(laid.mesh);
  for (size_t c = 0; c < edges_of.size(); ++c) {
    const CurveKind kind = network.curves[c].kind;
    if (kind == CurveKind::non_manifold && !turns.are_of_a_crease(edges_of[c])) continue;
    EdgeList& edges = kind == CurveKind::seam ? laid.seams : kind == CurveKind::line ? laid.lines : laid.creases;
    edges.insert(edges.end(), edges_of[c].begin(), edges_of[c].end());
  }
  for (EdgeList* edges : {&laid.creases, &laid.seams, &laid.lines}) sort_edges(*edges);
  return laid;
}

}  // namespace isoshell
