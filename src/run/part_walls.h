// The walls between the parts of an input, which a run meshes in place of its faces.
#pragma once

#include <string>
#include <utility>

#include "isoshell/error.h"
#include "isoshell/io/input.h"
#include "isoshell/message.h"
#include "isoshell/part_regions.h"

namespace isoshell {

/// As find_part_regions() makes them; tells its warnings, and notes which there are.
/// Throws: as that, and usage for an input that is no mesh.
inline TriangleSoup walls_of_parts(const Input& input, const RemeshOptions& options, const Tell& tell,
                                   InputFacts& facts, Context& context) {
  const std::string asked = "--regions " + options.regions, name = input.facts.name();
  if (input.facts.kind != InputKind::mesh)
    throw Error(ErrorCode::usage, "options", asked + " is for meshes, and " + name + " is none; leave it out");
  if (!input.soup.regions.empty())
    throw Error(ErrorCode::usage, "options", asked + ": the faces of " + name + " part regions already; leave it out");
  PartRegions found = find_part_regions(input.soup, part_options(options, input.soup), context);
  if (tell)
    for (const std::string& text : found.warnings) tell(MessageKind::warning, name + ": " + text);
  facts.regions = regions_of_surface(found.walls);
  return std::move(found.walls);
}

}  // namespace isoshell
