// Which attributes of an input a run keeps.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/message.h"
#include "isoshell/run/record.h"
#include "isoshell/sizing.h"

namespace isoshell {

/// Leaves the input those attributes that were asked for (all without a list) and that files of `format` hold (all when
/// it is empty), and the names of the files that they speak of. The others are dropped in the report, with a note each,
/// or a warning when they were asked for by name; a warning, too, when an input that is no mesh has nothing of that
/// name, and when the result `has_regions` that files of `format` do not hold. Throws: usage for a name that a mesh
/// does not have, which lists what it has.
void choose_attributes(Input& input, const std::optional<std::vector<std::string>>& names, const std::string& format,
                       bool has_regions, AttributeReport& report, const Tell& tell);

/// Leaves the names of files alone: of a surface that is prepared nothing else is looked for any more.
void free_all_but_files(TriangleSoup& soup);

/// The sizing field that --sizing names: of a .vdb file, or an attribute of the input's vertices, chosen or not.
/// Throws: as read_sizing and sizing_of_attribute do.
std::shared_ptr<const SizingField> sizing_of_input(const Input& input, const std::string& text, const Context& context);

}  // namespace isoshell
