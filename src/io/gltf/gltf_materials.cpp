#include "io/gltf/gltf_materials.h"

#include <set>

#include "io/gltf/gltf_uri.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

using Json = GltfDocument::Json;
using OrderedJson = nlohmann::ordered_json;

constexpr const char* kUsed = "extensionsUsed";
constexpr const char* kRequired = "extensionsRequired";
constexpr const char* kMimeType = "mimeType";

/// All names in objects "extensions" of a value; documents are not nested deeply.
void collect_extensions(const Json& value, std::set<std::string>& names) {
  if (!value.is_structured()) return;
  for (const auto& [key, part] : value.items()) {
    if (key == "extensions" && part.is_object())
      for (const auto& extension : part.items()) names.insert(extension.key());
    collect_extensions(part, names);
  }
}

/// An image in a buffer view gets a uri that holds it.
void free_of_buffers(const GltfDocument& document, const std::string& place, Json& image) {
  if (!image.is_object()) document.refuse(place, " is no object; restore the file");
  const auto view = document.integer(image, "bufferView", place);
  if (!view) return;
  const View<const char> bytes = document.bytes_of_view(*view, place + ".bufferView");
  const auto type = image.find(kMimeType);
  if (type == image.end() || !type->is_string())
    document.refuse(place, " is in a buffer view and has no mimeType; restore the file");
  document.source().take(3 * bytes.size);  // as text, here and in what is kept
  image["uri"] = "data:" + type->get<std::string>() + ";base64," + base64_of(bytes);
  image.erase("bufferView");
}

bool is_name_alone(const Json& material) {
  return material.empty() || (material.size() == 1 && material.count("name"));
}

/// An image that a uri holds gets a buffer view.
void put_image(OrderedJson& image, OrderedJson& views, std::vector<char>& bytes) {
  const auto uri = image.find("uri");
  if (uri == image.end() || !uri->is_string()) return;
  const std::string text = *uri, start = "data:";
  const std::string type = text.substr(std::min(start.size(), text.size()), text.find(';') - start.size());
  const std::optional<std::vector<char>> decoded = decoded_data(text);
  if (text.rfind(start, 0) != 0 || type.empty() || !decoded)
    return;  // a file, or nothing that would be better elsewhere
  image.erase("uri");
  image["bufferView"] = views.size();
  image[kMimeType] = type;
  views.push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", decoded->size()}});
  bytes.insert(bytes.end(), decoded->begin(), decoded->end());
  bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
}

}  // namespace

std::string gltf_materials_of(const GltfDocument& document) {
  const Json& materials = document.list(document.json(), "materials");
  if (std::all_of(materials.begin(), materials.end(), is_name_alone)) return "";
  Json all = {{"materials", materials}};
  for (const char* key : {"textures", "samplers", "images"})
    if (const Json& list = document.list(document.json(), key); !list.empty()) all[key] = list;
  if (all.contains("images"))
    for (size_t i = 0; i < all["images"].size(); ++i)
      free_of_buffers(document, "images[" + std::to_string(i) + "]", all["images"][i]);
  std::set<std::string> extensions;
  collect_extensions(all, extensions);
  if (!extensions.empty()) all[kUsed] = extensions;
  for (const Json& name : document.list(document.json(), kRequired))
    if (extensions.count(name.get<std::string>())) all[kRequired].push_back(name);
  return all.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void put_gltf_materials(const std::string& text, const std::vector<std::string>& names, OrderedJson& document,
                        std::vector<char>& bytes) {
  if (text.empty()) {
    for (const std::string& name : names) document["materials"].push_back({{"name", name}});
    return;
  }
  const OrderedJson all = OrderedJson::parse(text, nullptr, false);
  if (!all.is_object() || !all.contains("materials") || all["materials"].size() != names.size())
    throw Error(ErrorCode::usage, "write_mesh",
                "gltf_materials is no JSON object with a list of " + std::to_string(names.size()) +
                    " materials, one for each label; leave it empty to write names alone");
  for (const auto& [key, list] : all.items()) document[key] = list;
  if (document.contains("images"))
    for (OrderedJson& image : document["images"]) put_image(image, document["bufferViews"], bytes);
}

}  // namespace isoshell
