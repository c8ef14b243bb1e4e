// See part_regions.h.
#include "isoshell/part_regions.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <sstream>
#include <utility>

#include "core/watched.h"
#include "geometry/make_one.h"
#include "isoshell/error.h"
#include "isoshell/readable.h"
#include "repair/regions/labels.h"
#include "repair/regions/near_regions.h"
#include "repair/regions/thin_cells.h"
#include "repair/regions/turn_sheets.h"

namespace isoshell {
namespace repair {
namespace {

constexpr int64_t kBytesPerFace = 400;  // a quarter more than the peaks that were measured
constexpr size_t kMostSaid = 8;         ///< warnings of one kind
constexpr double kBulge = 2;            ///< of a solid with a hole, over the area of the largest disk in its border
constexpr double kCircleAreas = 12.566370614359172;  ///< a circle's length squared by its area
constexpr double kNoOverlap = 1e-9;                  ///< of the smaller part's volume

std::string shown(const Parts& parts, uint32_t part) {
  const std::string number = std::to_string(part + 1);
  return parts.name[part].empty() ? "part " + number : "part " + number + " (" + parts.name[part] + ")";
}

template <class... Words>
std::string sentence(const Words&... words) {
  std::ostringstream text;
  (text << ... << words);
  return text.str();
}

/// Only as many as anyone reads, and how many more there are.
void add_warnings(std::vector<std::string> found, const char* what, std::vector<std::string>& warnings) {
  const size_t more = found.size() > kMostSaid ? found.size() - kMostSaid : 0;
  found.resize(found.size() - more);
  warnings.insert(warnings.end(), found.begin(), found.end());
  if (more > 0) warnings.push_back(with_commas(int64_t(more)) + " more " + what);
}

void warn_of_overlaps(const Parts& parts, const CellParts& cells, std::vector<std::string>& warnings) {
  std::vector<std::string> found;
  for (const PartsOverlap& o : cells.overlaps) {
    const double whole = cells.volume_world[o.other];
    if (o.volume_world <= kNoOverlap * whole) continue;
    found.push_back(sentence(shown(parts, o.keeper), " and ", shown(parts, o.other), " overlap in a volume of ",
                             o.volume_world, ", ", 100 * o.volume_world / whole, " % of the second; ",
                             shown(parts, o.keeper), " keeps it, it comes first in the input"));
  }
  add_warnings(std::move(found), "pairs of parts overlap", warnings);
}

/// Walls of a sheet do not reach far out of its border; those of a solid that has lost some faces do.
void warn_of_open_solids(const Parts& parts, const Chains& chains, std::vector<std::string>& warnings) {
  std::vector<std::string> found;
  for (uint32_t p = 0; p < parts.count(); ++p) {
    const PartOutline& part = chains.part[p];
    if (part.closing != Closing::open) continue;
    if (part.area_world * kCircleAreas <= kBulge * part.open_edges_world * part.open_edges_world) continue;
    found.push_back(sentence(shown(parts, p), " is not closed, ", counted(part.open_edges, "edge"),
                             " of its walls, the first near ", part.at.x, ' ', part.at.y, ' ', part.at.z,
                             ", are borders or have three of them; it becomes a sheet, which bounds no region: close "
                             "its holes, or let --regions cells find what walls enclose"));
  }
  add_warnings(std::move(found), "parts are not closed", warnings);
}

/// Parts that come near to one another where people expect them to touch.
void warn_of_near_regions(const TriangleSoup& walls, double within_world, std::vector<std::string>& warnings,
                          const Context& context) {
  const auto shown = [&](int32_t label) {
    for (const RegionName& region : walls.regions.names)
      if (region.label == label) return std::to_string(label) + " (" + region.name + ")";
    return std::to_string(label);
  };
  std::vector<std::string> found;
  for (const NearRegions& near : find_near_regions(walls, within_world, context))
    found.push_back(sentence("regions ", shown(near.labels[0]), " and ", shown(near.labels[1]), " are ",
                             near.distance_world, " apart near ", exact_place(near.at),
                             " and share no wall; --snap W with W above that lets them share one"));
  add_warnings(std::move(found), "pairs of regions are nearly as near", warnings);
}

/// What all faces of which are sheets has walls, so nothing else would say that it has no regions.
void warn_of_no_region(const TriangleSoup& walls, const std::string& how, std::vector<std::string>& warnings) {
  const auto& labels = walls.regions.labels;
  if (std::any_of(labels.begin(), labels.end(), [](const auto& sides) { return sides[0] != 0 || sides[1] != 0; }))
    return;
  if (how == "cells")
    warnings.push_back(
        "--regions cells finds no region: the faces enclose no space, and all become sheets; close them");
  else
    warnings.push_back("--regions " + how +
                       " finds no region: no part is closed, and all become sheets, which bound "
                       "none; close their borders, or let --regions cells find what walls enclose");
}

/// What each cell is labelled with.
struct CellLabels {
  std::vector<int32_t> of_cell;
  std::vector<RegionName> names;
};

int32_t checked_label(size_t label) {
  if (label > size_t(std::numeric_limits<int32_t>::max()))
    throw Error(ErrorCode::usage, "regions", std::to_string(label) + " regions; labels go up to 2147483647");
  return int32_t(label);
}

/// Parts that are closed, by the order of the input, whether or not they keep any space.
CellLabels labels_of_parts(const Parts& parts, const Chains& chains, const CellParts& found) {
  CellLabels out;
  std::vector<uint8_t> has_cell(parts.count(), 0);
  for (const uint32_t part : found.of_cell)
    if (part != kNoPart) has_cell[part] = 1;
  std::vector<int32_t> label(parts.count(), 0);
  size_t count = 0;
  for (size_t p = 0; p < parts.count(); ++p) {
    if (chains.part[p].closing == Closing::open || !has_cell[p]) continue;
    label[p] = checked_label(++count);
    if (!parts.name[p].empty()) out.names.push_back({label[p], parts.name[p]});
  }
  for (const uint32_t part : found.of_cell) out.of_cell.push_back(part == kNoPart ? 0 : label[part]);
  return out;
}

CellLabels labels_of_cells(size_t cells) {
  CellLabels out;
  for (size_t cell = 0; cell < cells; ++cell) out.of_cell.push_back(checked_label(cell));
  return out;
}

/// In their order, without gaps.
CellLabels numbered_again(CellLabels labels) {
  std::vector<int32_t> kept = labels.of_cell;
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  for (int32_t& label : labels.of_cell)
    label = int32_t(std::lower_bound(kept.begin(), kept.end(), label) - kept.begin());
  return labels;
}

void join_thin_cells(const Walls& walls, const Cells& cells, const PartOptions& options, CellLabels& labels,
                     std::vector<std::string>& warnings) {
  const JoinedCells joined =
      join_thin_cells(walls, cells, options.thin_world, options.parts == "cells", labels.of_cell);
  if (joined.count == 0) return;
  const WorldPoint& at = *joined.first;
  warnings.push_back(sentence(counted(joined.count, "space"), " between faces, the first near ", at.x, ' ', at.y, ' ',
                              at.z, joined.count == 1 ? ", is" : ", are", " less than ", options.thin_world,
                              " thick, and ", joined.count == 1 ? "belongs" : "belong",
                              " to what is beside; more --vertices keep thinner ones, or a smaller --snap"));
}

/// Per wall whether it has one cell on both sides: a sheet.
std::vector<uint8_t> walls_inside_of_cells(const Walls& walls, const Cells& cells) {
  std::vector<uint8_t> is_sheet(walls.triangle.size());
  for (size_t w = 0; w < is_sheet.size(); ++w) is_sheet[w] = cells.of_wall[w][0] == cells.of_wall[w][1];
  return is_sheet;
}

/// The walls that stay, each behind the region with the smaller label, or else as its first face looks.
TriangleSoup kept_walls(const Walls& walls, const Cells& cells, const CellLabels& labels,
                        const std::vector<uint8_t>& is_sheet) {
  TriangleSoup soup;
  soup.regions.names = labels.names;
  for (size_t w = 0; w < walls.triangle.size(); ++w) {
    int32_t front = labels.of_cell[cells.of_wall[w][0]], behind = labels.of_cell[cells.of_wall[w][1]];
    if (front == behind && !is_sheet[w]) continue;
    const bool turns = front == behind ? walls.faces_on(w)[0].is_turned : behind == 0 || (front != 0 && front < behind);
    if (turns) std::swap(front, behind);
    const auto& [a, b, c] = walls.triangle[w];
    soup.triangles.push_back(turns ? std::array<uint32_t, 3>{a, c, b} : walls.triangle[w]);
    soup.regions.labels.push_back({behind, front});
  }
  soup.vertices = walls.point;
  drop_unused_vertices(soup);
  return soup;
}

/// Per wall whether a part that is open has a face on it.
std::vector<uint8_t> walls_of_sheets(const Walls& walls, const Chains& chains) {
  std::vector<uint8_t> is_sheet(walls.triangle.size(), 0);
  for (size_t w = 0; w < is_sheet.size(); ++w)
    for (const PartOnWall& on : chains.parts_on(w))
      is_sheet[w] |= uint8_t(chains.part[on.part].closing == Closing::open);
  return is_sheet;
}

/// What lies on or passes through another is cut there.
ArrangedFaces arranged(const TriangleSoup& soup, double near_world, std::vector<std::string>& warnings,
                       Context& context) {
  WorldPoint at{0, 0, 0};
  std::optional<ArrangedFaces> faces = arrange_faces(soup, at, context, {0, {}, {}, near_world});
  if (!faces)
    throw Error(
        ErrorCode::usage, "regions",
        sentence("the faces cannot be cut along each other near ", at.x, ' ', at.y, ' ', at.z,
                 ", where very many of them cross at small angles; part them there, or make near ones one (--snap)"));
  if (faces->face.empty())
    throw Error(ErrorCode::nothing_to_mesh, "regions", "no face has an area: there is nothing to part regions");
  if (!faces->is_as_wanted)
    warnings.push_back(sentence("only what meets was made one, and not what is nearer than ", near_world,
                                ": that takes too many cuts near ", at.x, ' ', at.y, ' ', at.z,
                                "; part the faces there, or give another --snap"));
  return std::move(*faces);
}

PartRegions part_regions(const TriangleSoup& soup, const PartOptions& options, Context& context) {
  const std::string& how = options.parts;
  Parts parts;
  if (how != "cells") parts = how == "components" ? find_components(soup, context) : find_parts_by(soup, how);
  PartRegions out;
  const Walls walls = find_walls(arranged(soup, options.near_world, out.warnings, context));
  const Cells cells = find_cells(walls, context);
  if (how == "cells") {
    CellLabels labels = labels_of_cells(cells.count());
    join_thin_cells(walls, cells, options, labels, out.warnings);
    out.walls = kept_walls(walls, cells, numbered_again(std::move(labels)), walls_inside_of_cells(walls, cells));
  } else {
    const Chains chains = find_chains(walls, parts, context);
    const CellParts found = find_parts_of_cells(walls, cells, chains, how == "components");
    CellLabels labels = labels_of_parts(parts, chains, found);
    join_thin_cells(walls, cells, options, labels, out.warnings);
    out.walls = kept_walls(walls, cells, labels, walls_of_sheets(walls, chains));
    warn_of_open_solids(parts, chains, out.warnings);
    warn_of_overlaps(parts, found, out.warnings);
  }
  if (out.walls.triangles.empty())
    throw Error(ErrorCode::nothing_to_mesh, "regions", "the faces lie on one another in pairs, which enclose nothing");
  warn_of_no_region(out.walls, how, out.warnings);
  warn_of_near_regions(out.walls, options.gap_world, out.warnings, context);
  turn_sheets(out.walls);
  out.walls.faces_in_file = soup.faces_in_file;
  out.walls.dirt = soup.dirt;
  out.walls.far = soup.far;
  return out;
}

}  // namespace
}  // namespace repair

PartRegions find_part_regions(const TriangleSoup& soup, const PartOptions& options, Context& context) {
  if (!soup.regions.empty())
    throw Error(ErrorCode::usage, "regions", "the input parts regions already; leave out --regions " + options.parts);
  const int64_t bytes = repair::kBytesPerFace * int64_t(soup.triangles.size());
  if (context.memory_limit_bytes > 0 && bytes > context.memory_limit_bytes)
    throw Error(ErrorCode::out_of_memory, "memory",
                "the walls of " + counted(int64_t(soup.triangles.size()), "face") + " need about " +
                    readable_bytes(bytes) + ", more than the limit of " + readable_bytes(context.memory_limit_bytes) +
                    "; raise --max-memory");
  return run_with_threads(context, [&] { return repair::part_regions(soup, options, context); });
}

}  // namespace isoshell
