// PLY out: binary, with attributes of vertices, corners and faces, and regions.
#include <set>

#include "core/attribute_values.h"
#include "core/number_type.h"
#include "io/bytes/output_file.h"
#include "io/bytes/row_buffer.h"
#include "io/mesh/precision.h"
#include "io/ply/ply_attributes.h"
#include "io/ply/ply_regions.h"
#include "isoshell/error.h"
#include "isoshell/io/mesh_file.h"

namespace isoshell {
namespace {

/// Of corners, but the same all around every vertex, and PLY has names for it there: then vertices have it.
bool is_of_vertices(const Attribute& a, const TriangleMesh& mesh) {
  if (a.domain != AttributeDomain::corner) return a.domain == AttributeDomain::vertex;
  if (!means(a, kNormalName) || a.index.empty()) return false;
  std::vector<uint32_t> of_vertex(mesh.vertices.size(), UINT32_MAX);
  for (size_t corner = 0; corner < a.index.size(); ++corner) {
    uint32_t& here = of_vertex[mesh.triangles[corner / 3][corner % 3]];
    if (here != UINT32_MAX && here != a.index[corner]) return false;
    here = a.index[corner];
  }
  return true;
}

/// Per vertex a corner that it is.
std::vector<size_t> corners_of(const TriangleMesh& mesh) {
  std::vector<size_t> corner(mesh.vertices.size(), 0);
  for (size_t c = 3 * mesh.triangles.size(); c-- > 0;) corner[mesh.triangles[c / 3][c % 3]] = c;
  return corner;
}

class PlyWriter {
 public:
  PlyWriter(OutputFile& file, const TriangleMesh& mesh, const Placement& placement, const MeshWriteOptions& options)
      : file_(file), mesh_(mesh), placement_(placement), made_of_(options.made_of) {
    if (options.curve_edges) edges_ = &mesh.features.curve_edges;
    for (const Attribute& a : mesh.attributes)
      (is_of_vertices(a, mesh)               ? of_vertices_
       : a.domain == AttributeDomain::corner ? of_corners_
                                             : of_faces_)
          .push_back(&a);
    for (const Attribute* a : of_vertices_)
      if (a->domain == AttributeDomain::corner) corner_of_vertex_ = corners_of(mesh);
  }

  void write() {
    write_header(name_of(placement_.type));
    if (placement_.is_double())
      write_vertices<double>();
    else
      write_vertices<float>();
    write_faces();
    if (edges_) write_edges();
  }

 private:
  void write_header(const std::string& type) {
    std::string text = "ply\nformat binary_little_endian 1.0\n";
    if (const std::string note = offset_note(placement_); !note.empty()) text += comment(note);
    for (const std::string& name : mesh_.files.textures) text += comment(std::string(kTextureNote) + " " + name);
    for (const std::string& name : mesh_.files.materials) text += comment(std::string(kLibraryNote) + " " + name);
    for (const Attribute* a : of_faces_)
      for (size_t i = 0; i < a->labels.size(); ++i)
        text += comment(std::string(kLabelNote) + " " + a->name + " " + std::to_string(i) + " " + a->labels[i]);
    text += region_notes();
    if (!made_of_.empty()) text += comment(std::string(kFrameNote) + " " + made_of_);
    text += "element vertex " + std::to_string(mesh_.vertices.size()) + "\n";
    std::set<std::string> names;
    for (const char* axis : {"x", "y", "z"}) text += property(type, axis, names);
    names.insert("gap");
    if (!mesh_.gap.empty()) text += "property uchar gap\n";
    for (const Attribute* a : of_vertices_)
      for (const std::string& name : ply_names(*a)) text += property(name_of(a->type), name, names);
    text += "element face " + std::to_string(mesh_.triangles.size()) + "\n";
    names.clear();
    text += property("list uchar uint", "vertex_indices", names);
    for (const Attribute* a : of_corners_)
      text += property(std::string("list uchar ") + name_of(a->type), ply_list_name(*a), names);
    for (const char* name : {kRegionInside, kRegionOutside})
      if (!mesh_.regions.empty()) text += property("int", name, names);
    for (const Attribute* a : of_faces_)
      for (const std::string& name : ply_names(*a)) text += property(name_of(a->type), name, names);
    if (edges_)
      text += "element edge " + std::to_string(edges_->size()) +
              "\nproperty uint vertex1\nproperty uint vertex2\nproperty uint curve\n";
    file_.write(text + "end_header\n");
  }

  /// What of the regions is not of faces. A background of 0 goes without saying.
  std::string region_notes() const {
    const FaceRegions& regions = mesh_.regions;
    if (regions.empty()) return "";
    std::string text;
    if (regions.background != 0)
      text += comment(std::string(kBackgroundNote) + " " + std::to_string(regions.background));
    for (const RegionName& region : regions.names)
      text += comment(std::string(kRegionNote) + " " + std::to_string(region.label) + " " + region.name);
    return text;
  }

  /// Throws: usage for a name that a property before has.
  static std::string property(const std::string& type, const std::string& name, std::set<std::string>& names) {
    if (!names.insert(name).second)
      throw Error(ErrorCode::usage, "write_mesh", "two properties would have the name '" + name + "'");
    return "property " + type + " " + name + "\n";
  }
  static std::string comment(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    return "comment " + text + "\n";
  }

  static int64_t bytes_of(const std::vector<const Attribute*>& attributes) {
    int64_t bytes = 0;
    for (const Attribute* a : attributes) bytes += a->components * size_of(a->type);
    return bytes;
  }
  static void put(RowBuffer& out, const Attribute& a, size_t element) {
    const double* const value = value_of(a, element);
    with_type(a.type, [&](auto number) {
      for (int32_t c = 0; c < a.components; ++c) out.put_binary(nearest_of<decltype(number)>(value[c]));
    });
  }

  template <class Real>
  void write_vertices() {
    const int64_t row_bytes = 3 * int64_t(sizeof(Real)) + 1 + bytes_of(of_vertices_);
    write_rows(file_, int64_t(mesh_.vertices.size()), row_bytes, [&](int64_t i, RowBuffer& out) {
      const WorldPoint p = placement_.about_origin(mesh_.vertices[size_t(i)]);
      out.put_binary(Real(p.x));
      out.put_binary(Real(p.y));
      out.put_binary(Real(p.z));
      if (!mesh_.gap.empty()) out.put(char(mesh_.gap[size_t(i)]));
      for (const Attribute* a : of_vertices_)
        put(out, *a, a->domain == AttributeDomain::corner ? corner_of_vertex_[size_t(i)] : size_t(i));
    });
  }

  void write_faces() {
    const int64_t row_bytes = 21 + int64_t(of_corners_.size()) + 3 * bytes_of(of_corners_) + bytes_of(of_faces_);
    write_rows(file_, int64_t(mesh_.triangles.size()), row_bytes, [&](int64_t i, RowBuffer& out) {
      out.put(char(3));
      for (const uint32_t corner : mesh_.triangles[size_t(i)]) out.put_binary(corner);
      for (const Attribute* a : of_corners_) {
        out.put(char(3 * a->components));
        for (size_t c = 0; c < 3; ++c) put(out, *a, 3 * size_t(i) + c);
      }
      if (!mesh_.regions.empty())
        for (const int32_t label : mesh_.regions.labels[size_t(i)]) out.put_binary(label);
      for (const Attribute* a : of_faces_) put(out, *a, size_t(i));
    });
  }

  void write_edges() {
    write_rows(file_, int64_t(edges_->size()), 12, [&](int64_t i, RowBuffer& out) {
      const MeshCurveEdge& edge = (*edges_)[size_t(i)];
      for (const uint32_t number : {edge.vertex[0], edge.vertex[1], edge.curve}) out.put_binary(number);
    });
  }

  OutputFile& file_;
  const TriangleMesh& mesh_;
  const Placement& placement_;
  const std::string& made_of_;
  const std::vector<MeshCurveEdge>* edges_ = nullptr;  ///< null: not asked for
  std::vector<const Attribute*> of_vertices_, of_corners_, of_faces_;
  std::vector<size_t> corner_of_vertex_;
};

}  // namespace

std::string what_ply_lacks(const Attribute& attribute) {
  const bool is_more =
      attribute.domain == AttributeDomain::corner && attribute.name != kUvName && attribute.name != kNormalName;
  return is_more ? "PLY files hold one set of texture coordinates" : "";
}

Placement place_in_ply(const TriangleMesh& mesh, const WorldPoint& offset) {
  return {needs_double(mesh, offset) ? NumberType::f64 : NumberType::f32, offset};
}

void write_ply(OutputFile& file, const TriangleMesh& mesh, const Placement& placement,
               const MeshWriteOptions& options) {
  PlyWriter(file, mesh, placement, options).write();
}

}  // namespace isoshell
