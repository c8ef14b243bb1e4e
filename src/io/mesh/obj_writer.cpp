// OBJ out: positions with colours, texture coordinates and normals of corners, objects, groups and materials of faces,
// and regions as groups.
#include <cmath>
#include <limits>
#include <numeric>

#include "core/attribute_values.h"
#include "core/number_type.h"
#include "io/bytes/output_file.h"
#include "io/bytes/row_buffer.h"
#include "io/mesh/precision.h"
#include "io/mesh/region_pairs.h"
#include "isoshell/io/mesh_file.h"

namespace isoshell {
namespace {

/// What a colour's values are divided by: they go from 0 to 1 in OBJ files.
double largest_of(NumberType type) {
  return with_type(type, [](auto number) {
    using T = decltype(number);
    return std::is_integral_v<T> ? double(std::numeric_limits<T>::max()) : 1.0;
  });
}

class ObjWriter {
 public:
  ObjWriter(OutputFile& file, const TriangleMesh& mesh, const Placement& placement)
      : file_(file), mesh_(mesh), placement_(placement) {
    for (const Attribute& a : mesh.attributes) {
      if (means(a, kColorName)) color_ = &a;
      if (a.name == kUvName && means(a, kUvName)) uv_ = &a;
      if (means(a, kNormalName)) normal_ = &a;
      for (Names& names : names_)
        if (a.domain == AttributeDomain::face && a.name == names.attribute && !a.labels.empty()) names.of = &a;
    }
    if (mesh.regions.empty()) return;
    Names& groups = names_[2];
    groups_ = groups_of_regions(mesh.regions, groups.of);
    groups.of = &groups_;
  }

  void write() {
    if (const std::string note = offset_note(placement_); !note.empty()) file_.write("# " + note + "\n");
    for (const std::string& name : mesh_.files.materials) file_.write("mtllib " + name + "\n");
    write_vertices();
    write_values("vt ", uv_);
    write_values("vn ", normal_);
    write_faces();
  }

 private:
  struct Names {
    const char *attribute, *keyword;
    const Attribute* of = nullptr;

    int64_t number(size_t face) const { return of ? int64_t(of->values[face]) : -1; }
  };

  void write_vertices() const {
    const double largest = color_ ? largest_of(color_->type) : 1;
    write_rows(file_, int64_t(mesh_.vertices.size()), 3 + 6 * (kLongestDouble + 1), [&](int64_t i, RowBuffer& out) {
      out.put('v');
      out.put(' ');
      put_text(out, placement_.written(mesh_.vertices[size_t(i)]));
      for (size_t c = 0; color_ && c < 3; ++c) {
        out.put(' ');
        out.put_number(float(color_->values[size_t(i * color_->components) + c] / largest));
      }
      out.put('\n');
    });
  }

  /// A line a value; a corner without a value names none of them.
  void write_values(const std::string& keyword, const Attribute* a) const {
    if (!a) return;
    const int64_t count = int64_t(a->values.size()) / a->components;
    write_rows(file_, count, 4 + a->components * (kLongestDouble + 1), [&](int64_t i, RowBuffer& out) {
      out.put(keyword);
      for (int64_t c = 0; c < a->components; ++c) {
        const double value = a->values[size_t(i * a->components + c)];
        if (std::isnan(value))
          out.put('0');
        else if (a->type == NumberType::f64)
          out.put_number(value);
        else
          out.put_number(float(value));
        out.put(c + 1 < a->components ? ' ' : '\n');
      }
    });
  }

  /// By material, object and group, in which the faces without one come first: no line takes one back.
  std::vector<uint32_t> order_of_faces() const {
    std::vector<uint32_t> order(mesh_.triangles.size());
    std::iota(order.begin(), order.end(), 0);
    const auto is_before = [&](uint32_t a, uint32_t b) {
      for (const Names& names : names_)
        if (names.number(a) != names.number(b)) return names.number(a) < names.number(b);
      return false;
    };
    std::stable_sort(order.begin(), order.end(), is_before);
    return order;
  }

  void write_faces() const {
    int64_t longest = 2 + 3 * (3 * kLongestIndex + 3);
    bool has_names = false;
    for (const Names& names : names_) {
      has_names |= names.of != nullptr;
      size_t longest_label = 0;
      for (size_t i = 0; names.of && i < names.of->labels.size(); ++i)
        longest_label = std::max(longest_label, names.of->labels[i].size());
      longest += 8 + int64_t(longest_label);
    }
    const std::vector<uint32_t> order = has_names ? order_of_faces() : std::vector<uint32_t>();
    write_rows(file_, int64_t(mesh_.triangles.size()), longest, [&](int64_t row, RowBuffer& out) {
      const size_t face = has_names ? order[size_t(row)] : size_t(row);
      if (has_names) put_names(out, face, row > 0 ? int64_t(order[size_t(row) - 1]) : -1);
      put_face(out, face);
    });
  }

  /// Where they are not those of the face before, -1 being none.
  void put_names(RowBuffer& out, size_t face, int64_t before) const {
    for (const Names& names : names_) {
      const int64_t number = names.number(face);
      if (number == (before < 0 ? -1 : names.number(size_t(before)))) continue;
      out.put(names.keyword);
      if (number >= 0) out.put(" " + names.of->labels[size_t(number)]);
      out.put('\n');
    }
  }

  void put_face(RowBuffer& out, size_t face) const {
    out.put('f');
    for (size_t i = 0; i < 3; ++i) {
      const size_t corner = 3 * face + i;
      out.put(' ');
      out.put_number(mesh_.triangles[face][i] + 1);
      const bool has_uv = has_value(uv_, corner), has_normal = has_value(normal_, corner);
      if (has_uv || has_normal) out.put('/');
      if (has_uv) out.put_number(number_of(*uv_, corner));
      if (!has_normal) continue;
      out.put('/');
      out.put_number(number_of(*normal_, corner));
    }
    out.put('\n');
  }

  static bool has_value(const Attribute* a, size_t corner) { return a && !std::isnan(value_of(*a, corner)[0]); }
  static uint32_t number_of(const Attribute& a, size_t corner) {
    return (a.index.empty() ? uint32_t(corner) : a.index[corner]) + 1;
  }

  OutputFile& file_;
  const TriangleMesh& mesh_;
  const Placement& placement_;
  const Attribute *color_ = nullptr, *uv_ = nullptr, *normal_ = nullptr;
  Attribute groups_;  ///< of regions
  Names names_[3] = {{kMaterialName, "usemtl"}, {kObjectName, "o"}, {kGroupName, "g"}};
};

bool obj_holds(const Attribute& a) {
  if (a.domain == AttributeDomain::face)
    return !a.labels.empty() && (means(a, kMaterialName) || means(a, kGroupName) || means(a, kObjectName));
  return means(a, kColorName) || means(a, kNormalName) || (a.name == kUvName && means(a, kUvName));
}

}  // namespace

std::string what_obj_lacks(const Attribute& attribute) {
  if (obj_holds(attribute)) return "";
  return attribute.domain == AttributeDomain::face ? "OBJ files hold no numbers of faces"
                                                   : "OBJ files hold no numbers but colours";
}

void write_obj(OutputFile& file, const TriangleMesh& mesh, const Placement& placement, const MeshWriteOptions&) {
  ObjWriter(file, mesh, placement).write();
}

}  // namespace isoshell
