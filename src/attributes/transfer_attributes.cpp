// Attributes of one surface for another: those of vertices by each vertex's nearest point, among triangles that look
// its way if one is about as near; those of corners and faces by the middle of each face.
#include "isoshell/advanced/transfer_attributes.h"

#include <algorithm>
#include <deque>
#include <optional>

#include "attributes/facing_point.h"
#include "attributes/transfer_faces.h"
#include "core/attribute_values.h"
#include "core/number_type.h"
#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "geometry/triangle_list.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

constexpr const char* kStage = "attributes";
constexpr int64_t kGrain = 256;

void require_finite(const std::vector<WorldPoint>& vertices, size_t v, const char* whose) {
  if (!is_finite(vertices[v]))
    throw Error(ErrorCode::usage, kStage,
                "vertex " + std::to_string(v) + " of " + whose + " is not finite; leave out the faces that have it");
}

void check(const TriangleSoup& source, const std::vector<Attribute>& attributes, const TriangleMesh& mesh) {
  if (source.triangles.empty()) throw Error(ErrorCode::usage, kStage, "the source has no triangle to take values from");
  for (const Attribute& a : attributes)
    if (const std::string misfit = misfit_of(a, source.vertices.size(), source.triangles.size()); !misfit.empty())
      throw Error(ErrorCode::usage, kStage, misfit);
  require_indices(source.triangles, source.vertices.size(), kStage);
  require_indices(mesh.triangles, mesh.vertices.size(), kStage);
  for (const auto& t : source.triangles)  // others are looked at by nobody
    for (const uint32_t v : t) require_finite(source.vertices, v, "the source");
  for (size_t v = 0; v < mesh.vertices.size(); ++v) require_finite(mesh.vertices, v, "the mesh");
}

/// What of its triangles a vertex must know.
struct Surroundings {
  WorldPoint normal{0, 0, 0};  ///< by area, of any length
  double edges = 0;            ///< sum of lengths, each as often as triangles of the vertex have it
  int32_t count = 0;           ///< of those edges

  double edge_length() const { return count > 0 ? edges / count : 0; }
};

/// In the order of the triangles, so sums do not depend on threads.
std::vector<Surroundings> surroundings_of(const TriangleMesh& mesh) {
  std::vector<Surroundings> at(mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    const WorldPoint &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const WorldPoint normal = doubled_area(a, b, c);
    const double ab = length(b - a), bc = length(c - b), ca = length(a - c);
    const double edges[3] = {ca + ab, ab + bc, bc + ca};
    for (size_t corner = 0; corner < 3; ++corner) {
      Surroundings& s = at[t[corner]];
      s.normal = s.normal + normal;
      s.edges += edges[corner];
      s.count += 2;
    }
  }
  return at;
}

/// Of vertices, or of corners whose values do not jump: what a vertex of the mesh has.
void interpolate(const Attribute& from, const TriangleSoup& source, const MeshPoint& place, double* to) {
  const double* value[3];
  for (size_t i = 0; i < 3; ++i)
    value[i] = value_of(from, from.domain == AttributeDomain::corner ? 3 * size_t(place.triangle) + i
                                                                     : source.triangles[place.triangle][i]);
  for (int32_t k = 0; k < from.components; ++k)
    to[k] = nearest_of(from.type, interpolate(place, value[0][k], value[1][k], value[2][k]));
}

/// Values at the vertices of the mesh, into `to` by its places.
void transfer_to_vertices(const TriangleSoup& source, const std::vector<const Attribute*>& from,
                          const TriangleMesh& mesh, Context& context, const std::vector<Attribute*>& to) {
  if (from.empty()) return;
  const size_t count = mesh.vertices.size();
  for (size_t a = 0; a < from.size(); ++a) to[a]->values.resize(count * size_t(from[a]->components));
  const TriangleGrid grid(source.vertices, source.triangles);
  const std::vector<Surroundings> surroundings = surroundings_of(mesh);
  for_ranges(int64_t(count), kGrain, [&](int64_t begin, int64_t end) {
    if (context.cancel.load(std::memory_order_relaxed)) return;
    for (size_t v = size_t(begin); v < size_t(end); ++v) {
      const MeshPoint place =
          facing_point(grid, mesh.vertices[v], surroundings[v].normal, surroundings[v].edge_length());
      for (size_t a = 0; a < from.size(); ++a)
        interpolate(*from[a], source, place, &to[a]->values[v * size_t(from[a]->components)]);
    }
  });
}

bool is_direction(const Attribute& a) {
  const AttributeMeaning* const meaning = meaning_of(a.name);
  return meaning && meaning->is_direction && means(a, meaning->name);
}

void make_units(Attribute& directions) {
  const auto components = size_t(directions.components);
  for (size_t i = 0; i + components <= directions.values.size(); i += components) {
    double* const d = &directions.values[i];
    const double size = length({d[0], d[1], d[2]});
    for (int k = 0; size > 0 && k < 3; ++k) d[k] = nearest_of(directions.type, d[k] / size);
  }
}

bool has_jumps(const std::vector<Jump>& jumps) {
  return std::any_of(jumps.begin(), jumps.end(), [](Jump j) { return j != Jump::none; });
}

/// The corners of every vertex share its value.
std::vector<uint32_t> corners_of(const TriangleMesh& mesh) {
  std::vector<uint32_t> index;
  index.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles) index.insert(index.end(), t.begin(), t.end());
  return index;
}

class Transfer {
 public:
  Transfer(const TriangleSoup& source, const TriangleMesh& mesh, Context& context)
      : source_(source), mesh_(mesh), context_(context) {}

  std::vector<Attribute> of(const std::vector<Attribute>& attributes) {
    std::vector<Attribute> result(attributes.size());
    for (size_t i = 0; i < attributes.size(); ++i) transfer(attributes[i], result[i]);
    transfer_to_vertices(source_, smooth_from_, mesh_, context_, smooth_to_);
    for (Attribute& a : result)
      if (is_direction(a)) make_units(a);
    return result;
  }

 private:
  void transfer(const Attribute& given, Attribute& to) {
    if (given.domain == AttributeDomain::face) {
      to = faces().of_faces(given);
      return;
    }
    const Attribute& from = is_direction(given) ? units_.emplace_back(given) : given;
    if (is_direction(given)) make_units(units_.back());
    if (from.domain == AttributeDomain::corner) {
      const std::vector<Jump> jumps = find_jumps(welded(), from);
      if (has_jumps(jumps)) {
        to = faces().of_corners(from, jumps);
        return;
      }
    }
    to = {from.name, from.type, from.components, {}, from.domain};
    if (from.domain == AttributeDomain::corner) to.index = corners_of(mesh_);
    smooth_from_.push_back(&from);
    smooth_to_.push_back(&to);
  }

  const WeldedSource& welded() {
    if (!welded_) welded_ = weld_source(source_);
    if (welded_->mesh.triangles.empty())
      throw Error(ErrorCode::usage, kStage, "the source has no triangle with three corners apart to take values from");
    return *welded_;
  }
  const FaceTransfer& faces() {
    if (!faces_) faces_.emplace(welded(), mesh_, context_);
    return *faces_;
  }

  const TriangleSoup& source_;
  const TriangleMesh& mesh_;
  Context& context_;
  std::optional<WeldedSource> welded_;
  std::optional<FaceTransfer> faces_;
  std::deque<Attribute> units_;                ///< directions of the source, of length 1
  std::vector<const Attribute*> smooth_from_;  ///< found by vertices: those of vertices, and those without a jump
  std::vector<Attribute*> smooth_to_;
};

}  // namespace

std::vector<Attribute> transfer_attributes(const TriangleSoup& source, const std::vector<Attribute>& attributes,
                                           const TriangleMesh& mesh, Context& context) {
  if (attributes.empty()) return {};
  check(source, attributes, mesh);
  std::vector<Attribute> result =
      run_with_threads(context, [&] { return Transfer(source, mesh, context).of(attributes); });
  check_cancel(context, kStage);
  return result;
}

}  // namespace isoshell
