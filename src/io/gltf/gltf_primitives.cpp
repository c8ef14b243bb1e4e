#include "io/gltf/gltf_primitives.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "core/parallel_ranges.h"

namespace isoshell {
namespace {

using Json = GltfDocument::Json;

constexpr int64_t kGrain = 1 << 14;
constexpr int64_t kBytesPerPlace = 128;                // of the texts that say where something stands
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
      GltfAccessor a = document.accessor(*position, place + ".attributes.POSITION");
      if (a.components != 3 || a.type == NumberType::u32)
        document.refuse(a.place,
                        " holds no positions; they are VEC3, of componentType 5126 or quantised to 5120 to 5123");
      const int64_t first = content.first_vertex.back();
      document.source().take(kBytesPerPlace);
      make_room(document.source(), content.vertices, 1);
      if (a.count > kMaxSoupVertices - first)
        document.source().refuse("holds more than " + std::to_string(kMaxSoupVertices) +
                                 " vertices, the most that can be read; split the file");
      content.vertices.push_back(
          {&*attributes, place + ".attributes", &instance.to_world, first, a.count, std::move(a)});
      content.first_vertex.back() += content.vertices.back().count;
    }
    is_posed |= primitive.contains("targets");
    const auto indices = document.integer(primitive, "indices", place);
    document.source().take(kBytesPerPlace);
    make_room(document.source(), content.primitives, 1);
    content.primitives.push_back({at->second, mode, indices, document.integer(primitive, "material", place), place});
    content.claimed_corners += indices ? document.claimed_count(*indices) : content.vertices[at->second].count;
  }
  content.posed_meshes += is_posed;
}

/// Corner k of triangle t of a strip or fan.
int64_t place_of(int64_t mode, int64_t t, int k) {
  if (mode == kFan) return k == 0 ? 0 : t + k;
  return t + (t % 2 == 0 || k == 0 ? k : 3 - k);  // every second triangle of a strip is turned
}

/// Triangles with equal corners are a strip's way to turn a corner, not dirt.
bool turns_a_corner(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

/// The numbers of the primitive's own vertices; `out` has room for them.
void read_checked_indices(const GltfDocument& document, const GltfAccessor& a, int64_t vertices, uint32_t* out) {
  read_indices(document, a, out);
  const auto is_wrong = [&](uint32_t i) { return i >= vertices; };
  const int64_t wrong_ones = sum_over_ranges(a.count, kGrain, [&](int64_t begin, int64_t end) {
    return int64_t(std::count_if(out + begin, out + end, is_wrong));
  });
  if (wrong_ones == 0) return;
  const uint32_t* const wrong = std::find_if(out, out + a.count, is_wrong);
  document.refuse(a.place, ", element " + std::to_string(wrong - out) + ", is " + std::to_string(*wrong) +
                               "; the primitive has " + std::to_string(vertices) + " vertices");
}

/// Triangles of primitives one behind the other. As long as they are those of all vertices in order, only their number
/// is kept.
class TriangleCollector {
 public:
  TriangleCollector(const GltfDocument& document, const GltfContent& content, GltfTriangles& triangles)
      : document_(document), content_(content), triangles_(triangles), out_(triangles.corners) {}

  void add(const GltfPrimitive& primitive) {
    const GltfVertices& vertices = content_.vertices[primitive.vertices];
    std::optional<GltfAccessor> indices;
    if (primitive.indices) indices = document_.accessor(*primitive.indices, primitive.place + ".indices");
    const int64_t corners = indices ? indices->count : vertices.count;
    const bool is_list = primitive.mode == kTriangles;
    if (is_list && corners % 3 != 0)
      document_.refuse(primitive.place, " has " + std::to_string(corners) + " corners; triangles need a multiple of 3");
    const int64_t count = is_list ? corners / 3 : std::max<int64_t>(corners - 2, 0);
    if (count > kMaxSoupTriangles - triangles_.count)
      document_.source().refuse("holds more than " + std::to_string(kMaxSoupTriangles) +
                                " triangles, the most that can be read; split the file");
    const bool mirrors = vertices.to_world->mirrors();
    if (is_list && !indices && !mirrors && out_.empty() && vertices.first == 3 * triangles_.count) {
      triangles_.count += count;
      return;
    }
    triangles_.write_out(document_.source());
    if (is_list)
      add_list(vertices, indices, count, mirrors);
    else
      add_run(vertices, indices, corners, primitive.mode, mirrors);
    triangles_.count = int64_t(out_.size());
  }

 private:
  void add_list(const GltfVertices& vertices, const std::optional<GltfAccessor>& indices, int64_t count, bool mirrors) {
    const size_t first = out_.size();
    resize_counted(document_.source(), out_, first + size_t(count));
    auto* const corner = reinterpret_cast<uint32_t*>(out_.data() + first);
    if (indices)
      read_checked_indices(document_, *indices, vertices.count, corner);
    else
      std::iota(corner, corner + 3 * count, 0);
    if (vertices.first == 0 && !mirrors) return;
    for_ranges(count, kGrain, [&](int64_t begin, int64_t end) {
      for (int64_t i = 3 * begin; i < 3 * end; ++i) corner[i] += uint32_t(vertices.first);
      for (int64_t t = begin; mirrors && t < end; ++t) std::swap(corner[3 * t + 1], corner[3 * t + 2]);
    });
  }

  /// Of a strip or fan.
  void add_run(const GltfVertices& vertices, const std::optional<GltfAccessor>& indices, int64_t corners, int64_t mode,
               bool mirrors) {
    const HeldBytes held(document_.source(), 4 * corners);
    std::vector<uint32_t> index(static_cast<size_t>(corners));
    make_room(document_.source(), out_, size_t(std::max<int64_t>(corners - 2, 0)));
    if (indices)
      read_checked_indices(document_, *indices, vertices.count, index.data());
    else
      std::iota(index.begin(), index.end(), 0);
    for (int64_t t = 0; t + 2 < corners; ++t) {
      Triangle triangle;
      for (int k = 0; k < 3; ++k) triangle[size_t(k)] = uint32_t(vertices.first) + index[size_t(place_of(mode, t, k))];
      if (mirrors) std::swap(triangle[1], triangle[2]);
      if (mode == kFan || !turns_a_corner(triangle)) out_.push_back(triangle);
    }
  }

  const GltfDocument& document_;
  const GltfContent& content_;
  GltfTriangles& triangles_;
  std::vector<Triangle>& out_;
};

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
  content.first_vertex = content.first_set = {0};
  for (const GltfInstance& instance : content.instances) {
    content.first_vertex.push_back(content.first_vertex.back());
    add_instance(document, instance, content);
    content.first_set.push_back(int64_t(content.vertices.size()));
  }
  return content;
}

void GltfTriangles::write_out(const MeshSource& source) {
  if (!corners.empty()) return;
  resize_counted(source, corners, size_t(count));
  auto* const first = reinterpret_cast<uint32_t*>(corners.data());
  std::iota(first, first + 3 * count, 0);
}

GltfTriangles triangles_of(const GltfDocument& document, const GltfContent& content) {
  GltfTriangles triangles;
  bool has_material = false;
  const bool has_indices = std::any_of(content.primitives.begin(), content.primitives.end(),
                                       [](const GltfPrimitive& primitive) { return primitive.indices.has_value(); });
  if (has_indices)
    make_room(document.source(), triangles.corners, size_t(std::min(content.claimed_corners, document.bytes()) / 3));
  for (const GltfPrimitive& primitive : content.primitives) has_material |= primitive.material.has_value();
  TriangleCollector collector(document, content, triangles);
  for (const GltfPrimitive& primitive : content.primitives) {
    collector.add(primitive);
    if (primitive.material) document.element("materials", *primitive.material, primitive.place + ".material");
    if (has_material)
      resize_counted(document.source(), triangles.material, size_t(triangles.count),
                     primitive.material ? double(*primitive.material) : -1.0);
  }
  return triangles;
}

}  // namespace isoshell
