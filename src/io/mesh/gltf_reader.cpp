// glTF: triangles of all meshes where their nodes put them, with colours, texture coordinates, normals, materials and
// numbers of vertices.

#include <algorithm>
#include <limits>

#include "core/parallel_ranges.h"
#include "io/mesh/gltf_materials.h"
#include "io/mesh/gltf_primitives.h"
#include "io/mesh/mesh_readers.h"
#include "io/mesh/weld.h"

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

/// As they are stored, that is, in no more than single precision.
std::vector<RawPosition<float>> positions_of(const GltfDocument& document, const GltfContent& content) {
  std::vector<RawPosition<float>> points(size_t(content.first_vertex.back()));
  for (const GltfVertices& vertices : content.vertices)
    read_values(document, *vertices.find(document, "POSITION"), true, &points[size_t(vertices.first)].x);
  return points;
}

/// Vertices of the result, and per vertex of the content which one it is; empty where all are vertices of the result.
struct Welded {
  VertexTable vertices;
  std::vector<uint32_t> vertex_of;
};

/// Equal positions of an instance become one vertex; those of two instances stay apart.
Welded weld(const MeshSource& source, const GltfContent& content, const std::vector<RawPosition<float>>& stored) {
  Welded all{VertexTable(source, 0), std::vector<uint32_t>(stored.size())};
  std::vector<WorldPoint>& points = all.vertices.points;
  for (size_t i = 0; i < content.instances.size(); ++i) {
    const int64_t first = content.first_vertex[i], count = content.first_vertex[i + 1] - first;
    WeldedCorners welded = weld_corners(source, count, FloatCornerArray{stored.data() + first});
    const size_t base = points.size();
    for_each_index(count, [&](int64_t v) {
      all.vertex_of[size_t(first + v)] = uint32_t(base) + welded.index[size_t(v / 3)][size_t(v % 3)];
    });
    if (base == 0)
      points = std::move(welded.vertices.points);
    else
      points.insert(points.end(), welded.vertices.points.begin(), welded.vertices.points.end());
    for_each_index(int64_t(points.size() - base), [&](int64_t v) {
      points[base + size_t(v)] = content.instances[i].to_world.point(points[base + size_t(v)]);
    });
  }
  if (points.size() == stored.size()) all.vertex_of.clear();
  all.vertices.count_nonfinite();
  return all;
}

/// What becomes of an attribute of primitives; an empty name: it is not taken.
struct Meaning {
  std::string name, reason;
  AttributeDomain domain = AttributeDomain::vertex;
  int32_t least = 1, most = 1;  ///< components
};

Meaning meaning_of(const std::string& semantic) {
  if (semantic == "COLOR_0") return {kColorName, "", AttributeDomain::vertex, 3, 4};
  if (semantic == "NORMAL") return {kNormalName, "", AttributeDomain::corner, 3, 3};
  if (semantic == "TEXCOORD_0") return {kUvName, "", AttributeDomain::corner, 2, 2};
  const std::string set = semantic.rfind("TEXCOORD_", 0) == 0 ? semantic.substr(9) : "";
  if (!set.empty() && set.size() < 4 && set.find_first_not_of("0123456789") == std::string::npos)
    return {kUvName + set, "", AttributeDomain::corner, 2, 2};
  if (semantic == "_GAP") return {"", "the result has its own flag of that name"};
  const bool is_word = std::all_of(semantic.begin(), semantic.end(), [](unsigned char c) { return c > ' '; });
  if (semantic.size() < 2 || semantic[0] != '_' || !is_word) return {"", "glTF attributes of this kind are not kept"};
  return {semantic, "", AttributeDomain::vertex, 1, 1};
}

class AttributeReader {
 public:
  AttributeReader(const GltfDocument& document, const GltfContent& content, const std::vector<Triangle>& corners,
                  const std::vector<uint32_t>& face_of, const Welded& welded, TriangleSoup& soup)
      : document_(document), content_(content), corners_(corners), face_of_(face_of), welded_(welded), soup_(soup) {}

  void read() {
    std::vector<std::string> semantics;
    for (const GltfVertices& vertices : content_.vertices)
      for (const auto& [semantic, index] : vertices.attributes->items())
        if (semantic != "POSITION" && std::find(semantics.begin(), semantics.end(), semantic) == semantics.end())
          semantics.push_back(semantic);
    for (const std::string& semantic : semantics) {
      const Meaning meaning = meaning_of(semantic);
      const std::string reason = meaning.name.empty() ? meaning.reason : add(semantic, meaning);
      if (!reason.empty()) soup_.dropped_attributes.push_back({semantic, reason});
    }
  }

 private:
  /// Result: why it was not taken; empty if it was.
  std::string add(const std::string& semantic, const Meaning& meaning) {
    std::vector<std::optional<GltfAccessor>> accessors;
    Attribute attribute{meaning.name, NumberType::f32, 0, {}, meaning.domain};
    bool is_integer = true, is_everywhere = true;
    for (const GltfVertices& vertices : content_.vertices) {
      accessors.push_back(vertices.find(document_, semantic));
      const auto& a = accessors.back();
      is_everywhere &= a.has_value();
      if (!a) continue;
      if (a->components < meaning.least || a->components > meaning.most)
        return "it has " + std::to_string(a->components) + " components, and is kept with " +
               std::to_string(meaning.most);
      const bool is_first = attribute.components == 0;
      is_integer &=
          (meaning.name == kColorName ? a->normalized && (a->type == NumberType::u8 || a->type == NumberType::u16)
                                      : !a->normalized && a->type != NumberType::f32) &&
          (is_first || a->type == attribute.type);
      if (is_first) attribute.type = a->type;
      attribute.components = std::max(attribute.components, a->components);
    }
    if (!is_everywhere && meaning.domain == AttributeDomain::vertex && meaning.name != kColorName)
      return "not all meshes have it";
    is_integer &= meaning.domain == AttributeDomain::vertex;
    if (!is_integer) attribute.type = NumberType::f32;
    const double white = is_integer ? (attribute.type == NumberType::u8 ? 255 : 65535) : 1;
    fill(accessors, !is_integer, meaning.domain == AttributeDomain::corner ? kNone : white, attribute);
    if (meaning.name == kNormalName) turn_normals(attribute.values);
    if (meaning.domain == AttributeDomain::vertex)
      keep_first_of_welded(attribute);
    else
      name_corners(attribute);
    soup_.attributes.push_back(std::move(attribute));
    return "";
  }

  void fill(const std::vector<std::optional<GltfAccessor>>& accessors, bool scaled, double missing,
            Attribute& attribute) const {
    const auto components = size_t(attribute.components);
    attribute.values.assign(size_t(content_.first_vertex.back()) * components, missing);
    for (size_t i = 0; i < accessors.size(); ++i) {
      if (!accessors[i]) continue;
      double* const out = attribute.values.data() + size_t(content_.vertices[i].first) * components;
      const auto have = size_t(accessors[i]->components);
      if (have == components) {
        read_values(document_, *accessors[i], scaled, out);
        continue;
      }
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
    if (welded_.vertex_of.empty()) return;
    const auto components = size_t(attribute.components);
    std::vector<double> values(soup_.vertices.size() * components);
    for (size_t v = welded_.vertex_of.size(); v-- > 0;)
      std::copy_n(&attribute.values[v * components], components, &values[welded_.vertex_of[v] * components]);
    attribute.values = std::move(values);
  }

  void name_corners(Attribute& attribute) const {
    attribute.index.resize(3 * face_of_.size());
    for_each_index(int64_t(face_of_.size()), [&](int64_t t) {
      std::copy_n(corners_[face_of_[size_t(t)]].begin(), 3, attribute.index.begin() + 3 * t);
    });
  }

  const GltfDocument& document_;
  const GltfContent& content_;
  const std::vector<Triangle>& corners_;
  const std::vector<uint32_t>& face_of_;
  const Welded& welded_;
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
  for (const uint32_t face : face_of) material.values.push_back(of_corners[face]);
  soup.attributes.push_back(std::move(material));
  soup.files.gltf_materials = gltf_materials_of(document);
}

}  // namespace

TriangleSoup read_gltf(const MeshSource& source) {
  const GltfDocument document(source);
  const GltfContent content = content_of(document);
  GltfTriangles triangles = triangles_of(document, content);
  if (triangles.corners.empty() && content.other_primitives > 0)
    source.nothing_to_mesh("holds " + std::to_string(content.other_primitives) +
                           " primitives, none of them triangles with positions; write its surface as triangles");
  Welded welded = weld(source, content, positions_of(document, content));
  const bool has_more = !triangles.material.empty() ||
                        std::any_of(content.vertices.begin(), content.vertices.end(),
                                    [](const GltfVertices& vertices) { return vertices.attributes->size() > 1; });
  const auto keep = has_more ? FaceCollector::Keep::faces_too : FaceCollector::Keep::triangles;
  std::vector<FaceCollector> faces(1, FaceCollector(welded.vertices, keep));
  std::vector<Triangle> of_vertices = has_more ? triangles.corners : std::move(triangles.corners);
  if (!welded.vertex_of.empty())
    for_each_index(int64_t(of_vertices.size()), [&](int64_t t) {
      for (uint32_t& corner : of_vertices[size_t(t)]) corner = welded.vertex_of[corner];
    });
  faces[0].adopt(std::move(of_vertices));
  TriangleSoup soup = join_soup(source, std::move(welded.vertices), faces);
  if (has_more) AttributeReader(document, content, triangles.corners, faces[0].face_of(), welded, soup).read();
  add_materials(document, triangles.material, faces[0].face_of(), soup);
  soup.dirt.other_primitives = content.other_primitives;
  soup.dirt.posed_meshes = content.posed_meshes;
  soup.dirt.surplus_bytes = document.surplus_bytes();
  return soup;
}

}  // namespace isoshell
