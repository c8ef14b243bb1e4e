// embed_lines (see embed_lines.h).
#include "features/mesh/embed_lines.h"

#include <algorithm>
#include <limits>
#include <unordered_map>

#include "geometry/half_edges.h"
#include "geometry/segment.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

constexpr double kLongestWay = 3;  // of a segment

/// A mesh whose edges and triangles are split one at a time.
class EmbeddingMesh {
 public:
  explicit EmbeddingMesh(FeatureMesh mesh) : mesh_(std::move(mesh)), first_corner_(mesh_.vertices.size(), kNone) {
    next_corner_.resize(3 * mesh_.triangles.size());
    for (uint32_t c = uint32_t(next_corner_.size()); c-- > 0;) link(c);
    for (uint32_t t = 0; t < mesh_.triangles.size(); ++t) root_.push_back(t);
  }

  const WorldPoint& at(uint32_t v) const { return mesh_.vertices[v]; }
  const std::array<uint32_t, 3>& triangle(uint32_t t) const { return mesh_.triangles[t]; }

  /// The triangles that one of the first mesh became.
  std::vector<uint32_t> parts_of(uint32_t root) const {
    const auto found = parts_.find(root);
    return found == parts_.end() ? std::vector<uint32_t>{root} : found->second;
  }

  /// visit(triangle, corner of it that is v).
  template <class Visit>
  void for_each_around(uint32_t v, Visit visit) const {
    for (uint32_t c = first_corner_[v]; c != kNone; c = next_corner_[c]) visit(c / 3, c % 3);
  }

  /// A vertex on the edge from u to v.
  uint32_t split_edge(uint32_t u, uint32_t v, const WorldPoint& at) {
    const uint32_t middle = add_vertex(at);
    split_at_[edge_key(u, v)] = middle;
    std::vector<std::array<uint32_t, 2>> beside;  // triangle, and its corner that the edge begins at
    for_each_around(u, [&](uint32_t t, uint32_t i) {
      if (triangle(t)[(i + 1) % 3] == v) beside.push_back({t, i});
      if (triangle(t)[(i + 2) % 3] == v) beside.push_back({t, (i + 2) % 3});
    });
    for (const auto& [t, i] : beside) {
      const uint32_t end = triangle(t)[(i + 1) % 3], apex = triangle(t)[(i + 2) % 3];
      move_corner(t, (i + 1) % 3, middle);
      add_triangle(t, {middle, end, apex});
    }
    return middle;
  }

  uint32_t split_triangle(uint32_t t, const WorldPoint& at) {
    const uint32_t middle = add_vertex(at);
    const auto [a, b, c] = triangle(t);
    move_corner(t, 2, middle);
    add_triangle(t, {b, c, middle});
    add_triangle(t, {c, a, middle});
    return middle;
  }

  /// Of every edge the parts that it was split into, the smaller end first, ascending.
  EdgeList parts_of(EdgeList edges) const {
    EdgeList whole;
    while (!edges.empty()) {
      const auto [u, v] = edges.back();
      edges.pop_back();
      const auto split = split_at_.find(edge_key(u, v));
      if (split == split_at_.end())
        whole.push_back({std::min(u, v), std::max(u, v)});
      else
        edges.insert(edges.end(), {{u, split->second}, {split->second, v}});
    }
    std::sort(whole.begin(), whole.end());
    whole.erase(std::unique(whole.begin(), whole.end()), whole.end());
    return whole;
  }

  FeatureMesh take() { return std::move(mesh_); }

 private:
  void link(uint32_t corner) {
    uint32_t& first = first_corner_[mesh_.triangles[corner / 3][corner % 3]];
    next_corner_[corner] = first;
    first = corner;
  }
  void unlink(uint32_t corner) {
    uint32_t* to = &first_corner_[mesh_.triangles[corner / 3][corner % 3]];
    while (*to != corner) to = &next_corner_[*to];
    *to = next_corner_[corner];
  }
  void move_corner(uint32_t t, uint32_t i, uint32_t vertex) {
    unlink(3 * t + i);
    mesh_.triangles[t][i] = vertex;
    link(3 * t + i);
  }
  uint32_t add_vertex(const WorldPoint& at) {
    mesh_.vertices.push_back(at);
    first_corner_.push_back(kNone);
    return uint32_t(mesh_.vertices.size() - 1);
  }
  /// A part of what `of` is a part of.
  void add_triangle(uint32_t of, const std::array<uint32_t, 3>& corners) {
    const auto added = uint32_t(mesh_.triangles.size());
    mesh_.triangles.push_back(corners);
    mesh_.source_face.push_back(uint32_t(mesh_.source_face[of]));
    root_.push_back(uint32_t(root_[of]));
    parts_.emplace(root_[of], std::vector<uint32_t>{root_[of]}).first->second.push_back(added);
    next_corner_.resize(next_corner_.size() + 3);
    for (uint32_t i = 0; i < 3; ++i) link(3 * added + i);
  }

  FeatureMesh mesh_;
  std::vector<uint32_t> first_corner_, next_corner_;  ///< per vertex the list of the corners that it is
  std::vector<uint32_t> root_;                        ///< per triangle that of the first mesh
  std::unordered_map<uint32_t, std::vector<uint32_t>> parts_;
  std::unordered_map<uint64_t, uint32_t> split_at_;
};

class LineEmbedder {
 public:
  LineEmbedder(FeatureMesh mesh, double tolerance_world) : mesh_(std::move(mesh)), tolerance_(tolerance_world) {}

  uint32_t vertex_at(const PointOnMesh& point) {
    const std::vector<uint32_t> parts = mesh_.parts_of(point.triangle);
    double least = tolerance_;
    uint32_t found = kNone;
    for (const uint32_t t : parts)
      for (const uint32_t v : mesh_.triangle(t))
        if (const double far = length(point.at - mesh_.at(v)); far <= least) least = far, found = v;
    if (found != kNone) return found;

    std::array<uint32_t, 2> edge{};
    WorldPoint foot{};
    least = tolerance_;
    for (const uint32_t t : parts)
      for (size_t i = 0; i < 3; ++i) {
        const uint32_t u = mesh_.triangle(t)[i], v = mesh_.triangle(t)[(i + 1) % 3];
        const WorldPoint here = nearest_on_segment(point.at, mesh_.at(u), mesh_.at(v));
        if (const double far = length(point.at - here); far < least) least = far, edge = {u, v}, foot = here;
      }
    if (least < tolerance_) return mesh_.split_edge(edge[0], edge[1], foot);
    return mesh_.split_triangle(part_around(parts, point.at), point.at);
  }

  /// The edges of a way from one vertex to another; none where there is none.
  EdgeList way(uint32_t from, uint32_t to) {
    const WorldPoint along = mesh_.at(to) - mesh_.at(from);
    const WorldPoint up = normal_at(from) + normal_at(to);
    const Plane plane{mesh_.at(from), normalised(cross(along, up)), along};
    EdgeList edges;
    std::vector<uint32_t> visited{from};
    double walked = 0;
    while (visited.back() != to) {
      const uint32_t here = visited.back(), next = step(visited, to, plane);
      if (next == kNone) return {};
      walked += length(mesh_.at(next) - mesh_.at(here));
      if (walked > kLongestWay * length(along) + 2 * tolerance_) return {};
      edges.push_back({here, next});
      visited.push_back(next);
    }
    return edges;
  }

  EmbeddingMesh& mesh() { return mesh_; }

 private:
  struct Plane {
    WorldPoint origin, normal, along;
    double height(const WorldPoint& p) const { return dot(normal, p - origin); }
  };
  /// Where a way may go on: at a vertex, or on an edge.
  struct Candidate {
    uint32_t u = kNone, v = kNone;  ///< the ends of the edge; of a vertex both are it
    WorldPoint at{};
    double ahead = -std::numeric_limits<double>::infinity();  ///< cosine times the length of the segment
  };

  WorldPoint normal_at(uint32_t v) const {
    WorldPoint sum{0, 0, 0};
    mesh_.for_each_around(v, [&](uint32_t t, uint32_t) {
      const auto& [a, b, c] = mesh_.triangle(t);
      sum = sum + doubled_area(mesh_.at(a), mesh_.at(b), mesh_.at(c));
    });
    return normalised(sum);
  }

  /// The one that a point in their common plane is farthest inside of.
  uint32_t part_around(const std::vector<uint32_t>& parts, const WorldPoint& p) const {
    uint32_t best = parts.front();
    double deepest = -std::numeric_limits<double>::infinity();
    for (const uint32_t t : parts) {
      const auto& corner = mesh_.triangle(t);
      const WorldPoint normal = normalised(doubled_area(mesh_.at(corner[0]), mesh_.at(corner[1]), mesh_.at(corner[2])));
      double depth = std::numeric_limits<double>::infinity();
      for (size_t i = 0; i < 3; ++i) {
        const WorldPoint &a = mesh_.at(corner[i]), &b = mesh_.at(corner[(i + 1) % 3]);
        depth = std::min(depth, dot(cross(normalised(b - a), p - a), normal));
      }
      if (depth > deepest) deepest = depth, best = t;
    }
    return best;
  }

  /// The vertex that comes next, which may be made. kNone: there is none that was not visited.
  uint32_t step(const std::vector<uint32_t>& visited, uint32_t to, const Plane& plane) {
    const uint32_t here = visited.back();
    bool is_there = false;
    Candidate best;
    const auto consider = [&](uint32_t u, uint32_t v, const WorldPoint& at) {
      if (u == v && std::find(visited.rbegin(), visited.rend(), u) != visited.rend()) return;
      const double ahead = dot(normalised(at - mesh_.at(here)), plane.along);
      if (ahead > best.ahead) best = {u, v, at, ahead};
    };
    mesh_.for_each_around(here, [&](uint32_t t, uint32_t i) {
      const uint32_t a = mesh_.triangle(t)[(i + 1) % 3], b = mesh_.triangle(t)[(i + 2) % 3];
      is_there = is_there || a == to || b == to;
      const double of_a = plane.height(mesh_.at(a)), of_b = plane.height(mesh_.at(b));
      if (std::abs(of_a) <= tolerance_) consider(a, a, mesh_.at(a));
      if (std::abs(of_b) <= tolerance_) consider(b, b, mesh_.at(b));
      if (std::abs(of_a) <= tolerance_ || std::abs(of_b) <= tolerance_ || (of_a < 0) == (of_b < 0)) return;
      const WorldPoint at = mesh_.at(a) + of_a / (of_a - of_b) * (mesh_.at(b) - mesh_.at(a));
      const bool is_a = length(at - mesh_.at(a)) <= tolerance_, is_b = length(at - mesh_.at(b)) <= tolerance_;
      consider(is_b && !is_a ? b : a, is_a ? a : b, is_a ? mesh_.at(a) : is_b ? mesh_.at(b) : at);
    });
    if (is_there) return to;
    return best.u == best.v ? best.u : mesh_.split_edge(best.u, best.v, best.at);
  }

  EmbeddingMesh mesh_;
  double tolerance_;
};

}  // namespace

MeshWithLines embed_lines(FeatureMesh mesh, const LinesOnMesh& lines, const std::vector<EdgeList>& followed,
                          double tolerance_world) {
  LineEmbedder embedder(std::move(mesh), tolerance_world);
  MeshWithLines out;
  for (const PointOnMesh& p : lines.points) out.vertex.push_back(embedder.vertex_at(p));
  out.ways.resize(lines.segments.size());
  for (size_t s = 0; s < lines.segments.size(); ++s) {
    const uint32_t from = out.vertex[lines.segments[s][0]], to = out.vertex[lines.segments[s][1]];
    if (from == to) continue;
    out.ways[s] = embedder.way(from, to);
    if (out.ways[s].empty()) out.lost_segments.push_back(s);
    out.edges.insert(out.edges.end(), out.ways[s].begin(), out.ways[s].end());
  }
  out.edges = embedder.mesh().parts_of(std::move(out.edges));
  for (EdgeList& way : out.ways) way = embedder.mesh().parts_of(std::move(way));
  for (const EdgeList& edges : followed) out.followed.push_back(embedder.mesh().parts_of(edges));
  out.mesh = embedder.mesh().take();
  return out;
}

}  // namespace isoshell
