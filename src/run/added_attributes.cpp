// See added_attributes.h.
#include "run/added_attributes.h"

#include <algorithm>
#include <cstring>
#include <set>

#include "isoshell/error.h"
#include "isoshell/io/file_format.h"

namespace isoshell {
namespace {

constexpr const char* kBornName = "born";
constexpr const char* kMotionNames[3] = {"vx", "vy", "vz"};
constexpr const char* kColorGrids[] = {"Cd", kColorName};
constexpr const char* kTakenNames[] = {"gap", "x",  "y",  "z",
                                       "vx",  "vy", "vz", "born"};  // by other numbers of a vertex in files

bool is_name_of_motion(const Attribute& attribute) {
  const auto is_it = [&](const char* name) { return attribute.name == name; };
  return is_it(kBornName) || std::any_of(std::begin(kMotionNames), std::end(kMotionNames), is_it);
}

bool is_one_of(const std::string& name, const char* const* begin, const char* const* end) {
  return std::any_of(begin, end, [&](const char* one) { return name == one; });
}

/// A word, as some files need it.
std::string word_of(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return std::strchr(" \t\r\n", c) != nullptr; }, '_');
  return name;
}

bool is_color(const Attribute& a) {
  return a.components == 3 && a.type != NumberType::i32 &&
         is_one_of(a.name, std::begin(kColorGrids), std::end(kColorGrids));
}

/// As formats hold them: a number each, but for colours.
std::vector<Attribute> attributes_of(Attribute values) {
  if (is_color(values)) {
    values.name = kColorName;
    return {std::move(values)};
  }
  values.name = word_of(values.name);
  if (values.components == 1) {
    if (meaning_of(values.name) || is_one_of(values.name, std::begin(kTakenNames), std::end(kTakenNames)))
      values.name += "_";
    return {std::move(values)};
  }
  const auto count = size_t(values.components);
  std::vector<Attribute> parts(count);
  for (size_t i = 0; i < count; ++i) {
    parts[i] = {values.name + "." + std::to_string(i), values.type, 1, {}};
    for (size_t k = i; k < values.values.size(); k += count) parts[i].values.push_back(values.values[k]);
  }
  return parts;
}

/// In place of those of its name.
void put(Attribute attribute, const std::string& grid, TriangleMesh& mesh, AttributeReport& report) {
  std::vector<Attribute>& all = mesh.attributes;
  const auto has_its_name = [&](const Attribute& a) { return a.name == attribute.name; };
  if (std::any_of(all.begin(), all.end(), has_its_name)) {
    all.erase(std::remove_if(all.begin(), all.end(), has_its_name), all.end());
    report.kept.erase(std::remove(report.kept.begin(), report.kept.end(), attribute.name), report.kept.end());
    report.dropped.push_back({attribute.name, "the grid " + grid + " has its place"});
  }
  all.push_back(std::move(attribute));
}

/// Names of grids by their files, in the order in which these are named.
std::vector<std::pair<std::string, std::vector<std::string>>> grids_by_file(const std::vector<std::string>& names) {
  std::vector<std::pair<std::string, std::vector<std::string>>> files;
  for (const std::string& name : names) {
    const GridName named = grid_name_of(name);
    if (named.file.empty()) continue;
    auto found = std::find_if(files.begin(), files.end(), [&](const auto& file) { return file.first == named.file; });
    if (found == files.end()) found = files.insert(found, {named.file, {}});
    found->second.push_back(named.grid);
  }
  return files;
}

[[noreturn]] void refuse_use(const std::string& message) { throw Error(ErrorCode::usage, "grids", message); }

}  // namespace

void add_motion_attributes(const PreviousFrame& previous, TriangleMesh& mesh) {
  std::vector<Attribute>& all = mesh.attributes;
  all.erase(std::remove_if(all.begin(), all.end(), is_name_of_motion), all.end());
  const std::vector<uint8_t> born = born_vertices(previous, mesh);
  all.push_back({kBornName, NumberType::u8, 1, std::vector<double>(born.begin(), born.end())});
  for (int axis = 0; axis < 3; ++axis) {
    const auto along = [=](const WorldPoint& p) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; };
    std::vector<double> motion(mesh.vertices.size(), 0);
    for (size_t v = 0; v < motion.size(); ++v)
      if (!born[v]) motion[v] = along(mesh.vertices[v]) - along(previous.vertices[v]);
    all.push_back({kMotionNames[axis], NumberType::f32, 1, std::move(motion)});
  }
}

void read_other_grids(const InputRequest& request, Input& input, const Context& context) {
  const std::vector<std::string>& names = request.grids;
  const auto own =
      std::find_if(names.begin(), names.end(), [](const std::string& name) { return grid_name_of(name).file.empty(); });
  if (own != names.end() && !input.grids)
    refuse_use("--grids names '" + *own + "', and " + input.facts.name() +
               " is no volume of a .vdb file; name a grid of a file, as FILE.vdb:NAME");
  const auto files = grids_by_file(names);
  if (!input.grids && (!files.empty() || !request.given_grids.empty())) input.grids.emplace();
  const auto add = [&](const std::shared_ptr<const GridField>& field) {
    const auto has_its_name = [&](const auto& other) { return other->name() == field->name(); };
    if (std::any_of(input.grids->begin(), input.grids->end(), has_its_name))
      refuse_use("--grids names two grids '" + field->name() + "', whose values would have one name; leave one out");
    input.grids->push_back(field);
  };
  for (const auto& [file, grids] : files)
    for (const auto& field : read_grid_fields(file, grids, context.memory_limit_bytes)) add(field);
  for (const auto& field : request.given_grids) add(field);
}

void add_grid_attributes(const Input& input, const std::string& format, TriangleMesh& mesh, AttributeReport& report,
                         const Tell& tell) {
  const auto warn = [&](const std::string& text) {
    if (tell) tell(MessageKind::warning, input.facts.name() + ": grid " + text);
  };
  std::set<std::string> placed;  // names that have a grid's values
  for (const auto& grid : *input.grids) {
    GridValues found = grid->at(mesh.vertices);
    std::vector<Attribute> attributes = attributes_of(std::move(found.values));
    if (const std::string reason = why_not_held(format, attributes.front()); !reason.empty()) {
      report.dropped.push_back({grid->name(), reason});
      warn(grid->name() + " dropped: " + reason);
      continue;
    }
    if (found.outside == int64_t(mesh.vertices.size()))
      warn(grid->name() + " has no active voxel at any vertex: all have its background; see where it stands");
    SampledGrid& added = report.grids.emplace_back(SampledGrid{grid->name(), {}, found.outside});
    for (Attribute& attribute : attributes) {
      if (!placed.insert(attribute.name).second) {
        warn(grid->name() + " is left out: another grid has the name " + attribute.name +
             " already; ask for one of them");
        report.dropped.push_back({attribute.name, "another grid than " + grid->name() + " has its place"});
        continue;
      }
      added.attributes.push_back(attribute.name);
      put(std::move(attribute), grid->name(), mesh, report);
    }
  }
}

}  // namespace isoshell
