// Everything measured in a run, as JSON.
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "isoshell/options/options_json.h"
#include "isoshell/run/record.h"
#include "isoshell/version.h"
#include "run/regions_json.h"

namespace isoshell {
namespace {

using Json = nlohmann::ordered_json;

Json known(int64_t count) { return count < 0 ? Json() : Json(count); }
Json known(const std::string& text) { return text.empty() ? Json() : Json(text); }

Json point(const std::optional<WorldPoint>& p) { return p ? Json{p->x, p->y, p->z} : Json(); }

Json dirt_json(const DirtCounts& d) {
  return {{"nonfinite_vertices", d.nonfinite_vertices},
          {"faces_with_nonfinite_vertices", d.dropped_faces_nonfinite},
          {"short_faces", d.short_faces},
          {"degenerate_faces", d.degenerate_faces},
          {"duplicate_faces", d.duplicate_faces},
          {"unreferenced_vertices", d.unreferenced_vertices},
          {"nonmanifold_edges", d.nonmanifold_edges},
          {"inconsistent_edges", d.inconsistent_edges},
          {"other_primitives", d.other_primitives},
          {"posed_meshes", d.posed_meshes},
          {"long_rows", d.long_rows},
          {"surplus_rows", d.surplus_rows},
          {"surplus_bytes", d.surplus_bytes}};
}

Json repair_json(const FarVertexReport& far, const RepairReport& m) {
  return {{"far_vertices", far.vertices},
          {"far_distance", far.distance_world},
          {"farthest", far.vertices > 0 ? point(far.farthest) : Json()},
          {"joined_vertices", m.joined_vertices},
          {"repeated_faces", m.repeated_faces},
          {"fins", m.fins},
          {"fin_faces", m.fin_faces},
          {"islands", m.islands},
          {"island_faces", m.island_faces},
          {"turned_faces", m.turned_faces},
          {"capped_loops", m.capped_loops},
          {"tubes", m.tubes},
          {"cap_faces", m.cap_faces},
          {"cap_area", m.cap_area_world},
          {"widest_cap", m.widest_cap_world},
          {"open_loops", m.open_loops}};
}

Json union_json(const UnionReport& u) {
  return {{"turned_components", u.turned_components},
          {"swallowed_components", u.swallowed_components},
          {"inner_surfaces", u.inner_surfaces},
          {"dropped_inner_components", u.dropped_inner},
          {"cut_faces", u.cut_faces},
          {"internal_faces", u.internal_faces},
          {"separated_edges", u.separated_edges},
          {"left_components", u.left_components},
          {"not_joined", known(u.given_up)},
          {"not_joined_at", point(u.at)}};
}

/// Schema 1 says under "grid" what came of the options that choose it.
Json options_of_schema(const RunOptions& options) {
  Json j = Json::parse(options_json(options));
  for (const char* name : {"resolution", "voxel-size", "close-gaps"}) j.erase(name);
  return j;
}

Json input_json(const RunRecord& r) {
  const InputTopology& t = r.report.input.topology;
  return {{"path", r.input.path},
          {"also", r.input.also},
          {"kind", kind_name(r.input.kind)},
          {"vertices", known(r.input.vertices)},
          {"faces", known(r.input.faces)},
          {"dropped", dirt_json(r.report.input.dirt)},
          {"mended", repair_json(r.report.input.far, r.report.input.repair)},
          {"united", union_json(r.report.input.united)},
          {"bbox", {{"min", point(r.input.box_min)}, {"max", point(r.input.box_max)}}},
          {"components", t.components},
          {"genus", known(t.genus)},
          {"boundary_loops", t.boundary_loops},
          {"closed", t.closed},
          {"oriented", t.oriented},
          {"area", t.area_world}};
}

/// The numbers of its file, whose positions are those that the result is measured on.
Json output_json(const RunRecord& r) {
  Json j = {{"path", r.output.path}, {"format", r.output.format}};
  if (r.files.empty() || r.files.front().path != r.output.path) return j;
  const HeldPositions& held = r.files.front().held;
  j["bits"] = held.is_single ? 32 : 64;
  j["offset"] = point(held.offset_world);
  j["moved"] = held.moved_world;
  j["lost_triangles"] = held.lost_triangles;
  return j;
}

Json grid_json(const GridReport& r) {
  return {{"resolution", r.frame.resolution},
          {"voxel_size", r.frame.voxel_size},
          {"band", r.band_vox},
          {"closing", r.closing_vox},
          {"grown", r.grown_vox}};
}

Json counts_json(const RunRecord& r) {
  return {{"sites", r.report.grid.sites},
          {"active_voxels", r.report.grid.active_voxels > 0 ? Json(r.report.grid.active_voxels) : Json()},
          {"leaves", r.report.grid.leaves > 0 ? Json(r.report.grid.leaves) : Json()},
          {"asked", r.report.count.asked ? Json(*r.report.count.asked) : Json()},
          {"sheet_vertices", r.report.sheet.vertices},
          {"seeds", r.report.seeds},
          {"vertices", known(r.vertices)},
          {"triangles", known(r.triangles)}};
}

/// Holes that faces closed and gaps that voxels bridged, and how much of the result lies where the input has no
/// surface.
Json gaps_json(const RunRecord& r) {
  const RepairReport& m = r.report.input.repair;
  return {{"loops", m.capped_loops + r.report.gaps.bridges},
          {"widest", std::max(m.widest_cap_world, r.report.gaps.widest_bridge_world)},
          {"bridged_sheet_vertices", r.report.sheet.topology.bridged_vertices},
          {"area", r.report.gaps.area_world},
          {"vertices", r.report.gaps.vertices},
          {"risky_sites", known(r.risky_sites)}};
}

Json attributes_json(const AttributeReport& r) {
  Json kept = Json::array(), dropped = Json::array();
  for (const std::string& name : r.kept) kept.push_back(name);
  for (const DroppedAttribute& d : r.dropped) dropped.push_back({{"name", d.name}, {"reason", d.reason}});
  Json grids = Json::array();
  for (const SampledGrid& g : r.grids)
    grids.push_back({{"name", g.name}, {"attributes", g.attributes}, {"vertices_outside", g.vertices_outside}});
  return {{"kept", kept}, {"dropped", dropped}, {"grids", grids}};
}

Json topology_json(const RunRecord& r) {
  Json j = {{"components", nullptr},
            {"genus", nullptr},
            {"closed", nullptr},
            {"manifold", nullptr},
            {"boundary_loops", nullptr},
            {"nonmanifold_edges", nullptr},
            {"nonmanifold_vertices", nullptr},
            {"self_intersections", r.report.is_optimized ? Json(r.report.optimize.self_intersections) : Json()},
            {"intersection_at", point(r.report.intersection_at)},
            {"sheet_components", r.report.sheet.topology.components},
            {"sheet_genus", r.report.sheet.topology.genus},
            {"cut_handles", r.report.sheet.topology.cut_handles},
            {"agrees_with_input", r.report.sheet.is_compared ? Json(r.report.sheet.agrees) : Json()},
            {"failed_cells", r.report.dual.failed_cells},
            {"inserted_seeds", r.report.dual.inserted_seeds}};
  if (!r.topology) return j;
  const MeshTopology& t = *r.topology;
  j["components"] = t.components;
  j["genus"] = known(t.genus);
  j["closed"] = t.closed;
  j["manifold"] = t.is_manifold_with(r.report.features.border_loops);
  j["boundary_loops"] = t.boundary_loops;
  j["nonmanifold_edges"] = t.nonmanifold_edges;
  j["nonmanifold_vertices"] = t.nonmanifold_vertices;
  return j;
}

Json quality_json(const RunRecord& r) {
  if (!r.quality) return nullptr;
  const MeshQuality& q = *r.quality;
  Json poor = Json::array();
  for (const PoorAngle& p : q.poor_angles)
    poor.push_back({{"degrees", p.degrees}, {"at", {p.middle.x, p.middle.y, p.middle.z}}});
  return {{"q_min", q.q_min},
          {"q_avg", q.q_avg},
          {"theta_min_deg", q.theta_min_deg},
          {"theta_avg_deg", q.theta_avg_deg},
          {"theta_max_deg", q.theta_max_deg},
          {"dihedral_min_deg", q.dihedral.degrees},
          {"dihedral_min_at", point(q.dihedral.middle)},
          {"below_30_deg", q.below_30_deg},
          {"below_30_deg_pct", q.below_30_deg_pct},
          {"poor_angles", poor},
          {"irregular_ratio", q.irregular_ratio},
          {"edge_cv", q.edge_cv},
          {"area_cv", q.area_cv}};
}

Json distance_json(const std::optional<MeshDistance>& d) {
  if (!d) return nullptr;
  const auto both = [&](double unit) -> Json {
    return {{"to_input_mean", d->to_reference.mean / unit},
            {"to_input_rms", d->to_reference.rms / unit},
            {"to_input_max", d->to_reference.max / unit},
            {"from_input_mean", d->from_reference.mean / unit},
            {"from_input_rms", d->from_reference.rms / unit},
            {"from_input_max", d->from_reference.max / unit},
            {"hausdorff", d->largest() / unit}};
  };
  Json j = both(1);
  j["unit"] = "world";
  j["diagonal"] = d->diagonal;
  j["pct_of_diagonal"] = d->diagonal > 0 ? both(d->diagonal / 100) : Json();
  return j;
}

constexpr size_t kMostLost = 100;  ///< that are listed: large inputs lose thousands

/// How many curves are lost for which reason, and the longest of them.
void add_lost(const std::vector<LostCurve>& all, Json& j) {
  Json reasons = Json::array(), lost = Json::array();
  for (const LostForReason& of : lost_by_reason(all, kMostLost))
    reasons.push_back({{"reason", of.reason}, {"curves", of.curves}, {"length", of.length_world}});
  for (const LostCurve& curve : longest_of(all, kMostLost))
    lost.push_back({{"index", curve.index},
                    {"kind", curve.kind},
                    {"length", curve.length_world},
                    {"at", point(curve.at)},
                    {"reason", curve.reason}});
  j["lost_curves"] = all.size();
  j["lost_length"] = lost_length_world(all);
  j["lost_by_reason"] = reasons;
  j["lost"] = lost;
}

/// Creases, seams, lines and borders of the input, and whether the result has them.
Json features_json(const FeatureReport& f, double area_world) {
  Json j = {{"kept", f.kept},
            {"curves", f.curves},
            {"seams", f.seams},
            {"lines", f.lines},
            {"corners", f.corners},
            {"patches", f.patches},
            {"vertices", f.vertices},
            {"segments", f.segments},
            {"border_loops", f.border_loops},
            {"length", f.length_world},
            {"kept_length", f.kept_length_world},
            {"passed_over", f.passed_over_world},
            {"passes_over_much", f.passes_over_much(area_world)},
            {"given_up", known(f.given_up)},
            {"on_sheet", known(f.on_sheet)}};
  add_lost(f.lost, j);
  return j;
}

Json normals_json(const std::optional<MeshDistance>& d) {
  if (!d) return nullptr;
  return {{"to_input_mean_deg", d->normal_to_reference.mean_deg},
          {"to_input_max_deg", d->normal_to_reference.max_deg},
          {"from_input_mean_deg", d->normal_from_reference.mean_deg},
          {"from_input_max_deg", d->normal_from_reference.max_deg}};
}

/// Of the result, and how far they are from those of the input as it was meshed.
Json borders_json(const std::optional<BorderMeasures>& b) {
  if (!b) return nullptr;
  return {{"loops", b->loops},
          {"length", b->length_world},
          {"input_loops", b->reference_loops},
          {"input_length", b->reference_length_world},
          {"to_input_max", b->to_reference_max},
          {"from_input_max", b->from_reference_max}};
}

Json sizing_json(const SizingReport& s) {
  if (!s.varies) return nullptr;
  return {{"min", s.least_world}, {"max", s.largest_world}, {"edge_error_mean", s.edge_error_mean}};
}

Json timings_json(const RunRecord& r) {
  Json j = Json::object();
  for (const auto* times : {&r.times, &r.report.times})
    for (const StageTime& t : *times) j[t.stage] = t.ms;
  j["total"] = r.total_ms;
  return j;
}

Json device_json(const DeviceInfo& d) {
  if (d.backend != "cuda") return nullptr;
  return {{"number", d.number},
          {"name", d.name},
          {"driver", known(d.driver_version)},
          {"driver_cuda", d.cuda_version},
          {"memory_bytes", d.memory_bytes}};
}

/// Of a frame that follows another.
Json coherence_json(const RunRecord& r) {
  if (!r.options.previous) return nullptr;
  const CoherenceReport& c = r.report.coherence;
  return {{"began_warm", c.began_warm},
          {"why_cold", known(c.why_cold)},
          {"born", c.born},
          {"kept_edges_pct", c.kept_edges_pct},
          {"excess", c.excess}};
}

Json region_json(const RegionName& region) {
  return {{"label", region.label}, {"name", region.name.empty() ? Json() : Json(region.name)}};
}

Json pairs_json(const std::vector<std::array<RegionName, 2>>& pairs) {
  Json list = Json::array();
  for (const auto& [a, b] : pairs) list.push_back({region_json(a), region_json(b)});
  return list;
}

Json volumes_json(const std::vector<RegionVolumes>& volumes) {
  Json list = Json::array();
  for (const RegionVolumes& of : volumes) {
    if (!of.has_changed()) continue;
    Json j = region_json(of.region);
    j["volume_before"] = of.before_world;
    j["volume"] = of.after_world;
    j["change_pct"] = of.change_pct();
    list.push_back(j);
  }
  return list;
}

/// The census, and what of the input's regions it has not; null of a result without regions.
Json regions_of_run_json(const RunRecord& r) {
  Json j = regions_json(r.regions);
  const std::optional<RegionChanges> changes = region_changes_of(r);
  if (!changes) return j;
  Json lost = Json::array();
  for (const RegionName& region : changes->lost) lost.push_back(region_json(region));
  j["regions_lost"] = lost;
  j["walls_lost"] = pairs_json(changes->lost_walls);
  j["walls_new"] = pairs_json(changes->new_walls);
  j["walls_absorbed"] = pairs_json(changes->absorbed_walls);
  std::map<int32_t, double> before;
  for (const RegionVolumes& of : changes->volumes) before[of.region.label] = of.before_world;
  for (Json& region : j["regions"])
    if (const auto was = before.find(region["label"].get<int32_t>()); was != before.end())
      region["volume_before"] = was->second;
  j["volumes_changed"] = volumes_json(changes->volumes);
  return j;
}

}  // namespace

std::string statistics_json(const RunRecord& r) {
  Json j;
  j["schema"] = 1;
  j["version"] = ISOSHELL_VERSION;
  j["options"] = options_of_schema(r.options);
  j["input"] = input_json(r);
  j["output"] = output_json(r);
  j["grid"] = grid_json(r.report.grid);
  j["counts"] = counts_json(r);
  j["gaps"] = gaps_json(r);
  j["attributes"] = attributes_json(r.attributes);
  j["topology"] = topology_json(r);
  j["regions"] = regions_of_run_json(r);
  j["quality"] = quality_json(r);
  j["features"] = features_json(r.report.features, r.report.input.topology.area_world);
  j["coherence"] = coherence_json(r);
  j["borders"] = borders_json(r.borders);
  j["sizing"] = sizing_json(r.report.sizing);
  j["distance"] = distance_json(r.distance);
  j["normals"] = normals_json(r.distance);
  j["energy"] = r.report.relax.energy;
  j["timings_ms"] = timings_json(r);
  j["memory_bytes"] = {
      {"host_peak", r.host_peak_bytes},
      {"device_peak", r.device.backend == "cuda" ? Json(r.device_peak_bytes) : Json()},
      {"estimate", r.report.grid.memory_estimate_bytes > 0 ? Json(r.report.grid.memory_estimate_bytes) : Json()}};
  j["device"] = r.device.backend;
  j["device_details"] = device_json(r.device);
  j["digests"] = r.report.digests.empty() ? Json::object() : Json(r.report.digests);
  j["warnings"] = r.warnings.empty() ? Json::array() : Json(r.warnings);
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string estimate_json(const RunEstimate& e, int64_t memory_limit_bytes) {
  Json j;
  j["schema"] = 1;
  j["version"] = ISOSHELL_VERSION;
  j["estimate"] = {{"resolution", e.resolution},       {"voxel_size", e.voxel_size_world},
                   {"vertices", known(e.vertices)},    {"sites", e.sites},
                   {"active_voxels", e.active_voxels}, {"sheet_vertices", e.sheet_vertices},
                   {"memory_bytes", e.bytes}};
  j["memory_limit_bytes"] = memory_limit_bytes > 0 ? Json(memory_limit_bytes) : Json();
  return j.dump(2) + "\n";
}

}  // namespace isoshell
