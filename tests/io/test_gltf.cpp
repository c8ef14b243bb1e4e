// glTF files made byte by byte: what they hold is read, what they promise and do not hold is refused.
#include <cstring>
#include <map>

#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/shapes.h"

using namespace isoshell;

namespace {

template <class T>
std::string bytes_of(std::initializer_list<T> values) {
  std::string bytes;
  for (const T value : values) bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  return bytes;
}

std::string u32(size_t value) { return bytes_of<uint32_t>({uint32_t(value)}); }

std::string glb(std::string json, std::string binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  return "glTF" + u32(2) + u32(28 + json.size() + binary.size()) + u32(json.size()) + "JSON" + json +
         u32(binary.size()) + std::string("BIN\0", 4) + binary;
}

/// The JSON of a file whose buffer has this many bytes; `members` are all others of the document.
std::string document(size_t bytes, const std::string& members) {
  return R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":)" + std::to_string(bytes) + "}]," + members + "}";
}

const std::string kSquare = bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});  // z-wise: a strip as it stands

std::string square_views(const std::string& more) {
  return R"("bufferViews":[{"buffer":0,"byteLength":48}],"accessors":[{"bufferView":0,"componentType":5126,"count":4,)"
         R"("type":"VEC3"}],)" +
         more;
}

using Triangles = std::vector<std::array<uint32_t, 3>>;

/// Indices of a type for the square.
template <class T>
TriangleSoup indexed_square(int component_type, std::initializer_list<T> indices) {
  const std::string binary = kSquare + bytes_of<T>(indices);
  return read_text_as(
      "glb",
      glb(document(binary.size(),
                   R"("bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":)" +
                       std::to_string(binary.size() - 48) +
                       R"(}],"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
                       R"({"bufferView":1,"componentType":)" +
                       std::to_string(component_type) + R"(,"count":)" + std::to_string(indices.size()) +
                       R"(,"type":"SCALAR"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}])"),
          binary));
}

const Attribute* find(const TriangleSoup& soup, const std::string& name) {
  for (const Attribute& a : soup.attributes)
    if (a.name == name) return &a;
  return nullptr;
}

}  // namespace

TEST_CASE("glTF: without indices, vertices are the positions in the order of their first corners",
          "[mesh_file][unit]") {
  std::string positions;
  std::map<std::array<float, 3>, uint32_t> known;
  std::vector<uint32_t> expected;
  const uint32_t corners = 3 * 70000;  // of several blocks of corners
  for (uint32_t i = 0; i < corners; ++i) {
    // Neighbours share positions, and half of all corners one of anywhere; the z of 0 has both signs.
    const uint32_t p = i % 2 == 0 ? i / 6 : uint32_t(i * 2654435761u) % 50000;
    const float zero = i % 3 == 0 ? -0.0f : 0.0f;
    positions += bytes_of<float>({float(p % 251), float(p / 251), zero});
    expected.push_back(
        known.emplace(std::array<float, 3>{float(p % 251), float(p / 251), 0}, known.size()).first->second);
  }
  const std::string size = std::to_string(positions.size());
  const TriangleSoup soup = read_text_as(
      "glb",
      glb(document(positions.size(),
                   R"("bufferViews":[{"buffer":0,"byteLength":)" + size +
                       R"(}],"accessors":[{"bufferView":0,"componentType":5126,"count":)" + std::to_string(corners) +
                       R"(,"type":"VEC3"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}])"),
          positions));
  CHECK(soup.vertices.size() == known.size());
  Triangles triangles;
  for (size_t i = 0; i < corners; i += 3) {
    const std::array<uint32_t, 3> t{expected[i], expected[i + 1], expected[i + 2]};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
  }
  CHECK(soup.triangles == triangles);
}

TEST_CASE("glTF: indices of 8, 16 and 32 bits, and strips and fans without indices, are triangles",
          "[mesh_file][unit]") {
  const Triangles square = {{0, 1, 2}, {2, 1, 3}};
  CHECK(indexed_square<uint8_t>(5121, {0, 1, 2, 2, 1, 3}).triangles == square);
  CHECK(indexed_square<uint16_t>(5123, {0, 1, 2, 2, 1, 3}).triangles == square);
  CHECK(indexed_square<uint32_t>(5125, {0, 1, 2, 2, 1, 3}).triangles == square);
  const auto with_mode = [&](const std::string& mode) {
    return read_text_as("glb", glb(document(48, square_views(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},)"
                                                             R"("mode":)" +
                                                             mode + "}]}]")),
                                   kSquare));
  };
  CHECK(with_mode("5").triangles == Triangles{{0, 1, 2}, {1, 3, 2}});
  CHECK(with_mode("6").triangles == Triangles{{0, 1, 2}, {0, 2, 3}});
  CHECK(error_of([&] { with_mode("0"); }).code() == ErrorCode::nothing_to_mesh);
  CHECK(error_of([&] { with_mode("4"); }).code() == ErrorCode::unreadable_input);  // four corners
}

TEST_CASE("glTF: nodes put their meshes where their ancestors' transforms say, and mirrored ones stay outward",
          "[mesh_file][unit]") {
  const TriangleSoup soup = read_text_as(
      "glb", glb(document(48, square_views(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":5}]}],)"
                                           R"("nodes":[{"children":[1,2],"translation":[1e6,0,0]},)"
                                           R"({"mesh":0,"scale":[2,1,1],"rotation":[0,0,0.7071067811865476,)"
                                           R"(0.7071067811865476]},)"
                                           R"({"mesh":0,"matrix":[-1,0,0,0,0,1,0,0,0,0,1,0,0,0,5,1]}],)"
                                           R"("scene":0,"scenes":[{"nodes":[0]}])")),
                 kSquare));
  REQUIRE(soup.vertices.size() == 8);
  CHECK(std::abs(soup.vertices[1].x - 1e6) < 1e-9);
  CHECK(std::abs(soup.vertices[1].y - 2) < 1e-12);
  CHECK(same_bits(soup.vertices[5], {1e6 - 1, 0, 5}));
  CHECK(soup.triangles == Triangles{{0, 1, 2}, {1, 3, 2}, {4, 6, 5}, {5, 6, 7}});
}

TEST_CASE("glTF: the scene of the file is read, else its first, else all nodes, else all meshes", "[mesh_file][unit]") {
  const std::string mesh = R"({"primitives":[{"attributes":{"POSITION":0},"mode":5}]})";
  const auto vertices_of = [&](const std::string& members) {
    return read_text_as("glb",
                        glb(document(48, square_views(R"("meshes":[)" + mesh + "," + mesh + "]" + members)), kSquare))
        .vertices;
  };
  const std::string nodes = R"(,"nodes":[{"mesh":0,"translation":[1,0,0]},{"mesh":1,"translation":[2,0,0]}])";
  CHECK(vertices_of("").size() == 8);
  CHECK(vertices_of(nodes).size() == 8);
  const std::string scenes = nodes + R"(,"scenes":[{"nodes":[1]},{"nodes":[0]}])";
  CHECK(vertices_of(scenes).at(0).x == 2);
  CHECK(vertices_of(scenes + R"(,"scene":1)").at(0).x == 1);
  CHECK(vertices_of(scenes).size() == 4);
}

TEST_CASE("glTF: quantised positions are whole numbers, or parts of the largest where they are normalised",
          "[mesh_file][unit]") {
  const std::string binary = bytes_of<int16_t>({0, 0, 0, 0, 32767, 0, 0, 0, 0, -32768, 0, 0, 3, 4, 5, 0});
  const auto read = [&](const std::string& more) {
    return read_text_as(
        "glb",
        glb(document(32, R"("extensionsRequired":["KHR_mesh_quantization","KHR_texture_transform"],"bufferViews":[)"
                         R"({"buffer":0,"byteLength":32,"byteStride":8}],"accessors":[{"bufferView":0,)"
                         R"("componentType":5122,"count":4,"type":"VEC3")" +
                             more +
                             R"(}],"nodes":[{"mesh":0,"scale":[2,1,1]}],"meshes":[{"primitives":[{"attributes":)"
                             R"({"POSITION":0},"mode":5}]}])"),
            binary));
  };
  CHECK(same_bits(read("").vertices[3], {6, 4, 5}));
  CHECK(same_bits(read(R"(,"normalized":true)").vertices[1], {2, 0, 0}));
  CHECK(same_bits(read(R"(,"normalized":true)").vertices[2], {0, -1, 0}));
}

TEST_CASE("glTF: what is not read is counted or dropped, and the rest is read", "[mesh_file][unit]") {
  const TriangleSoup soup = read_text_as(
      "glb", glb(document(48, R"("bufferViews":[{"buffer":0,"byteLength":48}],"accessors":[)"
                              R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
                              R"({"bufferView":0,"componentType":5121,"count":4,"type":"MAT2"}],"meshes":[)"
                              R"({"primitives":[{"attributes":{"POSITION":0,"_PAIRS":1,"JOINTS_0":0},"mode":5}]},)"
                              R"({"primitives":[{"attributes":{"POSITION":0},"mode":5,"targets":[{"POSITION":0}]},)"
                              R"({"attributes":{"POSITION":0},"mode":0},{"attributes":{}}]}],)"
                              R"("nodes":[{"mesh":0,"skin":0},{"mesh":1},{"mesh":0}])"),
                 kSquare));
  CHECK(soup.triangles.size() == 6);
  CHECK(soup.dirt.posed_meshes == 2);
  CHECK(soup.dirt.other_primitives == 2);
  REQUIRE(soup.dropped_attributes.size() == 2);
  CHECK(soup.dropped_attributes[0].name == "JOINTS_0");
  CHECK(soup.dropped_attributes[1].name == "_PAIRS");
}

TEST_CASE("glTF: interleaved views, sparse replacements and normalised integers have their values",
          "[mesh_file][unit]") {
  std::string binary;
  for (int i = 0; i < 4; ++i)
    binary += kSquare.substr(size_t(12 * i), 12) + bytes_of<uint8_t>({uint8_t(i), 10, 255, 0});
  binary += bytes_of<uint8_t>({3, 0, 0, 0}) + bytes_of<float>({7, 8, 9});
  const TriangleSoup soup = read_text_as(
      "glb",
      glb(document(binary.size(),
                   R"("bufferViews":[{"buffer":0,"byteLength":64,"byteStride":16},)"
                   R"({"buffer":0,"byteOffset":64,"byteLength":4},{"buffer":0,"byteOffset":68,"byteLength":12}],)"
                   R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":1,)"
                   R"("indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":2}}},)"
                   R"({"bufferView":0,"byteOffset":12,"componentType":5121,"normalized":true,"count":4,"type":"VEC3"},)"
                   R"({"bufferView":0,"byteOffset":12,"componentType":5121,"normalized":true,"count":4,"type":"VEC2"})"
                   R"(],"materials":[{"name":"red"},{}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,)"
                   R"("COLOR_0":1,"TEXCOORD_0":2},"mode":5,"material":1}]}])"),
          binary));
  CHECK(same_bits(soup.vertices[3], {7, 8, 9}));
  CHECK(same_bits(soup.vertices[1], {1, 0, 0}));
  REQUIRE(find(soup, kColorName) != nullptr);
  CHECK(find(soup, kColorName)->type == NumberType::u8);
  CHECK(find(soup, kColorName)->values == std::vector<double>{0, 10, 255, 1, 10, 255, 2, 10, 255, 3, 10, 255});
  REQUIRE(find(soup, kUvName) != nullptr);
  CHECK(find(soup, kUvName)->values[2] == 1.0 / 255);
  CHECK(find(soup, kUvName)->index == std::vector<uint32_t>{0, 1, 2, 1, 3, 2});
  REQUIRE(find(soup, kMaterialName) != nullptr);
  CHECK(find(soup, kMaterialName)->labels == std::vector<std::string>{"red", "material_1"});
  CHECK(find(soup, kMaterialName)->values == std::vector<double>{1, 1});
}

TEST_CASE("glTF: buffers come from data in the file and from files beside it, and from nowhere else",
          "[mesh_file][unit]") {
  const TemporaryFolder folder;
  put_file(folder / "a b.bin", kSquare);
  put_file(folder / "a:b.bin", kSquare);
  const auto read = [&](const std::string& uri) {
    put_file(folder / "a.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":48,"uri":")" + uri + "\"}]," +
                                    square_views(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},)"
                                                 R"("mode":5}]}]})"));
    return read_mesh(folder / "a.gltf");
  };
  CHECK(read("a%20b.bin").vertices.size() == 4);
  CHECK(read("a%3Ab.bin").vertices.size() == 4);
  CHECK(read("data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAACAPwAAgD8AAAAA")
            .vertices.size() == 4);
  for (const char* uri : {"missing.bin", "../a.bin", "/etc/passwd", "http://a/b.bin", "file:///etc/passwd", "%2e%2e/a",
                          "a/../../a", "a%2", "data:,abc", "data:;base64,AAAA", "data:;base64,A*AA", ""}) {
    INFO(uri);
    const Error error = error_of([&] { read(uri); });
    CHECK(error.code() == ErrorCode::unreadable_input);
    CHECK(says(error, "buffers[0]"));
  }
}

TEST_CASE("glTF: what a file promises and does not hold is refused with its place", "[mesh_file][unit]") {
  const auto refusal = [](const std::string& members) {
    const Error error = error_of([&] { read_text_as("glb", glb(document(48, members), kSquare)); });
    CHECK(error.code() == ErrorCode::unreadable_input);
    return std::string(error.what());
  };
  const auto accessor = [&](const std::string& text, const std::string& view = R"("byteLength":48)") {
    return refusal(R"("bufferViews":[{"buffer":0,)" + view + R"(}],"accessors":[{)" + text +
                   R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":5}]}])");
  };
  const std::string sound = R"("bufferView":0,"componentType":5126,"type":"VEC3","count":)";
  const auto check_names = [](const std::string& text, const std::string& part) {
    INFO(text);
    CHECK(text.find(part) != std::string::npos);
  };
  check_names(accessor(sound + "5"), "accessors[0]");
  check_names(accessor(sound + "9007199254740992"), "accessors[0]");
  check_names(accessor(sound + "18446744073709551615"), "accessors[0].count");
  check_names(accessor(sound + "-1"), "accessors[0].count");
  check_names(accessor(sound + "\"4\""), "accessors[0].count");
  check_names(accessor(sound + R"(4,"byteOffset":4)"), "accessors[0]");
  check_names(accessor(sound + R"(4,"byteOffset":9007199254740992)"), "accessors[0]");
  check_names(accessor(sound + "4", R"("byteLength":49)"), "bufferViews[0]");
  check_names(accessor(sound + "4", R"("byteLength":48,"byteOffset":9007199254740992)"), "bufferViews[0]");
  check_names(accessor(sound + "4", R"("byteLength":48,"byteStride":8)"), "byteStride");
  check_names(accessor(sound + "4", R"("byteLength":48,"byteStride":1000)"), "byteStride");
  check_names(accessor(R"("componentType":5126,"type":"VEC3","count":1000000)"), "accessors[0].count");
  check_names(accessor(R"("bufferView":7,"componentType":5126,"type":"VEC3","count":4)"), "bufferView");
  check_names(accessor(R"("bufferView":0,"componentType":5130,"type":"VEC3","count":4)"), "componentType");
  check_names(accessor(R"("bufferView":0,"componentType":5126,"type":"MAT5","count":4)"), "type");
  check_names(refusal(R"("extensionsRequired":["KHR_node_visibility"])"), "KHR_node_visibility");
  CHECK(read_text_as("glb",
                     glb(document(48, square_views(R"("extras":")" + std::string(1000, '[') +
                                                   R"(\"[","meshes":)"
                                                   R"([{"primitives":[{"attributes":{"POSITION":0},"mode":5}]}])")),
                         kSquare))
            .vertices.size() == 4);
  check_names(refusal(R"("extras":)" + std::string(100000, '[') + std::string(100000, ']')), "nested");
  check_names(refusal(R"("asset":{"version":"2.1","minVersion":"2.1"})"), "minVersion");
  check_names(refusal(R"("nodes":[{"children":[0]}],"scenes":[{"nodes":[0]}])"), "nodes[0]");
  check_names(refusal(R"("nodes":[{"mesh":3}])"), "nodes[0].mesh");
  const Error index = error_of([] { indexed_square<uint16_t>(5123, {0, 1, 4}); });
  CHECK(says(index, "accessors[1], element 2, is 4"));
  std::string short_promise = glb(document(48, square_views(R"("meshes":[])")), kSquare);
  short_promise.replace(8, 4, u32(12));
  CHECK(says(error_of([&] { read_text_as("glb", short_promise); }), "promises 12 bytes"));
  for (const size_t bytes : {size_t(3), size_t(12), size_t(30), size_t(100)}) {
    const std::string whole = glb(document(48, square_views(R"("meshes":[])")), kSquare);
    CHECK(error_of([&] { read_text_as("glb", whole.substr(0, bytes)); }).code() == ErrorCode::unreadable_input);
  }
}

TEST_CASE("glTF: written meshes come back, also far from the origin and split at the jumps of corners",
          "[mesh_file][unit]") {
  const TemporaryFolder folder;
  for (const std::string name : {"a.glb", "a.gltf"}) {
    const TriangleSoup torus = shapes::torus(3, 1, 50, 30);
    TriangleMesh mesh{torus.vertices, torus.triangles};
    for (WorldPoint& p : mesh.vertices) p = {double(float(p.x)), double(float(p.y)), double(float(p.z))};
    mesh.attributes.push_back({kMaterialName, NumberType::i32, 1, {}, AttributeDomain::face, {}, {"clay", "gold"}});
    for (size_t t = 0; t < mesh.triangles.size(); ++t) mesh.attributes[0].values.push_back(t < 700 ? 0 : 1);
    Attribute uv{kUvName, NumberType::f32, 2, {0, 0, .5, .25}, AttributeDomain::corner};
    for (size_t c = 0; c < 3 * mesh.triangles.size(); ++c) uv.index.push_back(c < 900 ? 0 : 1);
    mesh.attributes.push_back(uv);
    Attribute heat{"heat", NumberType::f32, 1, {}};
    for (size_t v = 0; v < mesh.vertices.size(); ++v) heat.values.push_back(double(v));
    mesh.attributes.push_back(heat);
    write_mesh(folder / name, mesh);
    const TriangleSoup back = read_mesh(folder / name);
    REQUIRE(back.vertices.size() == mesh.vertices.size());
    for (size_t v = 0; v < mesh.vertices.size(); ++v) REQUIRE(same_bits(back.vertices[v], mesh.vertices[v]));
    CHECK(back.triangles == mesh.triangles);
    REQUIRE(find(back, kMaterialName) != nullptr);
    CHECK(find(back, kMaterialName)->values == mesh.attributes[0].values);
    CHECK(find(back, kMaterialName)->labels == mesh.attributes[0].labels);
    REQUIRE(find(back, "_heat") != nullptr);
    CHECK(find(back, "_heat")->values == heat.values);
    REQUIRE(find(back, kUvName) != nullptr);
    const Attribute& read = *find(back, kUvName);
    for (size_t c = 0; c < uv.index.size(); ++c) REQUIRE(read.values[2 * read.index[c]] == uv.values[2 * uv.index[c]]);

    for (WorldPoint& p : mesh.vertices) p.x += 1e6;
    write_mesh(folder / name, mesh, {"", true});
    const TriangleSoup far = read_mesh(folder / name);
    REQUIRE(far.vertices.size() == mesh.vertices.size());
    for (size_t v = 0; v < mesh.vertices.size(); ++v) REQUIRE(std::abs(far.vertices[v].x - mesh.vertices[v].x) < 1e-6);
  }
}

TEST_CASE("glTF: materials pass from file to file with their textures, images and extensions", "[mesh_file][unit]") {
  const TemporaryFolder folder;
  const std::string binary = kSquare + "image";
  put_file(folder / "a.glb",
           glb(document(binary.size(),
                        R"("extensionsUsed":["KHR_texture_transform","KHR_xmp"],"extensionsRequired":["KHR_xmp",)"
                        R"("KHR_texture_transform"],"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,)"
                        R"("byteOffset":48,"byteLength":5}],"accessors":[{"bufferView":0,"componentType":5126,)"
                        R"("count":4,"type":"VEC3"}],"images":[{"bufferView":1,"mimeType":"image/png"},)"
                        R"({"uri":"../b.png"}],"samplers":[{"wrapS":33071}],"textures":[{"source":0,"sampler":0}],)"
                        R"("materials":[{"name":"a"},{"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1],)"
                        R"("baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":{"scale":[2,2]}}}}}],)"
                        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":5,"material":1}]}])"),
               binary));
  for (const std::string name : {"b.glb", "b.gltf"}) {
    const TriangleSoup first = read_mesh(folder / "a.glb");
    TriangleMesh mesh{first.vertices, first.triangles};
    mesh.attributes = first.attributes;
    mesh.files = first.files;
    write_mesh(folder / name, mesh);
    const TriangleSoup second = read_mesh(folder / name);
    CHECK(second.files.gltf_materials == first.files.gltf_materials);
    for (const char* part : {R"("uri":"data:image/png;base64,aW1hZ2U=")", R"("uri":"../b.png")", R"("wrapS":33071)",
                             R"("extensionsRequired":["KHR_texture_transform"])", R"("baseColorFactor":[1,0,0,1])"}) {
      INFO(part << " in " << first.files.gltf_materials);
      CHECK(first.files.gltf_materials.find(part) != std::string::npos);
    }
    CHECK(get_file(folder / name).find("KHR_xmp") == std::string::npos);
    mesh.attributes[0].labels.push_back("one more");
    CHECK(error_of([&] { write_mesh(folder / "c.glb", mesh); }).code() == ErrorCode::usage);
  }
}
