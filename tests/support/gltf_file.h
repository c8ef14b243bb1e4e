// glTF files for tests, made of views and accessors.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/file_formats.h"
#include "isoshell/error.h"

namespace isoshell {

/// Of one mesh, whose primitives the test puts in.
struct GltfFile {
  nlohmann::json json = {{"asset", {{"version", "2.0"}}},
                         {"buffers", {{{"byteLength", 0}}}},
                         {"bufferViews", nlohmann::json::array()},
                         {"accessors", nlohmann::json::array()},
                         {"meshes", {{{"primitives", nlohmann::json::array()}}}}};
  std::string binary;

  size_t view(const std::string& bytes, size_t stride = 0) {
    binary.resize((binary.size() + 3) / 4 * 4);
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes.size()}});
    if (stride > 0) json["bufferViews"].back()["byteStride"] = stride;
    binary += bytes;
    return json["bufferViews"].size() - 1;
  }

  size_t accessor(int component, size_t count, const char* type, const nlohmann::json& more = {}) {
    json["accessors"].push_back({{"componentType", component}, {"count", count}, {"type", type}});
    if (!more.is_null()) json["accessors"].back().update(more);
    return json["accessors"].size() - 1;
  }

  nlohmann::json& primitive(const nlohmann::json& primitive) {
    json["meshes"][0]["primitives"].push_back(primitive);
    return json["meshes"][0]["primitives"].back();
  }

  std::string glb() const {
    nlohmann::json all = json;
    all["buffers"][0]["byteLength"] = binary.size();
    std::string text = all.dump(), chunk = binary;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    chunk.resize((chunk.size() + 3) / 4 * 4);
    const auto u32 = [](size_t value) {
      std::string bytes;
      for (int i = 0; i < 4; ++i) bytes += char(value >> 8 * i & 0xff);
      return bytes;
    };
    return "glTF" + u32(2) + u32(28 + text.size() + chunk.size()) + u32(text.size()) + "JSON" + text +
           u32(chunk.size()) + std::string("BIN\0", 4) + chunk;
  }
};

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// From an allocation of exactly this size, so that a look beyond it is seen by a memory checker.
inline TriangleSoup read_glb(const std::string& bytes) {
  const std::vector<char> exact(bytes.begin(), bytes.end());
  return find_row("gltf")->read(MeshSource("memory", {exact.data(), int64_t(exact.size())}));
}

/// Reads a file with one byte changed, many times: every result is a sound soup or an error of what is read.
/// The changes are those of [first, end) of its bytes. Result: how many came back as soups.
template <class Random>
int64_t read_damaged(const std::string& glb, size_t first, size_t end, int rounds, Random random) {
  int64_t survivors = 0;
  for (int round = 0; round < rounds; ++round) {
    std::string bytes = glb;
    const uint64_t r = random(uint64_t(round));
    const size_t at = first + size_t(r >> 16) % (end - first);
    bytes[at] = r % 2 == 0 ? char(bytes[at] ^ 1 << (r >> 8) % 8) : char(r >> 8);
    try {
      const TriangleSoup soup = read_glb(bytes);
      for (const auto& t : soup.triangles)
        for (const uint32_t corner : t)
          if (corner >= soup.vertices.size()) return -1;
      ++survivors;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::nothing_to_mesh && error.code() != ErrorCode::unreadable_input) return -1;
    }
  }
  return survivors;
}

}  // namespace isoshell
