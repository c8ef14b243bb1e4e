// The census of regions as JSON: the same in the statistics of a run and in a certificate.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "isoshell/region_census.h"

namespace isoshell {

/// Null for a mesh without regions.
inline nlohmann::ordered_json regions_json(const std::optional<RegionCensus>& census) {
  using Json = nlohmann::ordered_json;
  if (!census) return nullptr;
  Json regions = Json::array(), walls = Json::array();
  for (const RegionCounts& r : census->regions)
    regions.push_back({{"label", r.label},
                       {"name", r.name.empty() ? Json() : Json(r.name)},
                       {"closed", r.closed},
                       {"triangles", r.faces},
                       {"vertices", r.vertices},
                       {"components", r.components},
                       {"genus", r.closed ? Json(r.genus) : Json()},
                       {"open_edges", r.open_edges},
                       {"inconsistent_edges", r.inconsistent_edges},
                       {"touching_vertices", r.touching_vertices},
                       {"volume", r.volume_world},
                       {"area", r.area_world}});
  for (const RegionWall& w : census->walls)
    walls.push_back({{"labels", {w.labels[0], w.labels[1]}}, {"triangles", w.faces}, {"area", w.area_world}});
  return {{"background", census->background},
          {"every_region_closed", census->every_region_closed},
          {"inside_out_regions", census->inside_out_regions},
          {"duplicate_triangles", census->duplicate_faces},
          {"duplicate_vertices", census->coincident_vertices},
          {"self_intersecting_pairs", census->intersecting_pairs},
          {"curve_edges", census->curve_edges},
          {"corners", census->corners},
          {"regions", regions},
          {"walls", walls}};
}

}  // namespace isoshell
