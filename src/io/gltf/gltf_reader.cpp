// glTF: triangles of all meshes where their nodes put them, with colours, texture coordinates, normals, materials and
// numbers of vertices.

#include <algorithm>
#include <limits>

#include "core/parallel_ranges.h"
#include "io/bytes/mesh_source.h"
#include "io/faces/face_corners.h"
#include "io/faces/weld.h"
#include "io/gltf/gltf_materials.h"
#include "io/gltf/gltf_primitives.h"
#include "io/gltf/gltf_semantics.h"
#include "io/gltf/gltf_unpack.h"
#include "isoshell/surface_source.h"

namespace isoshell {
namespace {

using Json = GltfDocument::Json;
constexpr int64_t kGrain = 1 << 14;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

template <class Work>
void for_each_index(int64_t count, Work work) {
  for_ranges(count, kGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) work(i);
  });
}

/// Welds the vertices of an instance as they are stored, that is, in no more than single precision: in the file itself
/// where one accessor has them as floats. `index` gets those that they become.
void weld_instance(const GltfDocument& document, View<const GltfVertices> parts, VertexTable& vertices,
                   uint32_t* index) {
  if (parts.size == 1) {
    const GltfAccessor& a = parts[0].position;
    if (a.data && a.type == NumberType::f32 && a.replaced.count == 0)
      return weld_corners(document.source(), a.count, StridedCorners{a.data, a.stride}, vertices, index);
  }
  int64_t count = 0;
  for (const GltfVertices& part : parts) count += part.count;
  const HeldBytes held(document.source(), count * int64_t(sizeof(RawPosition<float>)));
  Buffer<RawPosition<float>> stored(count);
  for (const GltfVertices& part : parts)
    read_values(document, part.position, true, &(stored.data() + (part.first - parts[0].first))->x);
  weld_corners(document.source(), count, FloatCornerArray{stored.data()}, vertices, index);
}

/// Equal positions of an instance become one vertex; those of two instances stay apart. `index` is empty where all
/// vertices of the content are vertices of the result.
WeldedCorners weld(const GltfDocument& document, const GltfContent& content) {
  WeldedCorners all{VertexTable(document.source(), 0), {}};
  resize_counted(document.source(), all.index, size_t(content.first_vertex.back() + 2) / 3);
  auto* const index = reinterpret_cast<uint32_t*>(all.index.data());
  std::vector<WorldPoint>& points = all.vertices.points;
  bool is_moved = false;
  for (size_t i = 0; i < content.instances.size(); ++i) {
    const int64_t base = int64_t(points.size());
    weld_instance(document, content.vertices_of(i), all.vertices, index + content.first_vertex[i]);
    const GltfTransform& to_world = content.instances[i].to_world;
    if (to_world.is_identity) continue;
    is_moved = true;
    for_each_index(int64_t(points.size()) - base,
                   [&](int64_t v) { points[size_t(base + v)] = to_world.point(points[size_t(base + v)]); });
  }
  if (int64_t(points.size()) == content.first_vertex.back()) release(document.source(), all.index);
  if (is_moved) all.vertices.count_nonfinite();
  return all;
}

/// Those of all triangles, in vertices of the result. What is no longer needed, unless it `is_kept`, is moved.
std::vector<Triangle> triangles_of_vertices(const MeshSource& source, GltfTriangles& triangles, WeldedCorners& welded,
                                            bool is_kept) {
  if (is_kept) source.take(triangles.count * int64_t(sizeof(Triangle)));
  if (!welded.index.empty() && triangles.corners.empty()) return is_kept ? welded.index : std::move(welded.index);
  triangles.write_out(source);
  std::vector<Triangle> result = is_kept ? triangles.corners : std::move(triangles.corners);
  if (welded.index.empty()) return result;
  const auto* const vertex_of = reinterpret_cast<const uint32_t*>(welded.index.data());
  for_each_index(int64_t(result.size()), [&](int64_t t) {
    for (uint32_t& corner : result[size_t(t)]) corner = vertex_of[corner];
  });
  return result;
}

/// What an attribute of primitives is kept as; an empty name: it is not kept, and why.
struct KeptAs {
  std::string name, reason;
  AttributeDomain domain = AttributeDomain::vertex;
  int32_t least = 1, most = 1;  ///< components
};

KeptAs kept_as(const std::string& semantic) {
  if (const std::string name = name_of_semantic(semantic); !name.empty()) {
    const AttributeMeaning& meaning = *meaning_of(name);
    return {name, "", meaning.domain, meaning.least_components, meaning.most_components};
  }
  if (semantic == "_GAP") return {"", "the result has its own flag of that name"};
  const bool is_word = std::all_of(semantic.begin(), semantic.end(), [](unsigned char c) { return c > ' '; });
  if (semantic.size() < 2 || semantic[0] != '_' || !is_word) return {"", "glTF attributes of this kind are not kept"};
  return {semantic, "", AttributeDomain::vertex, 1, 1};
}

class AttributeReader {
 public:
  AttributeReader(const GltfDocument& document, const GltfContent& content, const GltfTriangles& triangles,
                  const std::vector<uint32_t>& face_of, const std::vector<Triangle>& welded, TriangleSoup& soup)
      : document_(document),
        content_(content),
        triangles_(triangles),
        face_of_(face_of),
        welded_(welded),
        soup_(soup) {}

  void read() {
    std::vector<std::string> semantics;
    for (const GltfVertices& vertices : content_.vertices)
      for (const auto& [semantic, index] : vertices.attributes->items())
        if (semantic != "POSITION" && std::find(semantics.begin(), semantics.end(), semantic) == semantics.end())
          semantics.push_back(semantic);
    for (const std::string& semantic : semantics) {
      const KeptAs kept = kept_as(semantic);
      const std::string reason = kept.name.empty() ? kept.reason : add(semantic, kept);
      if (!reason.empty()) soup_.dropped_attributes.push_back({semantic, reason});
    }
  }

 private:
  /// Result: why it is not kept; empty if it is.
  std::string add(const std::string& semantic, const KeptAs& kept) {
    std::vector<std::optional<GltfAccessor>> accessors;
    Attribute attribute{kept.name, NumberType::f32, 0, {}, kept.domain};
    bool is_integer = true, is_everywhere = true;
    for (const GltfVertices& vertices : content_.vertices) {
      accessors.push_back(vertices.find(document_, semantic));
      const auto& a = accessors.back();
      is_everywhere &= a.has_value();
      if (!a) continue;
      if (a->components < kept.least || a->components > kept.most)
        return "it has " + std::to_string(a->components) + " components, and is kept with " + std::to_string(kept.most);
      const bool is_first = attribute.components == 0;
      is_integer &=
          (kept.name == kColorName ? a->normalized && (a->type == NumberType::u8 || a->type == NumberType::u16)
                                   : !a->normalized && a->type != NumberType::f32) &&
          (is_first || a->type == attribute.type);
      if (is_first) attribute.type = a->type;
      attribute.components = std::max(attribute.components, a->components);
    }
    if (!is_everywhere && kept.domain == AttributeDomain::vertex && kept.name != kColorName)
      return "not all meshes have it";
    is_integer &= kept.domain == AttributeDomain::vertex;
    if (!is_integer) attribute.type = NumberType::f32;
    const double white = is_integer ? (attribute.type == NumberType::u8 ? 255 : 65535) : 1;
    fill(accessors, !is_integer, kept.domain == AttributeDomain::corner ? kNone : white, attribute);
    if (kept.name == kNormalName) turn_normals(attribute.values);
    if (kept.domain == AttributeDomain::vertex)
      keep_first_of_welded(attribute);
    else
      name_corners(attribute);
    soup_.attributes.push_back(std::move(attribute));
    return "";
  }

  void fill(const std::vector<std::optional<GltfAccessor>>& accessors, bool scaled, double missing,
            Attribute& attribute) const {
    const auto components = size_t(attribute.components);
    resize_counted(document_.source(), attribute.values, size_t(content_.first_vertex.back()) * components, missing);
    for (size_t i = 0; i < accessors.size(); ++i) {
      if (!accessors[i]) continue;
      double* const out = attribute.values.data() + size_t(content_.vertices[i].first) * components;
      const auto have = size_t(accessors[i]->components);
      if (have == components) {
        read_values(document_, *accessors[i], scaled, out);
        continue;
      }
      const HeldBytes held(document_.source(), accessors[i]->count * int64_t(have * sizeof(double)));
      std::vector<double> values(size_t(accessors[i]->count) * have);
      read_values(document_, *accessors[i], scaled, values.data());
      for_each_index(accessors[i]->count,
                     [&](int64_t v) { std::copy_n(&values[size_t(v) * have], have, out + size_t(v) * components); });
    }
  }

  void turn_normals(std::vector<double>& values) const {
    for (const GltfVertices& vertices : content_.vertices)
      if (!vertices.to_world->is_identity)
        for_each_index(vertices.count, [&](int64_t v) {
          double* const n = &values[3 * size_t(vertices.first + v)];
          const WorldPoint turned = vertices.to_world->normal({n[0], n[1], n[2]});
          n[0] = turned.x, n[1] = turned.y, n[2] = turned.z;
        });
  }

  /// A vertex has the value of the first of those that became it.
  void keep_first_of_welded(Attribute& attribute) const {
    if (welded_.empty()) return;
    const auto* const vertex_of = reinterpret_cast<const uint32_t*>(welded_.data());
    const auto components = size_t(attribute.components);
    std::vector<double> values;
    resize_counted(document_.source(), values, soup_.vertices.size() * components);
    for (auto v = size_t(content_.first_vertex.back()); v-- > 0;)
      std::copy_n(&attribute.values[v * components], components, &values[vertex_of[v] * components]);
    attribute.values.swap(values);
    release(document_.source(), values);
  }

  /// By the vertices of the content, which are those of the triangles where none were welded.
  void name_corners(Attribute& attribute) const {
    if (welded_.empty()) return spread_to_corners(document_.source(), soup_.triangles, attribute);
    resize_counted(document_.source(), attribute.index, 3 * face_of_.size());
    for_each_index(int64_t(face_of_.size()), [&](int64_t t) {
      const Triangle corners = triangles_.at(face_of_[size_t(t)]);
      std::copy(corners.begin(), corners.end(), attribute.index.begin() + 3 * t);
    });
  }

  const GltfDocument& document_;
  const GltfContent& content_;
  const GltfTriangles& triangles_;
  const std::vector<uint32_t>& face_of_;
  const std::vector<Triangle>& welded_;  ///< the vertices that those of the content became; empty: all are kept
  TriangleSoup& soup_;
};

void add_materials(const GltfDocument& document, const std::vector<double>& of_corners,
                   const std::vector<uint32_t>& face_of, TriangleSoup& soup) {
  if (of_corners.empty()) return;
  Attribute material{kMaterialName, NumberType::i32, 1, {}, AttributeDomain::face};
  const Json& all = document.list(document.json(), "materials");
  for (size_t i = 0; i < all.size(); ++i) {
    const Json& object = document.element("materials", int64_t(i), "materials[" + std::to_string(i) + "]");
    const auto name = object.find("name");
    const bool is_named = name != object.end() && name->is_string() && !name->get_ref<const std::string&>().empty();
    material.labels.push_back(is_named ? name->get<std::string>() : "material_" + std::to_string(i));
  }
  resize_counted(document.source(), material.values, face_of.size());
  for_each_index(int64_t(face_of.size()),
                 [&](int64_t t) { material.values[size_t(t)] = of_corners[face_of[size_t(t)]]; });
  soup.attributes.push_back(std::move(material));
  soup.files.gltf_materials = gltf_materials_of(document);
}

/// What the writer says of regions, in extras that other programs drop, is not read.
void note_regions(const GltfDocument& document, TriangleSoup& soup) {
  for (const Json& mesh : document.list(document.json(), "meshes")) {
    const auto extras = mesh.is_object() ? mesh.find("extras") : mesh.end();
    if (!mesh.is_object() || extras == mesh.end() || !extras->is_object() || !extras->contains("region_background"))
      continue;
    soup.dropped_attributes.push_back({"regions", "glTF files are read without them; PLY files keep them"});
    return;
  }
}

}  // namespace

TriangleSoup read_gltf(const MeshSource& source) {
  GltfDocument document(source);
  unpack(document);
  const GltfContent content = content_of(document);
  GltfTriangles triangles = triangles_of(document, content);
  if (triangles.count == 0 && content.other_primitives > 0)
    source.nothing_to_mesh("holds " + std::to_string(content.other_primitives) +
                           " primitives, none of them triangles with positions; write its surface as triangles");
  WeldedCorners welded = weld(document, content);
  const bool has_attributes = std::any_of(content.vertices.begin(), content.vertices.end(),
                                          [](const GltfVertices& vertices) { return vertices.attributes->size() > 1; });
  const bool keeps_corners = has_attributes && !welded.index.empty();
  const auto keep =
      keeps_corners || !triangles.material.empty() ? FaceCollector::Keep::faces_too : FaceCollector::Keep::triangles;
  std::vector<FaceCollector> faces(1, FaceCollector(welded.vertices, keep));
  faces[0].adopt(triangles_of_vertices(source, triangles, welded, keeps_corners));
  TriangleSoup soup = join_soup(source, std::move(welded.vertices), faces);
  if (has_attributes) AttributeReader(document, content, triangles, faces[0].face_of(), welded.index, soup).read();
  add_materials(document, triangles.material, faces[0].face_of(), soup);
  note_regions(document, soup);
  soup.dirt.other_primitives = content.other_primitives;
  soup.dirt.posed_meshes = content.posed_meshes;
  soup.dirt.surplus_bytes = document.surplus_bytes();
  return soup;
}

}  // namespace isoshell
