#include "io/mesh/gltf_primitives.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <functional>
#include <map>

#include "core/parallel_ranges.h"

namespace isoshell {
namespace {

using Json = GltfDocument::Json;

constexpr int64_t kGrain = 1 << 14;
constexpr int64_t kMaxSoupTriangles = 0xffffffff / 3;  // corners have 32-bit numbers

enum Mode : int64_t { kTriangles = 4, kStrip = 5, kFan = 6 };

void add_instance(const GltfDocument& document, const GltfInstance& instance, GltfContent& content) {
  const std::string mesh_place = "meshes[" + std::to_string(instance.mesh) + "]";
  const Json& mesh = document.element("meshes", instance.mesh, mesh_place);
  std::map<std::string, size_t> known;
  const Json& primitives = document.list(mesh, "primitives", mesh_place);
  bool is_posed = instance.has_skin;
  for (size_t i = 0; i < primitives.size(); ++i) {
    const std::string place = mesh_place + ".primitives[" + std::to_string(i) + "]";
    const Json& primitive = primitives[i];
    if (!primitive.is_object()) document.refuse(place, " is no object; restore the file");
    const int64_t mode = document.integer(primitive, "mode", place).value_or(kTriangles);
    if (mode > kFan) document.refuse(place + ".mode", " is " + std::to_string(mode) + "; it must be from 0 to 6");
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object())
      document.refuse(place, " has no attributes; restore the file");
    const auto position = document.integer(*attributes, "POSITION", place + ".attributes");
    if (mode < kTriangles || !position) {
      ++content.other_primitives;
      continue;
    }
    const std::string key = attributes->dump(-1, ' ', true, Json::error_handler_t::replace);
    const auto [at, is_new] = known.emplace(key, content.vertices.size());
    if (is_new) {
      const GltfAccessor a = document.accessor(*position, place + ".attributes.POSITION");
      if (a.components != 3 || a.type == NumberType::u32)
        document.refuse(a.place,
                        " holds no positions; they are VEC3, of componentType 5126 or quantised to 5120 to 5123");
      const int64_t first = content.first_vertex.back();
      if (a.count > kMaxSoupVertices - first)
        document.source().refuse("holds more than " + std::to_string(kMaxSoupVertices) +
                                 " vertices, the most that can be read; split the file");
      content.vertices.push_back({&*attributes, place + ".attributes", &instance.to_world, first, a.count});
      content.first_vertex.back() += a.count;
    }
    is_posed |= primitive.contains("targets");
    content.primitives.push_back({at->second, mode, document.integer(primitive, "indices", place),
                                  document.integer(primitive, "material", place), place});
  }
  content.posed_meshes += is_posed;
}

/// Corner k of triangle t of a primitive.
int64_t place_of(int64_t mode, int64_t t, int k) {
  if (mode == kTriangles) return 3 * t + k;
  if (mode == kFan) return k == 0 ? 0 : t + k;
  return t + (t % 2 == 0 || k == 0 ? k : 3 - k);  // every second triangle of a strip is turned
}

/// Triangles with equal corners are a strip's way to turn a corner, not dirt.
bool turns_a_corner(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

/// The numbers of the primitive's own vertices; `out` has room for them.
void read_checked_indices(const GltfDocument& document, const GltfAccessor& a, int64_t vertices, uint32_t* out) {
  read_indices(document, a, out);
  const auto is_wrong = [&](uint32_t i) { return i >= vertices; };
  const bool has_wrong = tbb::parallel_reduce(
      tbb::blocked_range<int64_t>(0, a.count, kGrain), false,
      [&](const tbb::blocked_range<int64_t>& r, bool found) {
        return found || std::any_of(out + r.begin(), out + r.end(), is_wrong);
      },
      std::logical_or<bool>());
  if (!has_wrong) return;
  const uint32_t* const wrong = std::find_if(out, out + a.count, is_wrong);
  document.refuse(a.place, ", element " + std::to_string(wrong - out) + ", is " + std::to_string(*wrong) +
                               "; the primitive has " + std::to_string(vertices) + " vertices");
}

void add_triangles(const GltfDocument& document, const GltfContent& content, const GltfPrimitive& primitive,
                   std::vector<Triangle>& out) {
  const GltfVertices& vertices = content.vertices[primitive.vertices];
  std::optional<GltfAccessor> indices;
  if (primitive.indices) indices = document.accessor(*primitive.indices, primitive.place + ".indices");
  const int64_t corners = indices ? indices->count : vertices.count;
  const bool is_list = primitive.mode == kTriangles;
  if (is_list && corners % 3 != 0)
    document.refuse(primitive.place, " has " + std::to_string(corners) + " corners; triangles need a multiple of 3");
  const int64_t count = is_list ? corners / 3 : std::max<int64_t>(corners - 2, 0);
  const size_t first = out.size();
  if (count > kMaxSoupTriangles - int64_t(first))
    document.source().refuse("holds more than " + std::to_string(kMaxSoupTriangles) +
                             " triangles, the most that can be read; split the file");
  out.resize(first + size_t(count));
  std::vector<uint32_t> of_strip(indices && !is_list ? size_t(corners) : 0);
  uint32_t* const index = is_list ? reinterpret_cast<uint32_t*>(out.data() + first) : of_strip.data();
  if (indices) read_checked_indices(document, *indices, vertices.count, index);
  const bool mirrors = vertices.to_world->mirrors();
  if (is_list && indices && vertices.first == 0 && !mirrors) return;
  for_ranges(count, kGrain, [&](int64_t begin, int64_t end) {
    for (int64_t t = begin; t < end; ++t) {
      Triangle& triangle = out[first + size_t(t)];
      for (int k = 0; k < 3; ++k) {
        const int64_t at = place_of(primitive.mode, t, k);
        triangle[size_t(k)] = uint32_t(vertices.first + (indices ? index[at] : at));
      }
      if (mirrors) std::swap(triangle[1], triangle[2]);
    }
  });
  if (primitive.mode == kStrip)
    out.erase(std::remove_if(out.begin() + int64_t(first), out.end(), turns_a_corner), out.end());
}

}  // namespace

std::optional<GltfAccessor> GltfVertices::find(const GltfDocument& document, const std::string& semantic) const {
  const auto index = document.integer(*attributes, semantic.c_str(), place);
  if (!index) return {};
  GltfAccessor a = document.accessor(*index, place + "." + semantic);
  if (a.count != count)
    document.refuse(
        a.place, " has " + std::to_string(a.count) + " elements; " + place + ".POSITION has " + std::to_string(count));
  return a;
}

GltfContent content_of(const GltfDocument& document) {
  GltfContent content;
  content.instances = instances_of(document);
  content.first_vertex = {0};
  for (const GltfInstance& instance : content.instances) {
    content.first_vertex.push_back(content.first_vertex.back());
    add_instance(document, instance, content);
  }
  return content;
}

GltfTriangles triangles_of(const GltfDocument& document, const GltfContent& content) {
  GltfTriangles triangles;
  bool has_material = false;
  for (const GltfPrimitive& primitive : content.primitives) has_material |= primitive.material.has_value();
  for (const GltfPrimitive& primitive : content.primitives) {
    add_triangles(document, content, primitive, triangles.corners);
    if (primitive.material) document.element("materials", *primitive.material, primitive.place + ".material");
    if (has_material)
      triangles.material.resize(triangles.corners.size(), primitive.material ? double(*primitive.material) : -1);
  }
  return triangles;
}

}  // namespace isoshell
