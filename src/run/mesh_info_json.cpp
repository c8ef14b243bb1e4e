// The certificate of a mesh as JSON.
#include <nlohmann/json.hpp>

#include "isoshell/io/output_files.h"
#include "isoshell/run/mesh_info.h"
#include "isoshell/version.h"
#include "run/regions_json.h"

namespace isoshell {
namespace {

using Json = nlohmann::ordered_json;

Json facts_json(const InputFacts& f) {
  return {{"path", f.path}, {"kind", kind_name(f.kind)}, {"vertices", f.vertices}, {"faces", f.faces}};
}

Json dirt_json(const DirtCounts& d) {
  return {{"nonfinite_vertices", d.nonfinite_vertices},
          {"faces_with_nonfinite_vertices", d.dropped_faces_nonfinite},
          {"short_faces", d.short_faces}};
}

/// With regions the mesh encloses no volume of its own: its inner walls face one of the two that they part.
Json topology_json(const MeshInfo& info) {
  const MeshCensus& census = info.census;
  const ComplexCounts& c = census.counts;
  return {{"vertices", c.vertices},
          {"triangles", c.triangles},
          {"edges", c.edges},
          {"unreferenced_vertices", c.vertices - c.referenced_vertices},
          {"duplicate_vertices", c.duplicate_vertices},
          {"repeated_corner_triangles", c.repeated_corners},
          {"duplicate_triangles", c.duplicate_triangles},
          {"components", c.components},
          {"closed_components", c.closed_components},
          {"bordered_components", c.bordered_components},
          {"nonorientable_components", c.nonorientable_components},
          {"inverted_components", c.inverted_components},
          {"genus", c.genus},
          {"euler", c.euler},
          {"boundary_edges", c.boundary_edges},
          {"boundary_loops", c.boundary_loops},
          {"nonmanifold_edges", c.nonmanifold_edges},
          {"inconsistent_edges", c.inconsistent_edges},
          {"nonmanifold_vertices", c.nonmanifold_vertices},
          {"bow_ties", c.bow_ties},
          {"closed_manifold", c.closed_manifold},
          {"volume", info.regions ? Json() : Json(c.volume_world)},
          {"self_intersecting_pairs", census.intersecting_pairs},
          {"self_intersecting_triangles", census.intersecting_triangles}};
}

Json quality_json(const TriangleShapes& s, const LeastDihedral& dihedral) {
  return {{"q_min", s.q_min},
          {"q_mean", s.q_mean},
          {"angle_min_deg", s.angle_min_deg},
          {"angle_max_deg", s.angle_max_deg},
          {"smallest_angle_mean_deg", s.smallest_angle_mean_deg},
          {"dihedral_min_deg", dihedral.degrees},
          {"dihedral_min_at", {dihedral.middle.x, dihedral.middle.y, dihedral.middle.z}},
          {"below_1_deg", s.below_1},
          {"below_10_deg_pct", s.below_10_pct},
          {"below_20_deg_pct", s.below_20_pct},
          {"below_30_deg_pct", s.below_30_pct},
          {"above_90_deg_pct", s.above_90_pct},
          {"above_120_deg_pct", s.above_120_pct},
          {"degenerate_triangles", s.degenerate},
          {"zero_area_triangles", s.without_area},
          {"area", s.area_world},
          {"area_cv", s.area_variation},
          {"histograms",
           {{"q", s.q_histogram},
            {"smallest_angle_0_to_60", s.smallest_angle_histogram},
            {"largest_angle_60_to_180", s.largest_angle_histogram}}}};
}

Json edges_json(const EdgeStatistics& e) {
  return {{"mean", e.mean}, {"deviation", e.deviation}, {"cv", e.variation()}, {"min", e.min}, {"max", e.max}};
}

Json valence_json(const ValenceCounts& v) {
  return {{"interior_vertices", v.interior},
          {"boundary_vertices", v.boundary},
          {"min", v.smallest},
          {"max", v.largest},
          {"irregular_ratio", v.interior > 0 ? Json(v.irregular_ratio) : Json()},
          {"boundary_irregular_ratio", v.boundary > 0 ? Json(v.boundary_irregular_ratio) : Json()},
          {"with_5_to_7_pct", v.interior > 0 ? Json(v.with_5_to_7_pct) : Json()},
          {"interior_histogram", v.interior_with}};
}

/// Without normals where points are measured, which have none.
Json side_json(const OneSidedDistance& d, const NormalDeviation* normals, double diagonal) {
  const auto pct = [&](double world) { return diagonal > 0 ? Json(100 * world / diagonal) : Json(); };
  return {{"mean", d.mean},
          {"rms", d.rms},
          {"max", d.max},
          {"max_at_most", d.at_most ? Json(*d.at_most) : Json()},
          {"mean_pct", pct(d.mean)},
          {"rms_pct", pct(d.rms)},
          {"max_pct", pct(d.max)},
          {"normal_mean_deg", normals ? Json(normals->mean_deg) : Json()},
          {"normal_max_deg", normals ? Json(normals->max_deg) : Json()}};
}

Json distance_json(const std::optional<MeshDistance>& d) {
  if (!d) return nullptr;
  if (d->is_one_way)
    return {{"diagonal", d->diagonal},
            {"hausdorff", nullptr},
            {"hausdorff_pct", nullptr},
            {"to_reference", nullptr},
            {"from_reference", side_json(d->from_reference, nullptr, d->diagonal)}};
  return {{"diagonal", d->diagonal},
          {"hausdorff", d->largest()},
          {"hausdorff_pct", d->diagonal > 0 ? Json(100 * d->largest() / d->diagonal) : Json()},
          {"to_reference", side_json(d->to_reference, &d->normal_to_reference, d->diagonal)},
          {"from_reference", side_json(d->from_reference, &d->normal_from_reference, d->diagonal)}};
}

}  // namespace

std::string mesh_info_json(const MeshInfo& info) {
  Json j;
  j["schema"] = 1;
  j["version"] = ISOSHELL_VERSION;
  j["mesh"] = facts_json(info.mesh);
  j["reference"] = info.reference ? facts_json(*info.reference) : Json();
  j["dirt"] = dirt_json(info.dirt);
  j["diagonal"] = info.census.diagonal_world;
  j["topology"] = topology_json(info);
  j["regions"] = regions_json(info.regions);
  j["quality"] = quality_json(info.census.shapes, info.census.dihedral);
  j["edges"] = edges_json(info.census.edges);
  j["valence"] = valence_json(info.census.valence);
  j["distance"] = distance_json(info.distance);
  j["missed_gates"] = info.missed_gates.empty() ? Json::array() : Json(info.missed_gates);
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_mesh_info(const std::string& path, const MeshInfo& info, bool overwrite) {
  write_text(path, mesh_info_json(info), overwrite);
}

}  // namespace isoshell
