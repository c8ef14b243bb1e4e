#include "attributes/transfer_faces.h"

#include <algorithm>
#include <unordered_set>

#include "attributes/facing_point.h"
#include "core/attribute_values.h"
#include "core/buckets.h"
#include "core/number_type.h"
#include "core/parallel_ranges.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

constexpr size_t kGrain = 256;
constexpr double kSurroundings = 1.1;  ///< of the distance from a face's middle to its corners
constexpr double kInside = .02;  ///< of the way from a corner to the middle: there it is clear which side is meant
constexpr double kBeside = .05;  ///< of the same distance, around a corner

struct FaceShape {
  std::array<WorldPoint, 3> corner;
  WorldPoint middle, normal;  ///< the normal of any length

  double edge_length() const {
    return (length(corner[1] - corner[0]) + length(corner[2] - corner[1]) + length(corner[0] - corner[2])) / 3;
  }
  double reach() const {
    double farthest_sq = 0;
    for (const WorldPoint& c : corner) farthest_sq = std::max(farthest_sq, distance_sq(c, middle));
    return std::sqrt(farthest_sq);
  }
};

FaceShape shape_of(const TriangleMesh& mesh, size_t face) {
  const auto& t = mesh.triangles[face];
  const WorldPoint &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  return {{a, b, c}, (1. / 3) * (a + b + c), doubled_area(a, b, c)};
}

/// The part of the source around a point that continues from one triangle without a jump.
class Surroundings {
 public:
  Surroundings(const WeldedSource& source, const std::vector<Jump>& jumps) : source_(source), jumps_(jumps) {}

  /// Triangles that are up to `reach` farther from a point than the one to start with.
  void find(WorldPoint p, uint32_t start, double reach) {
    found_.assign(1, start);
    seen_ = {start};
    reach += std::sqrt(nearest(p, start).distance_sq);
    for (size_t i = 0; i < found_.size(); ++i)
      for (const uint32_t e : source_.edges.of_triangle[found_[i]]) {
        if (!source_.edges.is_inner(e) || jumps_[e] != Jump::none) continue;
        const uint32_t next = source_.edges.across(e, found_[i]);
        if (seen_.insert(next).second && nearest(p, next).distance_sq <= reach * reach) found_.push_back(next);
      }
  }

  /// Among the triangles that were found last, the smallest of those that are equally near.
  MeshPoint nearest_of_found(WorldPoint p) const {
    MeshPoint best;
    for (const uint32_t t : found_) {
      const MeshPoint here = nearest(p, t);
      if (here.distance_sq < best.distance_sq || (here.distance_sq == best.distance_sq && t < best.triangle))
        best = here;
    }
    return best;
  }

 private:
  MeshPoint nearest(WorldPoint p, uint32_t triangle) const {
    const auto& t = source_.mesh.triangles[triangle];
    const auto& v = source_.mesh.vertices;
    MeshPoint place = nearest_of_triangle(p, v[t[0]], v[t[1]], v[t[2]]);
    place.triangle = triangle;
    return place;
  }

  const WeldedSource& source_;
  const std::vector<Jump>& jumps_;
  std::vector<uint32_t> found_;
  std::unordered_set<uint32_t> seen_;
};

/// Corners of one vertex that have the same value share it. `values` are per corner; they end in the order of the
/// vertices, then of the corners that had them first.
void share_values(const TriangleMesh& mesh, Attribute& a) {
  const size_t corners = 3 * mesh.triangles.size(), size = size_t(a.components);
  const auto vertex_of = [&](size_t corner) { return mesh.triangles[corner / 3][corner % 3]; };
  const auto around = sort_into_buckets<uint32_t>(int64_t(mesh.vertices.size()), int64_t(corners),
                                                  [&](int64_t c, auto put) { put(vertex_of(size_t(c)), uint32_t(c)); });
  std::vector<double> shared;
  a.index.resize(corners);
  for (int64_t v = 0; v < around.count(); ++v) {
    const size_t begin = shared.size() / size;
    for (const uint32_t corner : around.in(v)) {
      const double* const value = &a.values[size * corner];
      size_t at = begin;
      while (at < shared.size() / size && !is_same(&shared[size * at], value, a.components)) ++at;
      if (at == shared.size() / size) shared.insert(shared.end(), value, value + size);
      a.index[corner] = uint32_t(at);
    }
  }
  a.values = std::move(shared);
}

}  // namespace

FaceTransfer::FaceTransfer(const WeldedSource& source, const TriangleMesh& mesh, Context& context)
    : source_(source), mesh_(mesh), context_(context), under_(mesh.triangles.size()) {
  const TriangleGrid grid(source.mesh.vertices, source.mesh.triangles);
  for_ranges(int64_t(under_.size()), kGrain, [&](int64_t begin, int64_t end) {
    if (context_.cancel.load(std::memory_order_relaxed)) return;
    for (size_t f = size_t(begin); f < size_t(end); ++f) {
      const FaceShape face = shape_of(mesh_, f);
      under_[f] = facing_point(grid, face.middle, face.normal, face.edge_length()).triangle;
    }
  });
}

Attribute FaceTransfer::of_faces(const Attribute& from) const {
  Attribute to{from.name, from.type, from.components, {}, AttributeDomain::face, {}, from.labels};
  to.values.reserve(under_.size() * size_t(from.components));
  for (const uint32_t triangle : under_) {
    const double* const value = value_of(from, source_.mesh.source_face[triangle]);
    to.values.insert(to.values.end(), value, value + from.components);
  }
  return to;
}

Attribute FaceTransfer::of_corners(const Attribute& from, const std::vector<Jump>& jumps) const {
  const size_t size = size_t(from.components);
  Attribute to{from.name, from.type, from.components, std::vector<double>(3 * under_.size() * size),
               AttributeDomain::corner};
  for_ranges(int64_t(under_.size()), kGrain, [&](int64_t begin, int64_t end) {
    Surroundings of_face(source_, jumps), of_corner(source_, jumps);
    for (size_t f = size_t(begin); f < size_t(end); ++f) {
      if (context_.cancel.load(std::memory_order_relaxed)) return;
      const FaceShape face = shape_of(mesh_, f);
      const double reach = face.reach();
      of_face.find(face.middle, under_[f], kSurroundings * reach);
      for (size_t i = 0; i < 3; ++i) {
        const WorldPoint p = face.corner[i];
        // Both sides of a seam that ends near by belong together, and are equally near: the corner stays on its own.
        const uint32_t side = of_face.nearest_of_found(p + kInside * (face.middle - p)).triangle;
        of_corner.find(p, side, kBeside * reach);
        const MeshPoint place = of_corner.nearest_of_found(p);
        const double* value[3];
        for (uint32_t c = 0; c < 3; ++c) value[c] = value_of(from, source_.corner(place.triangle, c));
        for (size_t k = 0; k < size; ++k)
          to.values[(3 * f + i) * size + k] =
              nearest_of(from.type, interpolate(place, value[0][k], value[1][k], value[2][k]));
      }
    }
  });
  share_values(mesh_, to);
  return to;
}

}  // namespace isoshell
