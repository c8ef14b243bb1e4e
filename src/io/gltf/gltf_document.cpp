#include "io/gltf/gltf_document.h"

#include <cstring>
#include <filesystem>

#include "core/number_type.h"
#include "io/bytes/byte_order.h"
#include "io/gltf/gltf_uri.h"
#include "io/gltf/json_size.h"

namespace isoshell {
namespace {

namespace fs = std::filesystem;
using Json = GltfDocument::Json;

constexpr int64_t kHeaderBytes = 12, kChunkHeaderBytes = 8, kLeastBytes = kHeaderBytes + kChunkHeaderBytes;
constexpr uint32_t kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;
constexpr int64_t kLargestStride = 252;
constexpr int kMostNesting = 256;                      // deeper values could exhaust the stack where they are copied
constexpr size_t kMostMessage = 200;                   // of a message that may cite the file
constexpr int64_t kLargestInteger = int64_t(1) << 53;  // that JSON readers agree on; sums of a few do not overflow

std::string short_dump(const Json& value) {
  std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > 40) text = text.substr(0, 40) + "...";
  return text;
}

int32_t components_of(const std::string& type) {
  if (type == "SCALAR") return 1;
  const int32_t n = type.size() == 4 && type[3] >= '2' && type[3] <= '4' ? type[3] - '0' : 0;
  if (type.compare(0, 3, "VEC") == 0) return n;
  if (type.compare(0, 3, "MAT") == 0) return n * n;  // the padding of columns does not matter: no matrix is read
  return 0;
}

std::optional<NumberType> type_of(int64_t code) {
  switch (code) {
    case 5120:
      return NumberType::i8;
    case 5121:
      return NumberType::u8;
    case 5122:
      return NumberType::i16;
    case 5123:
      return NumberType::u16;
    case 5125:
      return NumberType::u32;
    case 5126:
      return NumberType::f32;
    default:
      return {};
  }
}

/// Extensions that change neither shapes nor how they are stored, and those that unpack() understands.
bool is_understood(const std::string& extension) {
  for (const char* name : {"KHR_mesh_quantization", "KHR_draco_mesh_compression", "EXT_meshopt_compression"})
    if (extension == name) return true;
  for (const char* start :
       {"KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_", "KHR_lights_", "EXT_lights_", "KHR_xmp"})
    if (extension.rfind(start, 0) == 0) return true;
  return false;
}

/// A buffer of EXT_meshopt_compression that need not be in the file.
bool is_mere_place(const Json& buffer) {
  static const Json::json_pointer fallback("/extensions/EXT_meshopt_compression/fallback");
  return buffer.contains(fallback) && buffer[fallback] == true;
}

}  // namespace

int64_t bytes_of(NumberType type) {
  return with_type(type, [](auto number) { return int64_t(sizeof(number)); });
}

GltfDocument::GltfDocument(const MeshSource& source) : source_(source) {
  read_container();
  if (!json_.is_object()) source_.refuse("its JSON is not an object; it is no glTF file");
  check_version();
  check_extensions();
  read_buffers();
}

void GltfDocument::read_container() {
  View<const char> text{source_.begin(), source_.size()};
  if (text.size >= 4 && std::memcmp(text.data, "glTF", 4) == 0) {
    const auto least = [&](int64_t bytes, const char* what) {
      if (bytes < kLeastBytes)
        source_.refuse(what + std::to_string(bytes) + " bytes; a .glb file has at least " +
                       std::to_string(kLeastBytes) + ", restore it");
    };
    least(text.size, "has ");
    const uint32_t version = load_little_endian<uint32_t>(text.data + 4);
    if (version != 2) source_.refuse_byte(4, "glTF version " + std::to_string(version) + "; only 2 can be read");
    const int64_t end = load_little_endian<uint32_t>(text.data + 8);
    least(end, "promises ");
    if (end > text.size)
      source_.refuse_byte(8, "the header promises " + std::to_string(end) + " bytes; the file has " +
                                 std::to_string(text.size) + "; it is truncated, restore it");
    surplus_bytes_ = text.size - end;
    const char* const start = source_.begin();
    for (int64_t at = kHeaderBytes; at < end;) {
      const bool is_first = at == kHeaderBytes;
      const int64_t bytes = end - at < kChunkHeaderBytes ? -1 : int64_t(load_little_endian<uint32_t>(start + at));
      if (bytes < 0 || bytes > end - at - kChunkHeaderBytes)
        source_.refuse_byte(at, "a chunk of " + std::to_string(bytes) + " bytes begins here; " +
                                    std::to_string(end - at) + " bytes are left; restore the file");
      const uint32_t kind = load_little_endian<uint32_t>(start + at + 4);
      const View<const char> body{start + at + kChunkHeaderBytes, bytes};
      if (is_first != (kind == kJsonChunk))
        source_.refuse_byte(at, "the first chunk, and no other, must be JSON; restore the file");
      if (is_first) text = body;
      if (kind == kBinaryChunk && !chunk_) chunk_ = body;
      at += kChunkHeaderBytes + bytes;
    }
  }
  const JsonSize size = json_size_of(text, kMostNesting);
  if (size.depth > kMostNesting)
    source_.refuse("its JSON is nested more than " + std::to_string(kMostNesting) + " deep, the most that is read");
  source_.take(size.bytes);
  try {
    json_ = Json::parse(text.data, text.data + text.size);
  } catch (const Json::exception& error) {
    source_.refuse("its JSON cannot be read: " + std::string(error.what()).substr(0, kMostMessage));
  }
}

void GltfDocument::check_version() {
  const auto asset = json_.find("asset");
  const bool is_there = asset != json_.end() && asset->is_object() && asset->contains("version");
  const Json version = is_there ? (*asset)["version"] : Json();
  if (!version.is_string() || version.get_ref<const std::string&>().rfind("2.", 0) != 0)
    source_.refuse("asset.version is " + short_dump(version) + "; only glTF 2 can be read");
  if (asset->contains("minVersion") && (*asset)["minVersion"] != "2.0")
    source_.refuse("asset.minVersion is " + short_dump((*asset)["minVersion"]) + "; only glTF 2.0 can be read");
}

void GltfDocument::check_extensions() const {
  for (const Json& name : list(json_, "extensionsRequired")) {
    if (name.is_string() && is_understood(name.get_ref<const std::string&>())) continue;
    source_.refuse("extensionsRequired names " + short_dump(name) +
                   ", which is not read; write the file without that extension");
  }
}

bool GltfDocument::requires_extension(const std::string& name) const {
  const Json& names = list(json_, "extensionsRequired");
  return std::find(names.begin(), names.end(), name) != names.end();
}

const Json& GltfDocument::list(const Json& object, const char* key, const std::string& place) const {
  static const Json none = Json::array();
  const auto at = object.find(key);
  if (at == object.end()) return none;
  if (!at->is_array())
    refuse(place.empty() ? key : place + "." + key, " is " + short_dump(*at) + "; it must be a list");
  return *at;
}

const Json& GltfDocument::element(const char* array, int64_t index, const std::string& from) const {
  const Json& all = list(json_, array);
  if (index >= int64_t(all.size()))
    refuse(from, " is " + std::to_string(index) + "; the file has " + std::to_string(all.size()) + " " + array);
  const Json& found = all[size_t(index)];
  if (!found.is_object())
    refuse(std::string(array) + "[" + std::to_string(index) + "]",
           " is " + short_dump(found) + "; it must be an object");
  return found;
}

std::optional<int64_t> GltfDocument::integer(const Json& object, const char* key, const std::string& place) const {
  const auto at = object.find(key);
  if (at == object.end()) return {};
  if (!at->is_number_unsigned() || at->get<uint64_t>() > uint64_t(kLargestInteger))
    refuse(place + "." + key, " is " + short_dump(*at) + "; it must be a whole number from 0 to 2^53");
  return at->get<int64_t>();
}

int64_t GltfDocument::needed_integer(const Json& object, const char* key, const std::string& place) const {
  const std::optional<int64_t> value = integer(object, key, place);
  if (!value) refuse(place, std::string(" has no ") + key);
  return *value;
}

bool GltfDocument::numbers(const Json& object, const char* key, const std::string& place, double* values,
                           size_t count) const {
  const auto at = object.find(key);
  if (at == object.end()) return false;
  bool is_sound = at->is_array() && at->size() == count;
  for (size_t i = 0; is_sound && i < count; ++i) {
    is_sound = (*at)[i].is_number();
    if (is_sound) values[i] = (*at)[i].get<double>();
  }
  if (!is_sound)
    refuse(place + "." + key, " is " + short_dump(*at) + "; it must be " + std::to_string(count) + " numbers");
  return true;
}

void GltfDocument::read_buffers() {
  const Json& all = list(json_, "buffers");
  for (size_t i = 0; i < all.size(); ++i) {
    const std::string place = "buffers[" + std::to_string(i) + "]";
    const Json& buffer = element("buffers", int64_t(i), place);
    const int64_t bytes = needed_integer(buffer, "byteLength", place);
    const auto uri = buffer.find("uri");
    View<const char> data{nullptr, 0};
    if (uri != buffer.end()) {
      if (!uri->is_string()) refuse(place + ".uri", " is " + short_dump(*uri) + "; it must be a text");
      data = bytes_of_uri(uri->get_ref<const std::string&>(), place + ".uri");
    } else if (i == 0 && chunk_) {
      data = *chunk_;
    } else if (is_mere_place(buffer)) {
      buffers_.push_back(data);
      continue;
    } else {
      refuse(place, " has no uri, and the file no binary chunk for it");
    }
    if (bytes > data.size)
      refuse(place + ".byteLength", " is " + std::to_string(bytes) + "; its data have " + std::to_string(data.size) +
                                        " bytes; restore the file");
    buffers_.push_back({data.data, bytes});
    bytes_ += bytes;
  }
}

View<const char> GltfDocument::bytes_of_uri(const std::string& uri, const std::string& place) {
  if (uri.rfind("data:", 0) == 0) {
    source_.take(int64_t(uri.size()) / 4 * 3);
    std::optional<std::vector<char>> decoded = decoded_data(uri);
    if (!decoded) refuse(place, " is not sound base64 data; restore the file");
    decoded_.push_back(std::move(*decoded));
    return {decoded_.back().data(), int64_t(decoded_.back().size())};
  }
  const std::optional<std::string> name = file_name_of(uri);
  if (!name)
    refuse(place, " is " + short_dump(uri) + "; only files in the folder of the glTF file, or below it, are read");
  const fs::path folder = fs::path(source_.name()).parent_path();
  const fs::path path = folder / *name;
  std::error_code code;
  if (!fs::is_regular_file(path, code)) refuse(place, " names " + path.string() + ", where there is no file");
  if (!lies_below(folder.string(), path.string()))
    refuse(place, " names " + path.string() + ", which leads by a link to " + fs::canonical(path, code).string() +
                      "; only files in the folder of the glTF file, or below it, are read; copy it there");
  files_.push_back(std::make_unique<MeshSource>(path.string(), source_.budget()));
  return {files_.back()->begin(), files_.back()->size()};
}

View<const char> GltfDocument::bytes_of_view(int64_t index, const std::string& from) const {
  return bytes_in_buffer(element("bufferViews", index, from), "bufferViews[" + std::to_string(index) + "]");
}

View<const char> GltfDocument::bytes_in_buffer(const Json& object, const std::string& place) const {
  const int64_t number = needed_integer(object, "buffer", place);
  element("buffers", number, place + ".buffer");
  const View<const char> buffer = buffers_[size_t(number)];
  const int64_t offset = integer(object, "byteOffset", place).value_or(0),
                bytes = needed_integer(object, "byteLength", place);
  if (offset + bytes > buffer.size)
    refuse(place, " ends at byte " + std::to_string(offset + bytes) + "; buffers[" + std::to_string(number) + "] has " +
                      std::to_string(buffer.size) + " bytes");
  return {buffer.data + offset, bytes};
}

bool GltfDocument::has_data(int64_t buffer) const {
  return buffer < int64_t(buffers_.size()) && buffers_[size_t(buffer)].data;
}

size_t GltfDocument::add_buffer(std::vector<char> bytes) {
  const auto size = int64_t(bytes.size());
  decoded_.push_back(std::move(bytes));
  buffers_.push_back({decoded_.back().data(), size});
  bytes_ += size;
  json_["buffers"].push_back({{"byteLength", size_t(size)}});
  return buffers_.size() - 1;
}

void GltfDocument::place_elements(const Json& object, int64_t view, bool packed, GltfElements& e) const {
  const View<const char> bytes = bytes_of_view(view, e.place + ".bufferView");
  const std::string place = "bufferViews[" + std::to_string(view) + "]";
  const int64_t size = bytes_of(e.type) * e.components;
  const int64_t offset = integer(object, "byteOffset", e.place).value_or(0);
  const auto stride = integer(json_["bufferViews"][size_t(view)], "byteStride", place);
  e.stride = packed ? size : stride.value_or(size);
  if (e.stride < size || e.stride > std::max(kLargestStride, size))
    refuse(place + ".byteStride", " is " + std::to_string(e.stride) + "; it must be from " + std::to_string(size) +
                                      ", the bytes of an element of " + e.place + ", to " +
                                      std::to_string(kLargestStride));
  const int64_t room = bytes.size - offset;
  if (e.count > 0 && (room < size || e.count - 1 > (room - size) / e.stride))
    refuse(e.place, " has " + std::to_string(e.count) + " elements of " + std::to_string(size) + " bytes, " +
                        std::to_string(e.stride) + " apart, from byte " + std::to_string(offset) + " on; " + place +
                        " has " + std::to_string(bytes.size) + " bytes");
  if (e.count > 0) e.data = bytes.data + offset;
}

GltfAccessor GltfDocument::described(int64_t index, const std::string& from) const {
  const Json& object = element("accessors", index, from);
  GltfAccessor a;
  a.place = "accessors[" + std::to_string(index) + "]";
  a.count = needed_integer(object, "count", a.place);
  const int64_t code = needed_integer(object, "componentType", a.place);
  const std::optional<NumberType> type = type_of(code);
  if (!type)
    refuse(a.place + ".componentType", " is " + std::to_string(code) + "; it must be 5120 to 5123, 5125 or 5126");
  a.type = *type;
  const Json shape = object.value("type", Json());
  a.components = shape.is_string() ? components_of(shape.get_ref<const std::string&>()) : 0;
  if (a.components == 0)
    refuse(a.place + ".type", " is " + short_dump(shape) + "; it must be SCALAR, VEC2 to VEC4 or MAT2 to MAT4");
  const Json normalized = object.value("normalized", Json(false));
  a.normalized = normalized.is_boolean() && normalized.get<bool>() && a.type != NumberType::f32;
  return a;
}

GltfAccessor GltfDocument::accessor(int64_t index, const std::string& from) const {
  GltfAccessor a = described(index, from);
  const Json& object = json_["accessors"][size_t(index)];
  if (const std::optional<int64_t> view = integer(object, "bufferView", a.place))
    place_elements(object, *view, false, a);
  else if (a.count > bytes_)
    refuse(a.place + ".count", " is " + std::to_string(a.count) + " without a buffer view; at most " +
                                   std::to_string(bytes_) +
                                   ", the bytes of all buffers, is read, and nothing that an extension packs");
  const auto sparse = object.find("sparse");
  if (sparse != object.end()) read_sparse(*sparse, a);
  return a;
}

int64_t GltfDocument::claimed_count(int64_t index) const {
  const Json& all = list(json_, "accessors");
  if (index >= int64_t(all.size()) || !all[size_t(index)].is_object()) return 0;
  const auto count = all[size_t(index)].find("count");
  const bool is_number = count != all[size_t(index)].end() && count->is_number_unsigned();
  return is_number ? int64_t(std::min(count->get<uint64_t>(), uint64_t(bytes_))) : 0;
}

void GltfDocument::read_sparse(const Json& sparse, GltfAccessor& a) const {
  const std::string place = a.place + ".sparse";
  if (!sparse.is_object()) refuse(place, " is " + short_dump(sparse) + "; it must be an object");
  const int64_t count = needed_integer(sparse, "count", place);
  const auto part = [&](const char* key, GltfElements& e) {
    const auto at = sparse.find(key);
    e.place = place + "." + key;
    if (at == sparse.end() || !at->is_object()) refuse(e.place, " is missing, or no object");
    e.count = count;
    if (&e == &a.replaced) {
      const std::optional<NumberType> type = type_of(needed_integer(*at, "componentType", e.place));
      if (!type || (*type != NumberType::u8 && *type != NumberType::u16 && *type != NumberType::u32))
        refuse(e.place + ".componentType",
               " is " + short_dump((*at)["componentType"]) + "; it must be 5121, 5123 or 5125");
      e.type = *type;
    }
    place_elements(*at, needed_integer(*at, "bufferView", e.place), true, e);
  };
  a.replacements.type = a.type;
  a.replacements.components = a.components;
  part("indices", a.replaced);
  part("values", a.replacements);
}

}  // namespace isoshell
