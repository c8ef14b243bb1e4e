// See gltf_unpack.h.
#include "io/gltf/gltf_unpack.h"

#include <algorithm>

#include "core/number_type.h"
#include "core/parallel_ranges.h"
#include "io/gltf/gltf_codecs.h"

namespace isoshell {
namespace {

using Json = GltfDocument::Json;

constexpr const char* kMeshopt = "EXT_meshopt_compression";
constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr int64_t kMostMeshopt = 64;     // bytes of a byte: 2 bits say that 16 bytes are as those before them;
                                         // and of all buffers, as several views may be packed in the same bytes
constexpr int64_t kMostDraco = 1 << 14;  // of all buffers; flat grids reach some 700
constexpr double kDracoFactor = 4;       // of what comes out, while it is unpacked: the library's tables and values
constexpr uint32_t kTriangles = 4, kStrip = 5, kU32 = 5125;  // the reader takes what is unsigned alone

/// An extension of a part of the document; null without it.
const Json* extension_of(const GltfDocument& document, const Json& object, const char* name, const std::string& place) {
  const auto all = object.find("extensions");
  if (all == object.end() || !all->is_object() || !all->contains(name)) return nullptr;
  const Json& found = (*all)[name];
  if (!found.is_object()) document.refuse(place + ".extensions." + name, " is no object; restore the file");
  return &found;
}

/// The attributes of a primitive or of what Draco packed of it.
const Json& attributes_of(const GltfDocument& document, const Json& object, const std::string& place) {
  const auto at = object.find("attributes");
  if (at == object.end() || !at->is_object()) document.refuse(place, " has no attributes; restore the file");
  return *at;
}

std::string text_of(const Json& object, const char* key, const std::string& otherwise) {
  const auto at = object.find(key);
  if (at == object.end()) return otherwise;
  return at->is_string() ? at->get<std::string>() : "";
}

/// Calls `f` with the numbers of mesh and primitive, the primitive, and where it stands.
template <class F>
void for_each_primitive(const GltfDocument& document, F f) {
  const Json& meshes = document.list(document.json(), "meshes");
  for (size_t m = 0; m < meshes.size(); ++m) {
    const std::string in_list = "meshes[" + std::to_string(m) + "]";
    const Json& primitives = document.list(document.element("meshes", int64_t(m), in_list), "primitives", in_list);
    for (size_t i = 0; i < primitives.size(); ++i)
      if (primitives[i].is_object()) f(m, i, primitives[i], in_list + ".primitives[" + std::to_string(i) + "]");
  }
}

/// Marks the views that a value names at any depth. What is no number of a view is refused where it is read.
void mark_views(const Json& value, std::vector<bool>& is_used) {
  if (!value.is_structured()) return;
  for (const auto& item : value.items()) {
    const Json& number = item.value();
    if (item.key() == "bufferView" && number.is_number_unsigned() && number.get<uint64_t>() < is_used.size())
      is_used[number.get<size_t>()] = true;
    mark_views(number, is_used);
  }
}

/// Those of primitives and images: others, as those of animations, are not read and may be damaged.
std::vector<bool> used_views(const GltfDocument& document) {
  const Json &json = document.json(), &accessors = document.list(json, "accessors");
  std::vector<bool> is_used(document.list(json, "bufferViews").size());
  const auto mark_accessor = [&](const Json& number) {
    if (number.is_number_unsigned() && number.get<uint64_t>() < accessors.size())
      mark_views(accessors[number.get<size_t>()], is_used);
  };
  mark_views(document.list(json, "images"), is_used);
  for_each_primitive(document, [&](size_t, size_t, const Json& primitive, const std::string&) {
    if (primitive.contains("extensions")) mark_views(primitive["extensions"], is_used);
    if (primitive.contains("indices")) mark_accessor(primitive["indices"]);
    if (!primitive.contains("attributes")) return;
    for (const auto& attribute : primitive["attributes"].items()) mark_accessor(attribute.value());
  });
  return is_used;
}

/// `left`: how many bytes may be unpacked, this view's are taken off.
void unpack_view(GltfDocument& document, size_t index, bool is_required, int64_t& left) {
  const std::string in_list = "bufferViews[" + std::to_string(index) + "]";
  const Json& view = document.element("bufferViews", int64_t(index), in_list);
  const Json* const packed = extension_of(document, view, kMeshopt, in_list);
  if (!packed || (!is_required && document.has_data(document.needed_integer(view, "buffer", in_list)))) return;
  const std::string place = in_list + ".extensions." + kMeshopt;
  MeshoptView job{document.bytes_in_buffer(*packed, place),
                  document.needed_integer(*packed, "count", place),
                  document.needed_integer(*packed, "byteStride", place),
                  text_of(*packed, "mode", ""),
                  text_of(*packed, "filter", "NONE"),
                  {}};
  if (job.stride > 256 || job.count > kMostMeshopt * job.packed.size ||
      job.count * job.stride > kMostMeshopt * job.packed.size)
    document.refuse(place, " has " + std::to_string(job.packed.size) + " bytes for " + std::to_string(job.count) +
                               " elements of " + std::to_string(job.stride) + " bytes; a byte holds at most " +
                               std::to_string(kMostMeshopt) + ", and an element has at most 256; restore the file");
  left -= job.count * job.stride;
  if (left < 0)
    document.refuse(place, " unpacks, together with those before it, to more than " + std::to_string(kMostMeshopt) +
                               " times the bytes of all buffers, the most that is read; restore the file");
  document.source().take(job.count * job.stride);
  if (const std::string fault = decode_meshopt(job); !fault.empty()) document.refuse(place, fault);
  const size_t bytes = job.values.size();
  const size_t buffer = document.add_buffer(std::move(job.values));
  Json& changed = document.json()["bufferViews"][index];
  changed["buffer"] = buffer;
  changed["byteOffset"] = 0u;
  changed["byteLength"] = bytes;
}

/// A primitive that Draco packed, where it stands, and its accessors in the order of its attributes.
struct PackedPrimitive {
  size_t mesh, primitive;
  std::string place, fault;
  double bytes;  ///< unpacked, as the accessors say
  DracoMesh data;
  std::vector<std::string> semantics;
  std::vector<int64_t> accessors;
};

class DracoUnpacker {
 public:
  /// `file_bytes`: of all buffers of the file.
  DracoUnpacker(GltfDocument& document, int64_t file_bytes)
      : document_(document),
        is_required_(document.requires_extension(kDraco)),
        most_bytes_(double(kMostDraco * file_bytes)) {}

  void unpack() {
    find_all();
    // Draco's data may have more than accessors say: each may have its share of what all may have.
    for (PackedPrimitive& p : packed_)
      p.data.most_bytes = int64_t(p.bytes / std::max(claimed_bytes_, 1.0) * most_bytes_);
    for_each_index(size_t(0), packed_.size(), [&](size_t i) { packed_[i].fault = decode_draco(packed_[i].data); });
    for (PackedPrimitive& p : packed_) {
      if (!p.fault.empty()) document_.refuse(p.place, p.fault);
      put(p);
    }
  }

 private:
  void find_all() {
    for_each_primitive(document_, [&](size_t m, size_t i, const Json& primitive, const std::string& place) {
      if (const Json* const extension = extension_of(document_, primitive, kDraco, place)) add(m, i, *extension, place);
    });
  }

  bool has_view(const Json& object, const std::string& key) const {
    const Json& accessors = document_.list(document_.json(), "accessors");
    const auto at = object.find(key);
    if (at == object.end() || !at->is_number_unsigned() || at->get<uint64_t>() >= accessors.size()) return false;
    return accessors[at->get<size_t>()].contains("bufferView");
  }

  /// Whether all that is packed is also there for readers that do not know the extension.
  bool is_plain_too(const Json& primitive, const Json& attributes, const Json& packed) const {
    for (const auto& attribute : packed.items())
      if (!has_view(attributes, attribute.key())) return false;
    return has_view(primitive, "indices");
  }

  void add(size_t mesh, size_t index, const Json& extension, const std::string& in_list) {
    const Json& primitive = document_.json()["meshes"][mesh]["primitives"][index];
    PackedPrimitive p{mesh, index, in_list + ".extensions." + kDraco, "", 0, {}, {}, {}};
    const Json& attributes = attributes_of(document_, primitive, in_list);
    const Json& packed = attributes_of(document_, extension, p.place);
    if (!is_required_ && is_plain_too(primitive, attributes, packed)) return;
    const int64_t mode = document_.integer(primitive, "mode", in_list).value_or(kTriangles);
    if (mode < kTriangles) return;  // points and lines are not read
    if (mode != kTriangles && mode != kStrip)
      document_.refuse(in_list + ".mode", " is " + std::to_string(mode) + "; of what Draco packs it must be 4 or 5");
    p.data.packed =
        document_.bytes_of_view(document_.needed_integer(extension, "bufferView", p.place), p.place + ".bufferView");
    const GltfAccessor indices =
        document_.described(document_.needed_integer(primitive, "indices", in_list), in_list + ".indices");
    p.data.most_triangles = mode == kStrip ? indices.count : indices.count / 3;
    p.data.most_points = 3 * p.data.most_triangles;
    int64_t bytes_per_point = 0;
    for (const auto& item : packed.items()) {
      const std::string& semantic = item.key();
      const int64_t number = document_.needed_integer(attributes, semantic.c_str(), in_list + ".attributes");
      const GltfAccessor a = document_.described(number, in_list + ".attributes." + semantic);
      p.semantics.push_back(semantic);
      p.accessors.push_back(number);
      p.data.attributes.push_back(
          {document_.needed_integer(packed, semantic.c_str(), p.place + ".attributes"), a.type, a.components, {}});
      p.data.most_points = std::max(p.data.most_points, a.count);
      bytes_per_point += bytes_of(a.type) * a.components;
    }
    claim(p, bytes_per_point);
    packed_.push_back(std::move(p));
  }

  /// Before memory is taken for them.
  void claim(PackedPrimitive& p, int64_t bytes_per_point) {
    p.bytes = 12.0 * double(p.data.most_triangles) + double(bytes_per_point) * double(p.data.most_points);
    claimed_bytes_ += p.bytes;
    if (claimed_bytes_ > most_bytes_)
      document_.refuse(p.place, " unpacks to " + std::to_string(p.data.most_triangles) + " triangles and " +
                                    std::to_string(p.data.most_points) +
                                    " points, as its accessors say; together with "
                                    "those before them these are more than " +
                                    std::to_string(kMostDraco) +
                                    " times the bytes of all buffers, the most that is read; restore the file");
    document_.source().take(int64_t(kDracoFactor * p.bytes));
  }

  void put(PackedPrimitive& p) {
    const size_t triangles = p.data.indices.size() / 12;
    const Json indices = {{"componentType", kU32}, {"type", "SCALAR"}, {"count", 3 * triangles}};
    const size_t index = put_accessor(indices, std::move(p.data.indices));
    Json attributes = Json::object();
    for (size_t i = 0; i < p.semantics.size(); ++i) {
      Json accessor = document_.json()["accessors"][size_t(p.accessors[i])];
      accessor["count"] = size_t(p.data.points);
      accessor.erase("byteOffset");
      attributes[p.semantics[i]] = put_accessor(std::move(accessor), std::move(p.data.attributes[i].values));
    }
    Json& primitive = document_.json()["meshes"][p.mesh]["primitives"][p.primitive];
    primitive["attributes"].update(attributes);
    primitive["indices"] = index;
    primitive["mode"] = kTriangles;
  }

  size_t put_accessor(Json accessor, std::vector<char> values) {
    Json& json = document_.json();
    const size_t bytes = values.size();
    json["bufferViews"].push_back({{"buffer", document_.add_buffer(std::move(values))}, {"byteLength", bytes}});
    accessor["bufferView"] = json["bufferViews"].size() - 1;
    json["accessors"].push_back(std::move(accessor));
    return json["accessors"].size() - 1;
  }

  GltfDocument& document_;
  bool is_required_;
  double most_bytes_, claimed_bytes_ = 0;
  std::vector<PackedPrimitive> packed_;
};

}  // namespace

void unpack(GltfDocument& document) {
  const bool is_required = document.requires_extension(kMeshopt);
  const int64_t file_bytes = document.bytes();  // before what is unpacked counts, too
  const std::vector<bool> is_used = used_views(document);
  int64_t left = kMostMeshopt * file_bytes;
  for (size_t i = 0; i < is_used.size(); ++i)
    if (is_used[i]) unpack_view(document, i, is_required, left);
  DracoUnpacker(document, file_bytes).unpack();
}

}  // namespace isoshell
