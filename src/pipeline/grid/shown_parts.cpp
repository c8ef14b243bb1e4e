#include "pipeline/grid/shown_parts.h"

#include <algorithm>
#include <sstream>

#include "pipeline/grid/choose_grid.h"

namespace isoshell {
namespace {

constexpr int64_t kFewestVerticesPerPart = 24;

int64_t vertices_for_parts(const InputTopology& input) {
  return kFewestVerticesPerPart * (input.components + std::max<int64_t>(0, input.genus));
}

std::string length_text(double world) {
  std::ostringstream text;
  text << world;
  return text.str();
}

void warn_of_grown_solid(const Prepared& p, const InputTopology& input, RemeshReport& report) {
  const double voxel = p.surface.frame.voxel_size;
  const std::string thickness = length_text((2 * p.grown.distance_vox + 1) * voxel);
  if (p.grown.only_flaps) {
    report.warnings.push_back(
        "parts of the surface are open and bound nothing: the result follows both of their sides, about " + thickness +
        " apart");
    return;
  }
  if (!input.closed) {
    report.warnings.push_back(
        "the surface is open and its gaps are too wide to close: the result follows both of its sides, about " +
        thickness + " apart; --close-gaps may close it");
    return;
  }
  report.warnings.push_back(std::to_string(input.components) + " components and " + std::to_string(input.genus) +
                            " handles are more than so few vertices can show: hollows and gaps below " +
                            length_text(2 * p.closing_vox * voxel) + " were closed and walls grown to at least " +
                            thickness + "; ask for about " + std::to_string(vertices_for_parts(input)) +
                            " --vertices, or, of a volume, for another --iso");
}

}  // namespace

bool shows_all_parts(const RemeshOptions& options, const InputTopology& input) {
  return vertex_target(options, input.area_world) >= vertices_for_parts(input);
}

bool shows_most_handles(const RemeshOptions& options, const InputTopology& input) {
  if (!input.closed || !input.oriented || shows_all_parts(options, input)) return true;
  return vertex_target(options, input.area_world) >= 2 * kFewestVerticesPerPart * input.genus;
}

int64_t smallest_component_q16(const RemeshOptions& options, const InputTopology& input, const LatticeFrame& frame) {
  if (input.closed && input.oriented && shows_all_parts(options, input)) return 0;
  const double cell_world = input.area_world / double(std::max<int64_t>(64, vertex_target(options, input.area_world)));
  const double cell_vox = cell_world / (frame.voxel_size * frame.voxel_size);
  return int64_t(4 * cell_vox * 65536);
}

void warn_of_topology(const Prepared& p, const InputTopology& input, const RemeshOptions& options,
                      RemeshReport& report) {
  if (p.grown) warn_of_grown_solid(p, input, report);
  if (p.grown && !p.grown.only_flaps) return;  // all of the solid is another one than the input's
  if (input.closed && report.sheet.components < input.components && !shows_all_parts(options, input))
    report.warnings.push_back(std::to_string(input.components) +
                              " components and their handles are more than so few vertices can show: those smaller "
                              "than four cells were left out, " +
                              std::to_string(report.sheet.components) + " stay; ask for more --vertices");
  else if (report.topology_compared && !report.topology_agrees)
    report.warnings.push_back("the solid has " + std::to_string(report.sheet.components) + " components and genus " +
                              std::to_string(report.sheet.genus) + ", the input " + std::to_string(input.components) +
                              " and " + std::to_string(input.genus) +
                              "; a higher --resolution may tell near parts apart");
}

}  // namespace isoshell
