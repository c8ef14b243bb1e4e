// glTF packed by Draco: what its encoder made of a mesh is that mesh, and damaged bytes are refused.
#include <draco/compression/encode.h>

#include <array>
#include <map>
#include <set>

#include "io/gltf/gltf_codecs.h"
#include "support/gltf_file.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "voxel/random.h"

using namespace isoshell;
using Json = nlohmann::json;

namespace {

constexpr const char* kName = "KHR_draco_mesh_compression";

/// A torus, with all kinds of attributes as values that depend on the number of the vertex, which is one of them.
struct Sample {
  TriangleSoup torus = shapes::torus(3, 1, 50, 30);
  size_t count() const { return torus.vertices.size(); }
  std::vector<float> positions() const {
    std::vector<float> all;
    for (const WorldPoint& p : torus.vertices)
      for (const double x : {p.x, p.y, p.z}) all.push_back(float(x));
    return all;
  }
  std::vector<float> normals() const {
    std::vector<float> all;
    for (size_t v = 0; v < count(); ++v) {
      const double a = double(v) * .01, b = double(v) * .02;
      for (const double x : {std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)})
        all.push_back(float(x));
    }
    return all;
  }
  std::vector<float> uvs() const {
    std::vector<float> all;
    for (size_t v = 0; v < count(); ++v) all.insert(all.end(), {float(v) / 2000, 1 - float(v) / 3000});
    return all;
  }
  std::vector<uint8_t> colors() const {
    std::vector<uint8_t> all;
    for (size_t v = 0; v < count(); ++v)
      all.insert(all.end(), {uint8_t(v), uint8_t(v / 8), uint8_t(255 - v % 256), uint8_t(200)});
    return all;
  }
  std::vector<uint16_t> numbers() const {
    std::vector<uint16_t> all;
    for (size_t v = 0; v < count(); ++v) all.push_back(uint16_t(v));
    return all;
  }
};

struct Packed {
  std::string bytes;
  size_t points, triangles;
  std::map<std::string, uint32_t> ids;
};

template <class T>
void add(draco::Mesh& mesh, Packed& packed, const char* name, draco::GeometryAttribute::Type kind, draco::DataType type,
         int8_t components, bool normalized, const std::vector<T>& values) {
  draco::GeometryAttribute attribute;
  attribute.Init(kind, nullptr, uint8_t(components), type, normalized, int64_t(sizeof(T)) * components, 0);
  const auto count = uint32_t(values.size() / size_t(components));
  draco::PointAttribute& made = *mesh.attribute(mesh.AddAttribute(attribute, true, count));
  for (uint32_t v = 0; v < count; ++v)
    made.SetAttributeValue(draco::AttributeValueIndex(v), &values[v * size_t(components)]);
  packed.ids[name] = made.unique_id();
}

/// At speed 10 sequential, else by edgebreaker.
Packed pack(const Sample& sample, int speed) {
  using Attribute = draco::GeometryAttribute;
  Packed packed;
  draco::Mesh mesh;
  mesh.set_num_points(uint32_t(sample.count()));
  add(mesh, packed, "POSITION", Attribute::POSITION, draco::DT_FLOAT32, 3, false, sample.positions());
  add(mesh, packed, "NORMAL", Attribute::NORMAL, draco::DT_FLOAT32, 3, false, sample.normals());
  add(mesh, packed, "TEXCOORD_0", Attribute::TEX_COORD, draco::DT_FLOAT32, 2, false, sample.uvs());
  add(mesh, packed, "COLOR_0", Attribute::COLOR, draco::DT_UINT8, 4, true, sample.colors());
  add(mesh, packed, "_NUMBER", Attribute::GENERIC, draco::DT_UINT16, 1, false, sample.numbers());
  for (const auto& t : sample.torus.triangles)
    mesh.AddFace({draco::PointIndex(t[0]), draco::PointIndex(t[1]), draco::PointIndex(t[2])});
  draco::Encoder encoder;
  encoder.SetSpeedOptions(speed, speed);
  encoder.SetTrackEncodedProperties(true);
  encoder.SetAttributeQuantization(Attribute::POSITION, 14);
  encoder.SetAttributeQuantization(Attribute::NORMAL, 10);
  encoder.SetAttributeQuantization(Attribute::TEX_COORD, 12);
  draco::EncoderBuffer buffer;
  REQUIRE(encoder.EncodeMeshToBuffer(mesh, &buffer).ok());
  packed.bytes.assign(buffer.data(), buffer.size());
  packed.points = encoder.num_encoded_points();
  packed.triangles = encoder.num_encoded_faces();
  return packed;
}

/// The shapes of all accessors, with or without data.
Json attributes_of(GltfFile& file, const Sample& sample, size_t count, bool is_plain) {
  const auto more = [&](const auto& values) {
    return is_plain ? Json{{"bufferView", file.view(bytes_of(values))}} : Json();
  };
  Json colors = more(sample.colors());
  colors["normalized"] = true;
  return {{"POSITION", file.accessor(5126, count, "VEC3", more(sample.positions()))},
          {"NORMAL", file.accessor(5126, count, "VEC3", more(sample.normals()))},
          {"TEXCOORD_0", file.accessor(5126, count, "VEC2", more(sample.uvs()))},
          {"COLOR_0", file.accessor(5121, count, "VEC4", colors)},
          {"_NUMBER", file.accessor(5123, count, "SCALAR", more(sample.numbers()))}};
}

GltfFile plain_file(const Sample& sample) {
  GltfFile file;
  std::vector<uint32_t> corners;
  for (const auto& t : sample.torus.triangles) corners.insert(corners.end(), t.begin(), t.end());
  const Json attributes = attributes_of(file, sample, sample.count(), true);
  const size_t indices = file.accessor(5125, corners.size(), "SCALAR", {{"bufferView", file.view(bytes_of(corners))}});
  file.primitive({{"attributes", attributes}, {"indices", indices}});
  return file;
}

Json extension_of(const Packed& packed, size_t view) {
  return {{kName, {{"bufferView", view}, {"attributes", packed.ids}}}};
}

/// The packed bytes stand first in the binary chunk.
GltfFile packed_file(const Sample& sample, const Packed& packed) {
  GltfFile file;
  file.json["extensionsRequired"] = {kName};
  const size_t view = file.view(packed.bytes);
  const Json attributes = attributes_of(file, sample, packed.points, false);
  file.primitive({{"attributes", attributes},
                  {"indices", file.accessor(5123, 3 * packed.triangles, "SCALAR")},
                  {"extensions", extension_of(packed, view)}});
  return file;
}

const Attribute& attribute(const TriangleSoup& soup, const std::string& name) {
  for (const Attribute& a : soup.attributes)
    if (a.name == name) return a;
  FAIL("no attribute " << name);
  return soup.attributes[0];
}

/// Corner k of triangle t, of component c.
double corner_value(const Attribute& a, const TriangleSoup& soup, size_t t, size_t k, size_t c) {
  size_t at = soup.triangles[t][k];
  if (a.domain == AttributeDomain::corner) at = a.index.empty() ? 3 * t + k : a.index[3 * t + k];
  return a.values[at * size_t(a.components) + c];
}

/// The triangles by their numbers of vertices, the smallest first.
std::map<std::array<double, 3>, std::pair<size_t, size_t>> numbered(const TriangleSoup& soup) {
  const Attribute& number = attribute(soup, "_NUMBER");
  std::map<std::array<double, 3>, std::pair<size_t, size_t>> all;
  for (size_t t = 0; t < soup.triangles.size(); ++t) {
    std::array<double, 3> key;
    for (size_t k = 0; k < 3; ++k) key[k] = corner_value(number, soup, t, k, 0);
    const auto first = size_t(std::min_element(key.begin(), key.end()) - key.begin());
    std::rotate(key.begin(), key.begin() + long(first), key.end());
    all[key] = {t, first};
  }
  return all;
}

/// The largest difference of any value of an attribute at any corner.
double largest_difference(const TriangleSoup& a, const TriangleSoup& b, const std::string& name) {
  const Attribute &of_a = attribute(a, name), &of_b = attribute(b, name);
  REQUIRE(of_a.type == of_b.type);
  REQUIRE(of_a.components == of_b.components);
  const auto in_a = numbered(a), in_b = numbered(b);
  double most = 0;
  for (const auto& [key, at] : in_a) {
    const auto [t, first] = in_b.at(key);
    for (size_t k = 0; k < 3; ++k)
      for (size_t c = 0; c < size_t(of_a.components); ++c)
        most = std::max(most, std::abs(corner_value(of_a, a, at.first, (at.second + k) % 3, c) -
                                       corner_value(of_b, b, t, (first + k) % 3, c)));
  }
  return most;
}

double largest_move(const TriangleSoup& a, const TriangleSoup& b) {
  const auto in_a = numbered(a), in_b = numbered(b);
  double most = 0;
  for (const auto& [key, at] : in_a)
    for (size_t k = 0; k < 3; ++k) {
      const auto [t, first] = in_b.at(key);
      const WorldPoint& p = a.vertices[a.triangles[at.first][(at.second + k) % 3]];
      const WorldPoint& q = b.vertices[b.triangles[t][(first + k) % 3]];
      most = std::max({most, std::abs(p.x - q.x), std::abs(p.y - q.y), std::abs(p.z - q.z)});
    }
  return most;
}

std::string refusal_of(const GltfFile& file) {
  const Error error = error_of([&] { read_glb(file.glb()); });
  CHECK(error.code() == ErrorCode::unreadable_input);
  return error.what();
}

void check_contains(const std::string& text, const std::string& part) {
  INFO(text);
  CHECK(text.find(part) != std::string::npos);
}

}  // namespace

TEST_CASE("Draco: a packed mesh is the plain one within the steps of its quantisation", "[mesh_file][draco][unit]") {
  const Sample sample;
  const TriangleSoup plain = read_glb(plain_file(sample).glb());
  REQUIRE(plain.triangles.size() == sample.torus.triangles.size());
  for (const int speed : {0, 5, 10}) {
    INFO("speed " << speed);
    const TriangleSoup soup = read_glb(packed_file(sample, pack(sample, speed)).glb());
    REQUIRE(soup.triangles.size() == plain.triangles.size());
    REQUIRE(soup.vertices.size() == plain.vertices.size());
    REQUIRE(numbered(soup).size() == plain.triangles.size());
    CHECK(largest_move(plain, soup) <= 8.0 / (1 << 14));
    CHECK(largest_difference(plain, soup, kNormalName) <= 8.0 / (1 << 10));
    CHECK(largest_difference(plain, soup, kUvName) <= 1.0 / (1 << 12));
    CHECK(largest_difference(plain, soup, kColorName) == 0);
    CHECK(largest_difference(plain, soup, "_NUMBER") == 0);
  }
}

TEST_CASE("Draco: what stands in the file plainly, too, is read from there unless the extension is required",
          "[mesh_file][draco][unit]") {
  const Sample sample;
  Packed packed = pack(sample, 5);
  GltfFile file = plain_file(sample);
  const size_t view = file.view(packed.bytes);
  file.json["meshes"][0]["primitives"][0]["extensions"] = extension_of(packed, view);
  const TriangleSoup plain = read_glb(plain_file(sample).glb());
  CHECK(read_glb(file.glb()).triangles == plain.triangles);
  CHECK(largest_move(read_glb(file.glb()), plain) == 0);
  file.json["extensionsRequired"] = {kName};
  CHECK(largest_move(read_glb(file.glb()), plain) > 0);
  // Plain attributes that Draco does not have stay, and a strip is the triangles that were packed.
  file.json["meshes"][0]["primitives"][0]["mode"] = 5;
  CHECK(read_glb(file.glb()).triangles.size() == plain.triangles.size());
}

TEST_CASE("Draco: what a packed mesh promises and does not hold is refused with its place",
          "[mesh_file][draco][unit]") {
  const Sample sample;
  const Packed packed = pack(sample, 5), sequential = pack(sample, 10);
  const auto changed = [&](const Packed& from, const char* pointer, const Json& value) {
    GltfFile file = packed_file(sample, from);
    file.json[Json::json_pointer(pointer)] = value;
    return refusal_of(file);
  };
  const std::string in_extension = std::string("/meshes/0/primitives/0/extensions/") + kName;
  const std::string place = std::string("meshes[0].primitives[0].extensions.") + kName;
  for (const Packed* from : {&packed, &sequential}) {
    check_contains(changed(*from, "/accessors/5/count", 3), place + " promises 3000 triangles");
    check_contains(changed(*from, "/accessors/5/count", int64_t(1) << 50), "16384 times the bytes");
    check_contains(changed(*from, "/accessors/0/type", "VEC2"), "3 components; its accessor has 2");
    check_contains(changed(*from, "/accessors/4/componentType", 5121), "componentType cannot hold");
    check_contains(changed(*from, (in_extension + "/attributes/NORMAL").c_str(), 77), "attribute 77");
    check_contains(changed(*from, (in_extension + "/attributes/NORMAL").c_str(), int64_t(1) << 40), "no data");
    check_contains(changed(*from, (in_extension + "/attributes/_OTHER").c_str(), 0), "has no _OTHER");
    check_contains(changed(*from, (in_extension + "/bufferView").c_str(), 5), place + ".bufferView is 5");
    check_contains(changed(*from, (in_extension + "/bufferView").c_str(), "x"), place + ".bufferView");
    check_contains(changed(*from, "/meshes/0/primitives/0/mode", 6), "mode is 6");
    for (const size_t bytes : {size_t(0), size_t(4), size_t(11), size_t(40), from->bytes.size() / 2})
      check_contains(changed(*from, "/bufferViews/0/byteLength", bytes), place);
  }
  Packed other = packed;
  other.bytes[5] = 1;  // the version
  check_contains(refusal_of(packed_file(sample, other)), "version 1.2");
  other = packed;
  other.bytes[7] = 0;  // points without triangles
  check_contains(refusal_of(packed_file(sample, other)), "no triangles");
}

TEST_CASE("Draco: what a packed mesh takes in memory is refused before it is taken", "[mesh_file][draco][unit]") {
  const Sample sample;
  for (const int speed : {5, 10}) {
    const Packed packed = pack(sample, speed);
    const auto points = int64_t(packed.points);
    // The values and the integers that they are packed as, although no attribute is wanted.
    const int64_t bytes = points * (12 + 12 + 8 + 4 + 2 + 4 * (3 + 3 + 2 + 4 + 1));
    DracoMesh mesh{
        {packed.bytes.data(), int64_t(packed.bytes.size())}, int64_t(packed.triangles), points, bytes, {}, 0, {}};
    CHECK(decode_draco(mesh).empty());
    CHECK(mesh.points == points);
    mesh.most_bytes = bytes - 1;
    check_contains(decode_draco(mesh), "promises 90 bytes a point; at most 89 are read");
  }
}

TEST_CASE("Draco: damaged bytes are refused or give a sound soup", "[mesh_file][draco][unit]") {
  const Sample sample;
  for (const int speed : {0, 5, 10}) {
    const Packed packed = pack(sample, speed);
    const std::string glb = packed_file(sample, packed).glb();
    const size_t first = glb.find(packed.bytes.substr(0, 5));
    REQUIRE(first != std::string::npos);
    const auto random = [&](uint64_t round) { return random_bits(uint64_t(speed), round); };
    const int64_t survivors = read_damaged(glb, first, first + packed.bytes.size(), 400, random);
    CHECK(survivors >= 0);
    CHECK(survivors < 400);
    // The head decides what memory is taken.
    CHECK(read_damaged(glb, first, first + 40, 400, random) >= 0);
  }
}
