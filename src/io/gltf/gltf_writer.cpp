// glTF out: one mesh with a primitive for each material and pair of regions, in one file.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "core/attribute_values.h"
#include "core/number_type.h"
#include "io/bytes/byte_order.h"
#include "io/bytes/output_file.h"
#include "io/gltf/gltf_materials.h"
#include "io/gltf/gltf_semantics.h"
#include "io/gltf/gltf_uri.h"
#include "io/gltf/gltf_vertices.h"
#include "io/mesh/precision.h"
#include "io/mesh/region_pairs.h"
#include "isoshell/error.h"
#include "isoshell/io/mesh_file.h"

namespace isoshell {
namespace {

using Json = nlohmann::ordered_json;

enum ComponentType { kU8 = 5121, kU16 = 5123, kU32 = 5125, kF32 = 5126 };
enum ViewTarget { kVertexData = 34962, kIndexData = 34963 };

template <class T>
void put(std::vector<char>& out, T value) {
  const auto bytes = little_endian_bytes(value);
  out.insert(out.end(), bytes.begin(), bytes.end());
}

double largest_of(NumberType type) {
  return with_type(type, [](auto number) {
    using T = decltype(number);
    return std::is_integral_v<T> ? double(std::numeric_limits<T>::max()) : 1.0;
  });
}

bool gltf_holds(const Attribute& a) {
  if (a.domain == AttributeDomain::face) return means(a, kMaterialName) && !a.labels.empty();
  if (a.domain == AttributeDomain::vertex && a.components == 1) return true;
  return semantic_of_name(a.name) && means(a, meaning_of(a.name)->name);
}

class GltfWriter {
 public:
  GltfWriter(const TriangleMesh& mesh, const Placement& placement) : mesh_(mesh), placement_(placement) {
    for (const Attribute& a : mesh.attributes) {
      if (a.domain == AttributeDomain::corner && gltf_holds(a)) of_corners_.push_back(&a);
      if (means(a, kMaterialName) && !a.labels.empty()) material_ = &a;
    }
    split_ = split_vertices(mesh, of_corners_);
    put_positions();
    if (!mesh.gap.empty()) put_numbers("_GAP", [&](size_t v) { return double(mesh.gap[split_.vertex[v]]); });
    for (const Attribute* a : of_corners_) put_corners(*a);
    for (const Attribute& a : mesh.attributes)
      if (a.domain == AttributeDomain::vertex) put_vertices(a);
    put_triangles();
    put_document();
  }

  /// Its buffer is `bytes()`, at the uri or in the file's binary chunk.
  std::string json(const std::string& uri) const {
    Json all = document_;
    all["buffers"] = Json::array({{{"byteLength", bytes_.size()}}});
    if (!uri.empty()) all["buffers"][0]["uri"] = uri;
    return all.dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  View<const char> bytes() const { return {bytes_.data(), int64_t(bytes_.size())}; }

 private:
  /// An accessor to what was put since byte `start`; its number.
  size_t close(size_t start, int target, int64_t stride, Json accessor) {
    Json view = {{"buffer", 0}, {"byteOffset", start}, {"byteLength", bytes_.size() - start}, {"target", target}};
    if (stride > 0) view["byteStride"] = stride;
    views_.push_back(view);
    accessor["bufferView"] = views_.size() - 1;
    accessors_.push_back(std::move(accessor));
    return accessors_.size() - 1;
  }

  void put_positions() {
    const size_t start = bytes_.size();
    bytes_.reserve(12 * split_.vertex.size());
    float low[3], high[3];
    std::fill_n(low, 3, std::numeric_limits<float>::infinity());
    std::fill_n(high, 3, -std::numeric_limits<float>::infinity());
    for (const uint32_t v : split_.vertex) {
      const WorldPoint p = placement_.about_origin(mesh_.vertices[v]);
      const float values[] = {float(p.x), float(p.y), float(p.z)};
      for (int i = 0; i < 3; ++i) {
        put(bytes_, values[i]);
        low[i] = std::min(low[i], values[i]);
        high[i] = std::max(high[i], values[i]);
      }
    }
    attributes_["POSITION"] = close(start, kVertexData, 12,
                                    {{"componentType", kF32},
                                     {"count", split_.vertex.size()},
                                     {"type", "VEC3"},
                                     {"min", {low[0], low[1], low[2]}},
                                     {"max", {high[0], high[1], high[2]}}});
  }

  template <class At>
  void put_numbers(const std::string& semantic, At at) {
    const size_t start = bytes_.size();
    for (size_t v = 0; v < split_.vertex.size(); ++v) put(bytes_, finite(float(at(v))));
    attributes_[semantic] =
        close(start, kVertexData, 4, {{"componentType", kF32}, {"count", split_.vertex.size()}, {"type", "SCALAR"}});
  }

  static float finite(float value) { return std::isfinite(value) ? value : 0; }  // the format has no other numbers

  /// Sets of texture coordinates are numbered without a break.
  std::string semantic_of(const Attribute& a) const {
    const char* const semantic = semantic_of_name(a.name);
    const int set = set_of_name(a.name);
    if (set < 0) return semantic;
    const auto before = std::count_if(of_corners_.begin(), of_corners_.end(), [&](const Attribute* other) {
      return semantic_of_name(other->name) == semantic && set_of_name(other->name) < set;
    });
    return semantic + std::to_string(before);
  }

  /// Corners without a value get 0; what is a direction must have one.
  void put_corners(const Attribute& a) {
    const bool is_direction = meaning_of(a.name)->is_direction;
    const size_t start = bytes_.size();
    for (const size_t corner : split_.corner) {
      const double* const value = corner == SIZE_MAX ? nullptr : value_of(a, corner);
      const bool has_value = value && !std::isnan(value[0]);
      for (int32_t c = 0; c < a.components; ++c)
        put(bytes_, has_value ? finite(float(value[c])) : is_direction && c == 2 ? 1.0f : 0.0f);
    }
    attributes_[semantic_of(a)] = close(
        start, kVertexData, 4 * a.components,
        {{"componentType", kF32}, {"count", split_.vertex.size()}, {"type", "VEC" + std::to_string(a.components)}});
  }

  void put_vertices(const Attribute& a) {
    if (means(a, kColorName)) return put_colors(a);
    if (a.components != 1) return;
    std::string semantic = a.name[0] == '_' ? a.name : "_" + a.name;
    while (attributes_.contains(semantic)) semantic = "_" + semantic;
    put_numbers(semantic, [&](size_t v) { return a.values[split_.vertex[v]]; });
  }

  /// Always with alpha: so the colours of bytes, too, are aligned.
  void put_colors(const Attribute& a) {
    const double largest = largest_of(a.type);
    const int type = a.type == NumberType::u8 ? kU8 : a.type == NumberType::u16 ? kU16 : kF32;
    const size_t start = bytes_.size();
    for (const uint32_t v : split_.vertex)
      for (int32_t c = 0; c < 4; ++c) {
        const double value = c < a.components ? a.values[size_t(v) * size_t(a.components) + size_t(c)] : largest;
        if (type == kU8) put(bytes_, nearest_of<uint8_t>(value));
        if (type == kU16) put(bytes_, nearest_of<uint16_t>(value));
        if (type == kF32) put(bytes_, finite(float(value / largest)));
      }
    attributes_["COLOR_0"] = close(
        start, kVertexData,
        type == kU8    ? 4
        : type == kU16 ? 8
                       : 16,
        {{"componentType", type}, {"normalized", type != kF32}, {"count", split_.vertex.size()}, {"type", "VEC4"}});
  }

  /// A primitive for each material and pair of regions that has faces, those without a material first; faces keep their
  /// order.
  void put_triangles() {
    const RegionPairs regions = pairs_of(mesh_.regions);
    std::map<std::pair<size_t, size_t>, std::vector<uint32_t>> faces;  // of a material, 0 being none, and a pair
    for (size_t t = 0; t < split_.triangles.size(); ++t)
      faces[{material_ ? size_t(material_->values[t] + 1) : 0, regions.of_face.empty() ? 0 : regions.of_face[t]}]
          .push_back(uint32_t(t));
    for (const auto& [part, of_part] : faces) {
      const size_t start = bytes_.size();
      for (const uint32_t t : of_part)
        for (const uint32_t v : split_.triangles[t]) put(bytes_, v);
      Json primitive = {{"attributes", attributes_}};
      primitive["indices"] =
          close(start, kIndexData, 0, {{"componentType", kU32}, {"count", 3 * of_part.size()}, {"type", "SCALAR"}});
      if (part.first > 0) primitive["material"] = part.first - 1;
      if (!regions.labels.empty()) primitive["extras"] = {{"regions", regions.labels[part.second]}};
      primitives_.push_back(primitive);
    }
  }

  /// The mesh, which says what its primitives' regions are called.
  Json mesh_of_primitives() const {
    Json mesh = {{"primitives", primitives_}};
    const FaceRegions& regions = mesh_.regions;
    if (regions.empty()) return mesh;
    Json names = Json::object();
    for (const RegionName& region : regions.names) names[std::to_string(region.label)] = region.name;
    mesh["extras"] = {{"region_background", regions.background}, {"region_names", names}};
    return mesh;
  }

  void put_document() {
    Json node = {{"mesh", 0}};
    if (const WorldPoint& at = placement_.origin; !is_origin(at)) node["translation"] = {at.x, at.y, at.z};
    Json asset = {{"version", "2.0"}, {"generator", "isoshell"}};
    if (const WorldPoint& by = placement_.offset; !is_origin(by)) asset["extras"] = {{"offset", {by.x, by.y, by.z}}};
    document_ = {{"asset", asset},
                 {"scene", 0},
                 {"scenes", Json::array({{{"nodes", Json::array({0})}}})},
                 {"nodes", Json::array({node})},
                 {"meshes", Json::array({mesh_of_primitives()})},
                 {"accessors", accessors_},
                 {"bufferViews", views_}};
    if (material_) put_gltf_materials(mesh_.files.gltf_materials, material_->labels, document_, bytes_);
  }

  const TriangleMesh& mesh_;
  const Placement& placement_;
  std::vector<const Attribute*> of_corners_;
  const Attribute* material_ = nullptr;
  GltfVertexSplit split_;
  std::vector<char> bytes_;
  Json attributes_ = Json::object(), primitives_ = Json::array(), accessors_ = Json::array(), views_ = Json::array();
  Json document_;  ///< all but the buffer
};

WorldPoint middle_of(const TriangleMesh& mesh, const Placement& placement) {
  WorldPoint low = placement.about_origin(mesh.vertices[0]), high = low;
  for (const WorldPoint& q : mesh.vertices) {
    const WorldPoint p = placement.about_origin(q);
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const auto half = [](double a, double b) { return in_single(a / 2 + b / 2); };  // exact for readers in floats
  return {half(low.x, high.x), half(low.y, high.y), half(low.z, high.z)};
}

void require_triangles(const TriangleMesh& mesh) {
  if (mesh.triangles.empty())
    throw Error(ErrorCode::unwritable_output, "write", "a glTF file cannot hold a mesh without triangles; write PLY");
}

}  // namespace

std::string what_gltf_lacks(const Attribute& attribute) {
  if (gltf_holds(attribute)) return "";
  return attribute.domain == AttributeDomain::face ? "glTF files hold no numbers of faces but materials"
                                                   : "glTF files hold no such numbers";
}

Placement place_in_gltf(const TriangleMesh& mesh, const WorldPoint& offset) {
  Placement placement = place_in_floats(mesh, offset);
  if (!mesh.vertices.empty() && needs_double(mesh, offset)) placement.origin = middle_of(mesh, placement);
  return placement;
}

void write_gltf(OutputFile& file, const TriangleMesh& mesh, const Placement& placement, const MeshWriteOptions&) {
  require_triangles(mesh);
  const GltfWriter writer(mesh, placement);
  file.write(writer.json("data:application/octet-stream;base64," + base64_of(writer.bytes())) + "\n");
}

void write_glb(OutputFile& file, const TriangleMesh& mesh, const Placement& placement, const MeshWriteOptions&) {
  require_triangles(mesh);
  const GltfWriter writer(mesh, placement);
  std::string json = writer.json("");
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const size_t total = 12 + 8 + json.size() + 8 + size_t(writer.bytes().size);  // a multiple of 4, as all elements have
  if (total > 0xffffffffu)
    throw Error(ErrorCode::unwritable_output, "write",
                "the mesh needs " + std::to_string(total) + " bytes; a .glb file has at most 4294967295, write PLY");
  std::vector<char> head;
  for (const uint32_t number : {0x46546c67u, 2u, uint32_t(total), uint32_t(json.size()), 0x4e4f534au})
    put(head, number);
  std::vector<char> chunk;
  for (const uint32_t number : {uint32_t(writer.bytes().size), 0x004e4942u}) put(chunk, number);
  file.write(head.data(), int64_t(head.size()));
  file.write(json);
  file.write(chunk.data(), int64_t(chunk.size()));
  file.write(writer.bytes().data, writer.bytes().size);
}

}  // namespace isoshell
