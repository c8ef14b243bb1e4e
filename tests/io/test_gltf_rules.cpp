// Written glTF files keep the rules of the specification that readers rely on, which Khronos's validator calls errors
// or warnings.
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "support/mesh_files.h"
#include "support/shapes.h"

using namespace isoshell;
using Json = nlohmann::json;

namespace {

constexpr int kVertexData = 34962, kIndexData = 34963;

uint32_t u32_at(const std::string& bytes, size_t at) {
  uint32_t value = 0;
  REQUIRE(at + 4 <= bytes.size());
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

/// A .glb file taken apart by the rules of its container.
class Checked {
 public:
  explicit Checked(const std::string& glb) {
    REQUIRE(glb.substr(0, 4) == "glTF");
    CHECK(u32_at(glb, 4) == 2);
    CHECK(u32_at(glb, 8) == glb.size());
    const size_t text = u32_at(glb, 12), chunk = 20 + text;
    CHECK(text % 4 == 0);
    CHECK(glb.substr(16, 4) == "JSON");
    CHECK(glb.substr(chunk + 4, 4) == std::string("BIN\0", 4));
    CHECK(u32_at(glb, chunk) % 4 == 0);
    REQUIRE(u32_at(glb, chunk) == glb.size() - chunk - 8);
    json_ = Json::parse(glb.substr(20, text));
    binary_ = glb.substr(chunk + 8);
    check_document();
  }

 private:
  void check_document() {
    CHECK(json_["asset"]["version"] == "2.0");
    REQUIRE(json_["buffers"].size() == 1);
    const size_t bytes = json_["buffers"][0]["byteLength"];
    CHECK(bytes <= binary_.size());
    CHECK(binary_.size() - bytes < 4);
    for (const auto& part : json_.items())
      if (part.value().is_array()) CHECK_FALSE(part.value().empty());
    for (const Json& view : json_["bufferViews"]) check_view(view, bytes);
    for (const Json& accessor : json_["accessors"]) check_accessor(accessor);
    CHECK(json_["scenes"][size_t(json_["scene"])]["nodes"] == Json::array({0}));
    REQUIRE(json_["nodes"].size() == 1);
    CHECK(json_["nodes"][0]["mesh"] == 0);
    REQUIRE(json_["meshes"].size() == 1);
    for (const Json& primitive : json_["meshes"][0]["primitives"]) check_primitive(primitive);
    if (json_.contains("images"))
      for (const Json& image : json_["images"]) {
        CHECK((image.contains("uri") != image.contains("bufferView")));
        if (!image.contains("bufferView")) continue;
        CHECK(image.contains("mimeType"));
        CHECK_FALSE(json_["bufferViews"].at(size_t(image["bufferView"])).contains("target"));
        used_views_.insert(size_t(image["bufferView"]));
      }
    CHECK(used_accessors_.size() == json_["accessors"].size());
    CHECK(used_views_.size() == json_["bufferViews"].size());
    check_extensions();
  }

  void check_view(const Json& view, size_t buffer_bytes) {
    CHECK(view["buffer"] == 0);
    const size_t offset = view.value("byteOffset", 0), bytes = view["byteLength"];
    CHECK(bytes > 0);
    CHECK(offset + bytes <= buffer_bytes);
    CHECK(offset % 4 == 0);
    if (!view.contains("byteStride")) return;
    CHECK(view["target"] == kVertexData);
    const size_t stride = view["byteStride"];
    CHECK((stride >= 4 && stride <= 252 && stride % 4 == 0));
  }

  static size_t component_bytes(const Json& accessor) {
    switch (int(accessor["componentType"])) {
      case 5120:
      case 5121:
        return 1;
      case 5122:
      case 5123:
        return 2;
      case 5125:
      case 5126:
        return 4;
      default:
        FAIL("componentType " << accessor["componentType"]);
        return 0;
    }
  }
  static size_t components(const Json& accessor) {
    const std::string type = accessor["type"];
    REQUIRE((type == "SCALAR" || type == "VEC2" || type == "VEC3" || type == "VEC4"));
    return type == "SCALAR" ? 1 : size_t(type[3] - '0');
  }
  const Json& view_of(const Json& accessor) const { return json_["bufferViews"].at(size_t(accessor["bufferView"])); }
  size_t stride_of(const Json& accessor) const {
    return view_of(accessor).value("byteStride", component_bytes(accessor) * components(accessor));
  }

  void check_accessor(const Json& accessor) {
    const size_t size = component_bytes(accessor) * components(accessor), count = accessor["count"],
                 offset = accessor.value("byteOffset", 0);
    CHECK(count > 0);
    CHECK(offset % component_bytes(accessor) == 0);
    CHECK(offset + stride_of(accessor) * (count - 1) + size <= size_t(view_of(accessor)["byteLength"]));
    if (accessor.value("normalized", false))
      CHECK((accessor["componentType"] != 5126 && accessor["componentType"] != 5125));
    used_views_.insert(size_t(accessor["bufferView"]));
    if (accessor["componentType"] != 5126) return;
    for (size_t i = 0; i < count * components(accessor); ++i) REQUIRE(std::isfinite(number(accessor, i)));
  }

  /// Of single precision, one behind the other.
  float number(const Json& accessor, size_t i) const {
    const size_t n = components(accessor);
    float value = 0;
    std::memcpy(&value,
                binary_.data() + size_t(view_of(accessor).value("byteOffset", 0)) +
                    size_t(accessor.value("byteOffset", 0)) + i / n * stride_of(accessor) + 4 * (i % n),
                4);
    return value;
  }

  const Json& used(const Json& index, int target) {
    used_accessors_.insert(size_t(index));
    const Json& accessor = json_["accessors"].at(size_t(index));
    CHECK(view_of(accessor)["target"] == target);
    return accessor;
  }

  void check_primitive(const Json& primitive) {
    const Json& attributes = primitive["attributes"];
    const Json& position = used(attributes["POSITION"], kVertexData);
    CHECK(position["componentType"] == 5126);
    CHECK(position["type"] == "VEC3");
    check_bounds(position);
    for (const auto& item : attributes.items()) {
      const Json& accessor = used(item.value(), kVertexData);
      INFO(item.key());
      CHECK(accessor["count"] == position["count"]);
      CHECK(stride_of(accessor) % 4 == 0);
      if (item.key() == "NORMAL") check_normals(accessor);
      if (item.key().rfind("TEXCOORD_", 0) == 0 && item.key() != "TEXCOORD_0")
        CHECK(attributes.contains("TEXCOORD_" + std::to_string(std::stoi(item.key().substr(9)) - 1)));
    }
    const Json& indices = used(primitive["indices"], kIndexData);
    CHECK(indices["type"] == "SCALAR");
    REQUIRE(indices["componentType"] == 5125);
    CHECK(size_t(indices["count"]) % 3 == 0);
    CHECK_FALSE(view_of(indices).contains("byteStride"));
    const size_t start = view_of(indices).value("byteOffset", 0);
    for (size_t i = 0; i < size_t(indices["count"]); ++i)
      REQUIRE(u32_at(binary_, start + 4 * i) < size_t(position["count"]));
    if (primitive.contains("material")) CHECK(size_t(primitive["material"]) < json_["materials"].size());
  }

  void check_bounds(const Json& position) {
    for (size_t c = 0; c < 3; ++c) {
      float low = std::numeric_limits<float>::infinity(), high = -low;
      for (size_t v = 0; v < size_t(position["count"]); ++v) {
        low = std::min(low, number(position, 3 * v + c));
        high = std::max(high, number(position, 3 * v + c));
      }
      CHECK(position["min"].at(c).get<double>() == double(low));
      CHECK(position["max"].at(c).get<double>() == double(high));
    }
  }

  void check_normals(const Json& normal) {
    CHECK(normal["type"] == "VEC3");
    for (size_t v = 0; v < size_t(normal["count"]); ++v)
      REQUIRE(std::abs(std::hypot(number(normal, 3 * v), number(normal, 3 * v + 1), number(normal, 3 * v + 2)) - 1) <
              5e-4);
  }

  /// Those that are used are listed, and those that are required are used.
  void check_extensions() {
    const Json used = json_.value("extensionsUsed", Json::array());
    const std::string text = json_.dump();
    for (const Json& name : used) CHECK(text.find(name.get<std::string>() + "\":") != std::string::npos);
    for (const Json& name : json_.value("extensionsRequired", Json::array()))
      CHECK(std::find(used.begin(), used.end(), name) != used.end());
  }

  Json json_;
  std::string binary_;
  std::set<size_t> used_accessors_, used_views_;
};

/// With all that the writer can hold: corners that jump, and one without a value.
TriangleMesh full_mesh() {
  const TriangleSoup torus = shapes::torus(3, 1, 50, 30);
  TriangleMesh mesh{torus.vertices, torus.triangles};
  const size_t corners = 3 * mesh.triangles.size();
  mesh.attributes.push_back({kMaterialName, NumberType::i32, 1, {}, AttributeDomain::face, {}, {"clay", "gold"}});
  for (size_t t = 0; t < mesh.triangles.size(); ++t) mesh.attributes[0].values.push_back(t < 700 ? 0 : 1);
  Attribute uv{kUvName, NumberType::f32, 2, {0, 0, .5, .25}, AttributeDomain::corner}, uv3 = uv;
  uv3.name = kUvName + std::string("3");
  Attribute normal{kNormalName, NumberType::f32, 3, {0, 0, 1, .6, 0, .8}, AttributeDomain::corner};
  const double none = std::numeric_limits<double>::quiet_NaN();
  for (const double x : {none, none, none}) normal.values.push_back(x);
  for (size_t c = 0; c < corners; ++c) {
    uv.index.push_back(c < 900 ? 0 : 1);
    uv3.index.push_back(c % 2 ? 0 : 1);
    normal.index.push_back(c % 40 == 0 ? 2 : c < 1200 ? 0 : 1);
  }
  Attribute color{kColorName, NumberType::u8, 3, {}}, heat{"heat", NumberType::f32, 1, {}};
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    color.values.insert(color.values.end(), {double(v % 256), 0, 255});
    heat.values.push_back(v == 7 ? none : double(v) / 3);
  }
  for (const Attribute& a : {uv, uv3, normal, color, heat}) mesh.attributes.push_back(a);
  mesh.files.gltf_materials =
      R"({"materials":[{"name":"clay","extensions":{"KHR_materials_ior":{"ior":1.4}}},{"name":"gold",)"
      R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],)"
      R"("images":[{"uri":"data:image/png;base64,aW1hZ2U="}],"extensionsUsed":["KHR_materials_ior"]})";
  return mesh;
}

}  // namespace

TEST_CASE("glTF: written files keep the rules of the specification", "[mesh_file][unit]") {
  const TemporaryFolder folder;
  TriangleMesh mesh = full_mesh();
  write_mesh(folder / "full.glb", mesh);
  const Checked full(get_file(folder / "full.glb"));
  for (WorldPoint& p : mesh.vertices) p.x = p.x / 3 + 1e6;
  write_mesh(folder / "far.glb", mesh, {"", true});
  const Checked far(get_file(folder / "far.glb"));
  mesh.attributes.clear();
  mesh.files = {};
  write_mesh(folder / "bare.glb", mesh);
  const Checked bare(get_file(folder / "bare.glb"));
}
