#include "pipeline/grid/shown_parts.h"

#include <sstream>

#include "isoshell/readable.h"

namespace isoshell {
namespace {

constexpr int64_t kFewestVerticesPerPart = 24;
constexpr int64_t kFewestVerticesPerHandle = 12;  ///< two rings of six; the least torus has seven
constexpr double kLeastCellVox = 0.25;            ///< area of a cell of a surface that is no needle

int64_t vertices_for_parts(const InputTopology& input) {
  return kFewestVerticesPerPart * (input.components + std::max<int64_t>(0, input.genus));
}

std::string length_text(double world) {
  std::ostringstream text;
  text << world;
  return text.str();
}

/// Of the input; 0 where that is not known.
double area_vox(const PreparedSurface& p) {
  const double voxel = p.surface.frame.voxel_size;
  return p.surface.topology.area_world / (voxel * voxel);
}

void warn_of_grown_solid(const PreparedSurface& p, const InputTopology& input, Run& run) {
  const double voxel = p.surface.frame.voxel_size;
  const std::string thickness = length_text((2 * p.grown.distance_vox + 1) * voxel);
  if (p.grown.only_flaps) {
    run.warn("parts of the surface are open and bound nothing: the result follows both of their sides, about " +
             thickness + " apart");
    return;
  }
  if (!input.closed) {
    run.warn("the surface is open and its gaps are too wide to close: the result follows both of its sides, about " +
             thickness + " apart; --close-gaps may close it");
    return;
  }
  if (is_needle(p)) {
    run.warn("the surface is a needle, far thinner than its edges are long: its walls were grown to " + thickness +
             "; with more --vertices they stay thinner");
    return;
  }
  run.warn(std::to_string(input.components) + " components and " + std::to_string(input.genus) +
           " handles are more than so few vertices can show: hollows and gaps below " +
           length_text(2 * p.closing_vox * voxel) + " were closed and walls grown to at least " + thickness +
           "; ask for about " + std::to_string(vertices_for_parts(input)) +
           " --vertices, or, of a volume, for another --iso");
}

}  // namespace

bool shows_all_parts(int64_t vertices, const InputTopology& input) { return vertices >= vertices_for_parts(input); }

bool shows_most_handles(int64_t vertices, const InputTopology& input) {
  if (!input.closed || !input.oriented || shows_all_parts(vertices, input)) return true;
  return vertices >= 2 * kFewestVerticesPerPart * input.genus;
}

bool has_room_for_parts(int64_t vertices, const InputTopology& input) {
  return vertices >= kFewestVerticesPerHandle * (input.components + std::max<int64_t>(0, input.genus));
}

bool is_needle(const PreparedSurface& p) {
  const double area = area_vox(p);
  return area > 0 && area < kLeastCellVox * double(p.target_of_input.vertices);
}

int64_t smallest_component_q16(const PreparedSurface& p) {
  const InputTopology& input = p.surface.topology;
  const int64_t vertices = p.target_of_input.vertices;
  if (input.closed && input.oriented && shows_all_parts(vertices, input)) return 0;
  return is_needle(p) ? 0 : int64_t(4 * area_vox(p) / double(std::max<int64_t>(64, vertices)) * 65536);
}

void warn_of_topology(const PreparedSurface& p, const InputTopology& input, Run& run) {
  const SheetReport& sheet = p.report.sheet;
  if (p.grown) warn_of_grown_solid(p, input, run);
  if (p.grown && !p.grown.only_flaps) return;  // all of the solid is another one than the input's
  if (input.closed && sheet.topology.components < input.components &&
      !shows_all_parts(p.target_of_input.vertices, input))
    run.warn(std::to_string(input.components) +
             " components and their handles are more than so few vertices can show: those smaller "
             "than four cells were left out, " +
             std::to_string(sheet.topology.components) + " stay; ask for more --vertices");
  else if (sheet.is_compared && !sheet.agrees)
    run.warn("the solid has " + counted(sheet.topology.components, "component") + " and genus " +
             std::to_string(sheet.topology.genus) + ", the input " + std::to_string(input.components) + " and " +
             std::to_string(input.genus) + "; a higher --resolution may tell near parts apart");
}

}  // namespace isoshell
