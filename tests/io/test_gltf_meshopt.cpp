// glTF packed by meshoptimizer: what its encoders made of a file is that file, bit by bit, and damaged bytes are
// refused.
#include <meshoptimizer.h>

#include "support/gltf_file.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "voxel/random.h"

using namespace isoshell;
using Json = nlohmann::json;

namespace {

constexpr const char* kName = "EXT_meshopt_compression";

std::string vertices_packed(const std::string& bytes, size_t stride) {
  const size_t count = bytes.size() / stride;
  std::vector<unsigned char> out(meshopt_encodeVertexBufferBound(count, stride));
  out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), bytes.data(), count, stride));
  return bytes_of(out);
}

std::string indices_packed(const std::vector<uint32_t>& indices, size_t vertices, bool are_triangles) {
  std::vector<unsigned char> out(are_triangles ? meshopt_encodeIndexBufferBound(indices.size(), vertices)
                                               : meshopt_encodeIndexSequenceBound(indices.size(), vertices));
  out.resize(are_triangles ? meshopt_encodeIndexBuffer(out.data(), out.size(), indices.data(), indices.size())
                           : meshopt_encodeIndexSequence(out.data(), out.size(), indices.data(), indices.size()));
  return bytes_of(out);
}

/// A view of a buffer that is not in the file.
size_t packed_view(GltfFile& file, const std::string& packed, size_t count, size_t stride, const char* mode,
                   const char* filter = "NONE", bool with_stride = true) {
  const size_t view = file.view(packed);
  Json& json = file.json["bufferViews"][view];
  json["extensions"][kName] = {{"buffer", 0},
                               {"byteOffset", json["byteOffset"]},
                               {"byteLength", packed.size()},
                               {"byteStride", stride},
                               {"count", count},
                               {"mode", mode},
                               {"filter", filter}};
  json["buffer"] = 1;
  json["byteOffset"] = 0;
  json["byteLength"] = count * stride;
  if (with_stride) json["byteStride"] = stride;
  return view;
}

/// Quantised as meshoptimizer's own packer does: a torus with positions of 16 bits, normals and texture coordinates.
struct Sample {
  TriangleSoup torus = shapes::torus(3, 1, 50, 30);
  std::vector<uint16_t> positions;
  std::vector<float> normals, uvs;  ///< normals with a fourth component
  std::vector<uint32_t> corners;

  Sample() {
    for (size_t v = 0; v < torus.vertices.size(); ++v) {
      const WorldPoint& p = torus.vertices[v];
      for (const double x : {p.x, p.y, p.z, -5.0}) positions.push_back(uint16_t((x + 5) * 6000));
      const double a = double(v) * .01, b = double(v) * .02;
      for (const double x : {std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b), 0.0})
        normals.push_back(float(x));
      uvs.insert(uvs.end(), {float(v) / 2048, 1 - float(v) / 4096});
    }
    for (const auto& t : torus.triangles) corners.insert(corners.end(), t.begin(), t.end());
  }
  size_t count() const { return torus.vertices.size(); }

  /// What the decoders make of `corners`: each triangle may begin with another of its corners.
  std::vector<uint32_t> turned_corners() const {
    const std::string packed = indices_packed(corners, count(), true);
    std::vector<uint32_t> out(corners.size());
    REQUIRE(meshopt_decodeIndexBuffer(out.data(), out.size(), reinterpret_cast<const unsigned char*>(packed.data()),
                                      packed.size()) == 0);
    return out;
  }
  std::string packed_normals() const {
    std::string out(4 * count(), '\0');
    meshopt_encodeFilterOct(out.data(), count(), 4, 8, normals.data());
    return out;
  }
  std::string packed_uvs() const {
    std::string out(8 * count(), '\0');
    meshopt_encodeFilterExp(out.data(), count(), 8, 15, uvs.data());
    return out;
  }
};

void put_mesh(GltfFile& file, const Sample& sample, size_t positions, size_t normals, size_t uvs, size_t indices) {
  file.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  file.json["nodes"] = {{{"mesh", 0}, {"translation", {-5, -5, -5}}}};
  file.primitive(
      {{"attributes",
        {{"POSITION", file.accessor(5123, sample.count(), "VEC3", {{"bufferView", positions}})},
         {"NORMAL", file.accessor(5120, sample.count(), "VEC3", {{"bufferView", normals}, {"normalized", true}})},
         {"TEXCOORD_0", file.accessor(5126, sample.count(), "VEC2", {{"bufferView", uvs}})}}},
       {"indices", file.accessor(5125, sample.corners.size(), "SCALAR", {{"bufferView", indices}})}});
}

GltfFile packed_file(const Sample& s) {
  GltfFile file;
  const size_t positions = packed_view(file, vertices_packed(bytes_of(s.positions), 8), s.count(), 8, "ATTRIBUTES");
  const size_t normals =
      packed_view(file, vertices_packed(s.packed_normals(), 4), s.count(), 4, "ATTRIBUTES", "OCTAHEDRAL");
  const size_t uvs = packed_view(file, vertices_packed(s.packed_uvs(), 8), s.count(), 8, "ATTRIBUTES", "EXPONENTIAL");
  const size_t indices =
      packed_view(file, indices_packed(s.corners, s.count(), true), s.corners.size(), 4, "TRIANGLES", "NONE", false);
  put_mesh(file, s, positions, normals, uvs, indices);
  file.json["extensionsRequired"].push_back(kName);
  file.json["buffers"].push_back({{"byteLength", 1 << 20}, {"extensions", {{kName, {{"fallback", true}}}}}});
  return file;
}

GltfFile plain_file(const Sample& s) {
  GltfFile file;
  std::string normals = s.packed_normals(), uvs = s.packed_uvs();
  meshopt_decodeFilterOct(normals.data(), s.count(), 4);
  meshopt_decodeFilterExp(uvs.data(), s.count(), 8);
  const size_t views[] = {file.view(bytes_of(s.positions), 8), file.view(normals, 4), file.view(uvs, 8),
                          file.view(bytes_of(s.turned_corners()))};
  put_mesh(file, s, views[0], views[1], views[2], views[3]);
  return file;
}

std::string refusal_of(const GltfFile& file) {
  const Error error = error_of([&] { read_glb(file.glb()); });
  CHECK(error.code() == ErrorCode::unreadable_input);
  return error.what();
}

void check_same(const TriangleSoup& a, const TriangleSoup& b) {
  REQUIRE(a.vertices.size() == b.vertices.size());
  for (size_t v = 0; v < a.vertices.size(); ++v) REQUIRE(same_bits(a.vertices[v], b.vertices[v]));
  CHECK(a.triangles == b.triangles);
  REQUIRE(a.attributes.size() == b.attributes.size());
  for (size_t i = 0; i < a.attributes.size(); ++i) {
    CHECK(a.attributes[i].name == b.attributes[i].name);
    CHECK(a.attributes[i].values == b.attributes[i].values);
    CHECK(a.attributes[i].index == b.attributes[i].index);
  }
}

}  // namespace

TEST_CASE("meshopt: a packed file has the values of the plain one", "[mesh_file][meshopt][unit]") {
  const Sample sample;
  const TriangleSoup plain = read_glb(plain_file(sample).glb()), packed = read_glb(packed_file(sample).glb());
  REQUIRE(packed.triangles.size() == sample.torus.triangles.size());
  check_same(plain, packed);
  // The filters' values are those that were packed, within their steps.
  for (const Attribute& a : packed.attributes) {
    const bool is_normal = a.name == kNormalName;
    double most = 0;
    for (size_t t = 0; t < packed.triangles.size(); ++t)
      for (size_t k = 0; k < 3; ++k) {
        const size_t v = packed.triangles[t][k], at = a.index[3 * t + k];
        for (size_t c = 0; c < size_t(a.components); ++c)
          most = std::max(most, std::abs(a.values[at * size_t(a.components) + c] -
                                         double((is_normal ? sample.normals[4 * v + c] : sample.uvs[2 * v + c]))));
      }
    INFO(a.name);
    CHECK(most <= (is_normal ? .03 : 1.0 / (1 << 14)));
  }
}

TEST_CASE("meshopt: sequences of indices are read, in 16 and 32 bits", "[mesh_file][meshopt][unit]") {
  const Sample sample;
  for (const size_t bytes : {size_t(2), size_t(4)}) {
    GltfFile file = packed_file(sample);
    const size_t view = packed_view(file, indices_packed(sample.corners, sample.count(), false), sample.corners.size(),
                                    bytes, "INDICES", "NONE", false);
    file.json["accessors"][3] = {{"bufferView", view},
                                 {"componentType", bytes == 2 ? 5123 : 5125},
                                 {"count", sample.corners.size()},
                                 {"type", "SCALAR"}};
    CHECK(read_glb(file.glb()).triangles == sample.torus.triangles);
  }
}

TEST_CASE("meshopt: what stands in the file plainly, too, is read from there unless the extension is required",
          "[mesh_file][meshopt][unit]") {
  const Sample sample;
  GltfFile file = plain_file(sample);
  file.json["bufferViews"][0]["extensions"][kName] = {{"buffer", 0},     {"byteOffset", 0}, {"byteLength", 9},
                                                      {"byteStride", 8}, {"count", 1},      {"mode", "ATTRIBUTES"}};
  check_same(read_glb(file.glb()), read_glb(plain_file(sample).glb()));
  file.json["extensionsRequired"].push_back(kName);
  CHECK(refusal_of(file).find(std::string("bufferViews[0].extensions.") + kName) != std::string::npos);
  // Where the data are not there, they are unpacked although nobody requires it.
  GltfFile packed = packed_file(sample);
  packed.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  check_same(read_glb(packed.glb()), read_glb(plain_file(sample).glb()));
}

TEST_CASE("meshopt: what a packed view promises and does not hold is refused with its place",
          "[mesh_file][meshopt][unit]") {
  const Sample sample;
  const auto check = [&](const char* view, const char* key, const Json& value, const std::string& part) {
    INFO(view << key << value);
    GltfFile file = packed_file(sample);
    file.json["bufferViews"][std::stoul(view)]["extensions"][kName][key] = value;
    const std::string text = refusal_of(file);
    INFO(text);
    CHECK(text.find(std::string("bufferViews[") + view + "].extensions." + kName) != std::string::npos);
    CHECK(text.find(part) != std::string::npos);
  };
  check("0", "count", int64_t(1) << 52, "elements of 8 bytes");
  check("0", "count", 3000, "decoder of ATTRIBUTES");
  check("0", "count", -1, ".count");
  check("0", "byteStride", 260, "at most 256");
  check("0", "byteStride", 6, "byteStride is 6");
  check("1", "byteStride", 12, "byteStride is 12");
  check("3", "byteStride", 8, "byteStride is 8");
  check("3", "count", 10, "count is 10");
  check("3", "filter", "OCTAHEDRAL", "filter");
  check("0", "filter", "CUBIC", "filter is \"CUBIC\"");
  check("0", "mode", "POINTS", "mode is \"POINTS\"");
  check("0", "mode", 7, "mode");
  check("0", "buffer", 7, ".buffer is 7");
  check("0", "byteLength", 1 << 30, "ends at byte");
  for (const int bytes : {0, 1, 20, 1000}) check("0", "byteLength", bytes, "");
  GltfFile lost = packed_file(sample);
  lost.json["bufferViews"][0].erase("extensions");
  CHECK(refusal_of(lost).find("buffers[1] has 0 bytes") != std::string::npos);
}

TEST_CASE("meshopt: views of the same packed bytes unpack to a limit together", "[mesh_file][meshopt][unit]") {
  const Sample sample;
  GltfFile file = packed_file(sample);
  const size_t corners = sample.corners.size();
  const std::string packed = indices_packed(std::vector<uint32_t>(corners), 1, true);
  REQUIRE(4 * corners < 64 * packed.size());  // each is read
  const size_t first = packed_view(file, packed, corners, 4, "TRIANGLES", "NONE", false);
  const Json view = file.json["bufferViews"][first], primitive = file.json["meshes"][0]["primitives"][0];
  const auto copies_to = [&](size_t bytes) {
    GltfFile copied = file;
    for (size_t i = 1; 4 * corners * i < bytes; ++i) {
      copied.json["bufferViews"].push_back(view);
      Json& made = copied.primitive(primitive);
      made["indices"] = copied.accessor(5125, corners, "SCALAR", {{"bufferView", first + i}});
    }
    return copied;
  };
  const size_t most = 64 * file.binary.size();
  // The copies' triangles have one corner each and are left out.
  CHECK(read_glb(copies_to(most / 2).glb()).triangles.size() == sample.torus.triangles.size());
  CHECK(refusal_of(copies_to(2 * most)).find("more than 64 times the bytes of all buffers") != std::string::npos);
}

TEST_CASE("meshopt: damaged views that no primitive uses are passed over", "[mesh_file][meshopt][unit]") {
  const Sample sample;
  GltfFile file = packed_file(sample);
  const size_t view = packed_view(file, "damaged bytes of an animation", 4, 16, "ATTRIBUTES");
  const size_t unused = file.accessor(5126, 4, "VEC4", {{"bufferView", view}});
  check_same(read_glb(file.glb()), read_glb(plain_file(sample).glb()));
  file.json["meshes"][0]["primitives"][0]["attributes"]["_OTHER"] = unused;
  CHECK(refusal_of(file).find("bufferViews[4]") != std::string::npos);
}

TEST_CASE("meshopt: damaged bytes are refused or give a sound soup", "[mesh_file][meshopt][unit]") {
  const GltfFile file = packed_file(Sample());
  const std::string glb = file.glb();
  const auto random = [](uint64_t round) { return random_bits(3, round); };
  const int64_t survivors = read_damaged(glb, glb.size() - file.binary.size(), glb.size(), 1000, random);
  CHECK(survivors >= 0);
  CHECK(survivors < 1000);
}
