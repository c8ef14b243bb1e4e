#include "run/choose_attributes.h"

#include <algorithm>

#include "isoshell/error.h"
#include "isoshell/io/file_format.h"
#include "isoshell/io/sizing_vdb.h"

namespace isoshell {
namespace {

using Names = std::vector<std::string>;

bool has(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string listed(const Names& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

/// Of those that are kept.
AttributeFiles files_of(const std::vector<Attribute>& kept, AttributeFiles all, const std::string& format) {
  const auto keeps = [&](const char* name) {
    return std::any_of(kept.begin(), kept.end(), [&](const Attribute& a) { return a.name == name; });
  };
  const FileFormat* const file = find_format(format);
  if (!keeps(kMaterialName)) all.materials.clear();
  if (!keeps(kMaterialName) || !file || !file->holds_gltf_materials) all.gltf_materials.clear();
  if (!keeps(kUvName) || !file || !file->holds_textures) all.textures.clear();
  return all;
}

/// Of a mesh, the one place where a name can be mistyped.
void check_names(const InputFacts& facts, const TriangleSoup& soup, const Names& requested) {
  Names known;
  for (const Attribute& a : soup.attributes) known.push_back(a.name);
  for (const std::string& name : requested) {
    if (has(known, name)) continue;
    const auto dropped = std::find_if(soup.dropped_attributes.begin(), soup.dropped_attributes.end(),
                                      [&](const DroppedAttribute& d) { return d.name == name; });
    throw Error(ErrorCode::usage, "options",
                "--attributes names '" + name + "', " +
                    (dropped == soup.dropped_attributes.end() ? "which " + facts.name() + " does not have"
                                                              : "but " + dropped->reason) +
                    "; it has: " + listed(known));
  }
}

/// Regions are no attribute: walls between them stay, but which of them a face parts is lost.
void warn_of_lost_regions(const Input& input, const std::string& format, const Tell& tell) {
  const FileFormat* const file = find_format(format);
  if (!tell || !file || !file->writes_mesh || file->holds_regions) return;
  tell(MessageKind::warning, input.facts.name() + ": " + format +
                                 " files do not say which regions a face parts; those of " +
                                 listed_formats([](const FileFormat& f) { return f.holds_regions; }) + " do");
}

}  // namespace

void choose_attributes(Input& input, const std::optional<Names>& names, const std::string& format, bool has_regions,
                       AttributeReport& report, const Tell& tell) {
  TriangleSoup& soup = input.soup;
  if (names && input.facts.kind == InputKind::mesh)
    check_names(input.facts, soup, *names);
  else if (names && !names->empty() && tell)
    tell(MessageKind::warning, input.facts.name() + ": --attributes keeps what a mesh has beside its positions; of " +
                                   "clouds, volumes and stage files there is nothing");
  report.dropped = std::move(soup.dropped_attributes);
  std::vector<Attribute> chosen;
  for (Attribute& a : soup.attributes) {
    const std::string reason = names && !has(*names, a.name) ? "not asked for" : why_not_held(format, a);
    if (!reason.empty()) {
      report.dropped.push_back({a.name, reason});
      continue;
    }
    report.kept.push_back(a.name);
    chosen.push_back(std::move(a));
  }
  soup.attributes = std::move(chosen);
  soup.files = files_of(soup.attributes, std::move(soup.files), format);
  if (tell && !report.kept.empty()) tell(MessageKind::note, input.facts.name() + ": kept: " + listed(report.kept));
  for (const DroppedAttribute& d : report.dropped)
    if (tell)
      tell(names && has(*names, d.name) ? MessageKind::warning : MessageKind::note,
           input.facts.name() + ": " + d.name + " dropped: " + d.reason);
  if (has_regions) warn_of_lost_regions(input, format, tell);
}

void free_all_but_files(TriangleSoup& soup) {
  AttributeFiles files = std::move(soup.files);
  (soup = {}).files = std::move(files);
}

std::shared_ptr<const SizingField> sizing_of_input(const Input& input, const std::string& text,
                                                   const Context& context) {
  return is_sizing_file(text) ? read_sizing(text, context.memory_limit_bytes)
                              : sizing_of_attribute(input.soup, text, input.facts.name());
}

}  // namespace isoshell
