#include "isoshell/boolean_union.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "core/watched.h"
#include "geometry/box.h"
#include "geometry/weld.h"
#include "geometry/world_vector.h"
#include "repair/arrangement/arrange_faces.h"
#include "repair/arrangement/dissolve_cuts.h"
#include "repair/regions/outer_walls.h"
#include "repair/regions/separate_sheets.h"
#include "repair/regions/solid_parts.h"

namespace isoshell {
namespace repair {
namespace {

using Corners = std::array<uint32_t, 3>;

/// Faces that look outward, with the triangles of the input that they are parts of.
struct Solids {
  TriangleSoup soup;
  std::vector<uint32_t> source;
  std::vector<uint8_t> is_checked;  ///< per face: it meets no other one outside of what they share
  bool bound_their_union = true;    ///< false: some may lie in others
};

void append(Solids& to, const Solids& more) {
  const uint32_t shift = uint32_t(to.soup.vertices.size());
  to.soup.vertices.insert(to.soup.vertices.end(), more.soup.vertices.begin(), more.soup.vertices.end());
  for (const auto& [a, b, c] : more.soup.triangles) to.soup.triangles.push_back({a + shift, b + shift, c + shift});
  to.source.insert(to.source.end(), more.source.begin(), more.source.end());
  to.is_checked.insert(to.is_checked.end(), more.is_checked.begin(), more.is_checked.end());
  to.bound_their_union = to.bound_their_union && more.bound_their_union;
}

void turn(Solids& solids) {
  for (auto& [a, b, c] : solids.soup.triangles) std::swap(b, c);
}

void weld(TriangleSoup& soup) {
  WeldedVertices welded = weld_vertices(soup.vertices, soup.triangles);
  soup.vertices = std::move(welded.position);
  for (Corners& t : soup.triangles)
    for (uint32_t& v : t) v = welded.place[v];
}

std::array<WorldPoint, 2> edge_between(const WorldPoint& a, const WorldPoint& b) {
  return is_before(b, a) ? std::array{b, a} : std::array{a, b};
}
bool is_edge_before(const std::array<WorldPoint, 2>& a, const std::array<WorldPoint, 2>& b) {
  return a[0] == b[0] ? is_before(a[1], b[1]) : is_before(a[0], b[0]);
}

/// What cannot be united.
struct Failure {
  const char* why;
  WorldPoint at;
};

class Union {
 public:
  Union(const TriangleSoup& soup, const UnionOptions& options, UnionReport& report, const Context& context)
      : soup_(soup),
        options_(options),
        report_(report),
        context_(context),
        box_(box_of(soup.vertices, soup.triangles)),
        given_(weld_vertices(soup.vertices, soup.triangles).position),
        parts_(find_solid_parts(soup, context)),
        part_of_(soup.triangles.size(), 0),
        is_cut_(soup.triangles.size(), 0) {}

  UnitedSoup united() {
    if (!are_solids()) return {soup_, {}};
    for (uint32_t p = 0; p < parts_.size(); ++p)
      for (const uint32_t t : parts_[p].triangles) part_of_[t] = p;
    std::vector<uint32_t> outer;
    for (uint32_t p = 0; p < parts_.size(); ++p) {
      if (parts_[p].shape == PartShape::open) continue;
      (parts_[p].container == kNoContainer ? outer : hollows_[parts_[p].container]).push_back(p);
    }
    try {
      if (outer.empty()) return {soup_, {}};
      Solids all = joined(outer, 0, outer.size(), [&](uint32_t part) { return with_hollows(part); });
      if (options_.outer_only || !all.bound_their_union) all = outer_faces(std::move(all), rule());
      weld(all.soup);
      report_.separated_edges =
          separate_sheets(options_.sheet_gap_world, all.soup.vertices, all.soup.triangles, all.source);
      leave_open_parts(all);
      count(all);
      if (!report_.changed_anything()) return {soup_, {}};
      return result_of(std::move(all));
    } catch (const Failure& failure) {
      report_ = {};
      report_.given_up = failure.why;
      report_.at = failure.at;
      return {soup_, {}};
    }
  }

 private:
  SolidRule rule() const { return options_.outer_only ? SolidRule::enclosed : SolidRule::winding; }

  bool are_solids() const {
    return options_.keeps_open ||
           std::none_of(parts_.begin(), parts_.end(), [](const SolidPart& p) { return p.shape == PartShape::open; });
  }

  /// In halves, so that what lies inside of few is cut away before it meets many.
  template <class SolidOf>
  Solids joined(const std::vector<uint32_t>& parts, size_t begin, size_t end, const SolidOf& solid_of) {
    if (end - begin == 1) return solid_of(parts[begin]);
    const size_t middle = begin + (end - begin) / 2;
    Solids first = joined(parts, begin, middle, solid_of);
    return joined(std::move(first), joined(parts, middle, end, solid_of));
  }

  /// Less the union of its hollows, as if these were solids.
  Solids with_hollows(uint32_t part) {
    const auto found = hollows_.find(part);
    if (found == hollows_.end()) return solid_of(part);
    const std::vector<uint32_t>& parts = found->second;
    Solids hollows = joined(parts, 0, parts.size(), [&](uint32_t hollow) { return solid_of(hollow); });
    turn(hollows);
    return joined(solid_of(part), hollows);
  }

  /// As it looks outward; what is open as it is.
  Solids solid_of(uint32_t part) {
    const SolidPart& p = parts_[part];
    const bool is_turned = p.is_turned != (p.container != kNoContainer);
    Solids solid;
    solid.source = p.triangles;
    solid.is_checked.assign(p.triangles.size(), 0);
    for (const uint32_t t : p.triangles) {
      Corners corner = soup_.triangles[t];
      if (is_turned) std::swap(corner[1], corner[2]);
      for (uint32_t& v : corner) {
        solid.soup.vertices.push_back(soup_.vertices[v]);
        v = uint32_t(solid.soup.vertices.size() - 1);
      }
      solid.soup.triangles.push_back(corner);
    }
    if (p.shape == PartShape::branching || options_.own_faces) return outer_faces(arranged(solid, 0), solid, {});
    return solid;
  }

  Solids joined(Solids first, const Solids& second) {
    check_cancel(context_, "unite");
    const size_t first_of_second = first.source.size();
    append(first, second);
    if (first_of_second == 0 || second.source.empty()) return first;
    const ArrangedFaces arranged_faces = arranged(first, first_of_second);
    if (!arranged_faces.is_near) {
      first.bound_their_union = false;
      return first;
    }
    return outer_faces(arranged_faces, first, SolidRule::winding);
  }

  ArrangedFaces arranged(const Solids& solids, size_t first_of_second) {
    WorldPoint failed_at{0, 0, 0};
    std::optional<ArrangedFaces> faces = arrange_faces(solids.soup, failed_at, context_,
                                                       {first_of_second, box_, solids.is_checked, options_.near_world});
    if (!faces) throw Failure{"the faces cannot be cut along each other there", failed_at};
    for (size_t t = 0; t < solids.source.size(); ++t) is_cut_[solids.source[t]] |= faces->is_cut[t];
    return std::move(*faces);
  }

  /// Of faces that meet nowhere but at what they share.
  Solids outer_faces(Solids solids, SolidRule rule) {
    ArrangedFaces faces;
    faces.box = box_;
    faces.point = std::move(solids.soup.vertices);
    faces.face = std::move(solids.soup.triangles);
    faces.source.resize(faces.face.size());
    std::iota(faces.source.begin(), faces.source.end(), 0u);
    return outer_faces(faces, solids, rule);
  }
  /// Without a rule that which their edges allow.
  Solids outer_faces(const ArrangedFaces& faces, const Solids& solids, std::optional<SolidRule> rule) {
    const Walls walls = find_walls(faces);
    const Cells cells = find_cells(walls, context_);
    if (!rule) rule = have_closed_chains(walls) ? SolidRule::winding : SolidRule::seen_from_back;
    OuterWalls outer = find_outer_walls(walls, cells, *rule);
    touching_.insert(touching_.end(), outer.touching.begin(), outer.touching.end());
    PiecedFaces pieces{std::move(outer.point), std::move(outer.face), std::move(outer.source), {}};
    for (const uint32_t f : pieces.source) pieces.is_piece.push_back(!faces.is_cut.empty() && faces.is_cut[f]);
    // Pieces of pieces have numbers of their own here, so that no array is as long as the input.
    const std::vector<uint32_t> triangles = number_sources(pieces.source, solids.source);
    std::vector<uint32_t> kind;  // planes of several parts are not joined, nor are caps with what they close
    for (const uint32_t t : triangles) kind.push_back(2 * part_of_[t] + (t >= soup_.first_cap ? 1 : 0));
    dissolve_cuts(pieces, kind, given_among(pieces.point), box_, context_);
    for (uint32_t& f : pieces.source) f = triangles[f];
    Solids result;
    result.soup.vertices = std::move(pieces.point);
    result.soup.triangles = std::move(pieces.face);
    result.source = std::move(pieces.source);
    result.is_checked.assign(result.source.size(), 1);
    return result;
  }

  /// Numbers the triangles of the input that faces are of by their order. Result: per number the triangle.
  static std::vector<uint32_t> number_sources(std::vector<uint32_t>& source, const std::vector<uint32_t>& triangle_of) {
    std::vector<uint32_t> triangles;
    for (uint32_t& f : source) triangles.push_back(f = triangle_of[f]);
    std::sort(triangles.begin(), triangles.end());
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
    for (uint32_t& f : source)
      f = uint32_t(std::lower_bound(triangles.begin(), triangles.end(), f) - triangles.begin());
    return triangles;
  }

  std::vector<uint8_t> given_among(const std::vector<WorldPoint>& points) const {
    std::vector<uint8_t> is_given;
    for (const WorldPoint& p : points)
      is_given.push_back(std::binary_search(given_.begin(), given_.end(), p, is_before));
    return is_given;
  }

  /// As they are, if they are apart from the others.
  void leave_open_parts(Solids& all) {
    const size_t first_of_second = all.source.size();
    for (uint32_t p = 0; p < parts_.size(); ++p) {
      if (parts_[p].shape != PartShape::open) continue;
      append(all, solid_of(p));
      ++report_.left_components;
    }
    if (report_.left_components == 0) return;
    WorldPoint at{0, 0, 0};
    const std::optional<ArrangedFaces> faces = arrange_faces(all.soup, at, context_, {first_of_second, box_});
    if (!faces || faces->cut_faces() > 0) throw Failure{"a component that is open meets them", at};
  }

  void count(const Solids& all) {
    std::vector<uint8_t> is_kept(soup_.triangles.size(), 0);
    for (const uint32_t t : all.source) is_kept[t] = 1;
    for (const SolidPart& p : parts_) {
      const bool stays = std::any_of(p.triangles.begin(), p.triangles.end(), [&](uint32_t t) { return is_kept[t]; });
      report_.turned_components += p.is_turned;
      report_.inner_surfaces += stays && p.container != kNoContainer;
      (options_.outer_only ? report_.dropped_inner : report_.swallowed_components) += !stays;
    }
    report_.cut_faces = std::count(is_cut_.begin(), is_cut_.end(), 1);
    report_.internal_faces = int64_t(touching_.size());
  }

  /// Faces in the order of the input, caps last.
  UnitedSoup result_of(Solids all) {
    std::vector<uint32_t> order(all.source.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return all.source[a] < all.source[b]; });
    UnitedSoup out;
    out.soup.vertices = std::move(all.soup.vertices);
    out.soup.faces_in_file = soup_.faces_in_file;
    out.soup.dirt = soup_.dirt;
    for (const uint32_t f : order) {
      if (all.source[f] >= soup_.first_cap && out.soup.first_cap > out.soup.triangles.size())
        out.soup.first_cap = uint32_t(out.soup.triangles.size());
      out.soup.triangles.push_back(all.soup.triangles[f]);
    }
    out.interfaces = interfaces_of(out.soup);
    return out;
  }

  /// Edges of the result that are those of walls between parts that touch.
  std::vector<std::array<WorldPoint, 2>> interfaces_of(const TriangleSoup& result) const {
    std::vector<std::array<WorldPoint, 2>> edges, found;
    for (const auto& [a, b, c] : touching_)
      edges.insert(edges.end(), {edge_between(a, b), edge_between(b, c), edge_between(c, a)});
    std::sort(edges.begin(), edges.end(), is_edge_before);
    if (edges.empty()) return found;
    for (const auto& t : result.triangles)
      for (size_t i = 0; i < 3; ++i) {
        const uint32_t u = t[i], v = t[(i + 1) % 3];
        const std::array<WorldPoint, 2> edge = edge_between(result.vertices[u], result.vertices[v]);
        if (std::binary_search(edges.begin(), edges.end(), edge, is_edge_before)) found.push_back(edge);
      }
    std::sort(found.begin(), found.end(), is_edge_before);
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  const TriangleSoup& soup_;
  const UnionOptions& options_;
  UnionReport& report_;
  const Context& context_;
  const WorldBox box_;
  const std::vector<WorldPoint> given_;  ///< positions of the input, ascending
  const std::vector<SolidPart> parts_;
  std::map<uint32_t, std::vector<uint32_t>> hollows_;  ///< per part those that bound hollows of it
  std::vector<uint32_t> part_of_;                      ///< per triangle of the input
  std::vector<uint8_t> is_cut_;                        ///< per triangle of the input
  std::vector<std::array<WorldPoint, 3>> touching_;
};

}  // namespace
}  // namespace repair

UnitedSoup boolean_union(const TriangleSoup& soup, const UnionOptions& options, UnionReport& report,
                         const Context& context) {
  report = {};
  return run_with_threads(context, [&] { return repair::Union(soup, options, report, context).united(); });
}

}  // namespace isoshell
