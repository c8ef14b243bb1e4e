#include "attributes/seams.h"

#include <algorithm>
#include <sstream>

#include "attributes/welded_source.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

constexpr double kShortestSlit = 2;  // of an edge of the result
constexpr uint32_t kMostAtVertex = 6;

/// Directions and colours may vary from face to face; where a material ends, no triangle may lie on both sides, and
/// where an image or a chart ends, none that is asked not to.
bool makes_seams(const Attribute& a, UvSeams uv_seams) {
  if (a.domain == AttributeDomain::face && !a.labels.empty()) return true;
  if (uv_seams == UvSeams::ignore) return false;
  const AttributeMeaning* const meaning = meaning_of(a.name);
  const bool is_meant = meaning && meaning->domain == a.domain;
  if (a.domain == AttributeDomain::corner) return !is_meant || meaning->makes_seams;
  return a.domain == AttributeDomain::face && is_meant && meaning->makes_seams;
}

class SeamFinder {
 public:
  SeamFinder(const TriangleSoup& soup, double edge_length_world)
      : source_(weld_source(soup)), edge_length_world_(edge_length_world), jump_(source_.edges.count(), Jump::none) {
    for (const auto& t : source_.mesh.triangles)
      area_world_ +=
          triangle_area(source_.mesh.vertices[t[0]], source_.mesh.vertices[t[1]], source_.mesh.vertices[t[2]]);
  }

  void add(const Attribute& attribute) {
    const std::vector<Jump> jumps = find_jumps(source_, attribute);
    double seams_world = 0;
    for (uint32_t e = 0; e < jumps.size(); ++e)
      if (jumps[e] != Jump::none) seams_world += length_of(e);
    if (seams_world * edge_length_world_ > area_world_) {
      std::ostringstream reason;
      reason << "its seams are " << seams_world << " long, too close together for edges of " << edge_length_world_;
      found_.dropped.push_back({attribute.name, reason.str()});
      return;
    }
    for (size_t e = 0; e < jumps.size(); ++e) jump_[e] = std::max(jump_[e], jumps[e]);
  }

  Seams take() {
    std::vector<uint32_t> at_vertex(source_.mesh.vertices.size(), 0);
    for (uint32_t e = 0; e < jump_.size(); ++e)
      if (jump_[e] != Jump::none)
        for (const uint32_t v : source_.edges.edges[e].end) ++at_vertex[v];
    for (uint32_t e = 0; e < jump_.size(); ++e) {
      const auto& end = source_.edges.edges[e].end;
      const uint32_t fewest = std::min(at_vertex[end[0]], at_vertex[end[1]]);
      const uint32_t most = std::max(at_vertex[end[0]], at_vertex[end[1]]);
      const bool is_slit = fewest == 1 && length_of(e) < kShortestSlit * edge_length_world_;
      if (jump_[e] == Jump::none || (jump_[e] == Jump::at_one_end && (is_slit || most > kMostAtVertex))) continue;
      found_.edges.push_back({source_.mesh.vertices[end[0]], source_.mesh.vertices[end[1]]});
    }
    return std::move(found_);
  }

 private:
  double length_of(uint32_t edge) const {
    const auto& end = source_.edges.edges[edge].end;
    return length(source_.mesh.vertices[end[1]] - source_.mesh.vertices[end[0]]);
  }

  WeldedSource source_;
  double edge_length_world_, area_world_ = 0;
  std::vector<Jump> jump_;
  Seams found_;
};

}  // namespace

Seams find_seams(const TriangleSoup& soup, UvSeams uv_seams, double edge_length_world) {
  std::vector<const Attribute*> jumping;
  for (const Attribute& a : soup.attributes)
    if (makes_seams(a, uv_seams)) jumping.push_back(&a);
  if (jumping.empty()) return {};
  SeamFinder finder(soup, edge_length_world);
  for (const Attribute* a : jumping) finder.add(*a);
  return finder.take();
}

}  // namespace isoshell
