#include "values/attributes.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "isoshell/error.h"
#include "values/text.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

/// An array that owns its values.
template <class T>
nb::object array_of(std::vector<T> values, const std::vector<size_t>& shape) {
  auto owned = std::make_unique<std::vector<T>>(std::move(values));
  T* data = owned->data();
  const nb::capsule owner = owner_of(std::move(owned));
  return nb::cast(nb::ndarray<nb::numpy, T>(data, shape.size(), shape.data(), owner));
}

template <class T>
T converted(double value) {
  if constexpr (std::is_integral_v<T>) return std::isfinite(value) ? T(value) : T(0);
  return T(value);
}

template <class T>
nb::object values_of(const Attribute& a) {
  const size_t n = size_t(a.components), elements = a.index.empty() ? a.values.size() / n : a.index.size();
  std::vector<T> values(elements * n);
  for (size_t e = 0; e < elements; ++e)
    for (size_t c = 0; c < n; ++c)
      values[e * n + c] = converted<T>(a.values[(a.index.empty() ? e : size_t(a.index[e])) * n + c]);
  std::vector<size_t> shape{elements};
  if (a.domain == AttributeDomain::corner) shape = {elements / 3, 3};
  if (n > 1) shape.push_back(n);
  return array_of(std::move(values), shape);
}

nb::object typed_values(const Attribute& a) {
  switch (a.type) {
    case NumberType::i8:
      return values_of<int8_t>(a);
    case NumberType::u8:
      return values_of<uint8_t>(a);
    case NumberType::i16:
      return values_of<int16_t>(a);
    case NumberType::u16:
      return values_of<uint16_t>(a);
    case NumberType::i32:
      return values_of<int32_t>(a);
    case NumberType::u32:
      return values_of<uint32_t>(a);
    case NumberType::f32:
      return values_of<float>(a);
    case NumberType::f64:
      return values_of<double>(a);
  }
  return nb::none();
}

const char* domain_name(AttributeDomain domain) {
  if (domain == AttributeDomain::vertex) return "vertex";
  return domain == AttributeDomain::face ? "face" : "corner";
}

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
  throw Error(ErrorCode::usage, "arguments", "the attribute '" + name + "' " + what);
}

AttributeDomain domain_of(const std::string& name, const std::string& domain) {
  const AttributeMeaning* const meaning = meaning_of(name);
  const bool by_corner = meaning && meaning->domain == AttributeDomain::corner;
  if (by_corner != (domain == "corner"))
    refuse(name, by_corner ? "is one of corners: give values[faces]" : "is one of vertices or of faces");
  if (name == kTextureName && domain != "face") refuse(name, "is one of faces");
  if (domain == "corner") return AttributeDomain::corner;
  return domain == "face" ? AttributeDomain::face : AttributeDomain::vertex;
}

void check_components(const Attribute& a) {
  const AttributeMeaning* const meaning = meaning_of(a.name);
  const int32_t n = a.components, least = meaning ? meaning->least_components : 1,
                most = meaning ? meaning->most_components : 1;
  if (n >= least && n <= most) return;
  if (most == 1) refuse(a.name, "has " + std::to_string(n) + " values each; give each of them a name of its own");
  refuse(a.name, "has " + (least < most ? std::to_string(least) + " or " : "") + std::to_string(most) +
                     " values each, not " + std::to_string(n));
}

template <class T>
bool take_values(const AnyArray& rows, NumberType type, Attribute& to) {
  if (rows.dtype() != nb::dtype<T>()) return false;
  to.type = type;
  const T* values = static_cast<const T*>(rows.data());
  for (size_t i = 0; i < rows.shape(0); ++i)
    for (size_t j = 0; j < rows.shape(1); ++j)
      to.values.push_back(double(values[int64_t(i) * rows.stride(0) + int64_t(j) * rows.stride(1)]));
  return true;
}

}  // namespace

Attribute attribute_of(const std::string& name, const std::string& domain, const AnyArray& rows,
                       std::vector<std::string> labels) {
  Attribute a;
  a.name = name;
  a.domain = domain_of(name, domain);
  a.components = int32_t(rows.shape(1));
  a.labels = std::move(labels);
  check_components(a);
  a.values.reserve(rows.shape(0) * rows.shape(1));
  const bool taken = take_values<uint8_t>(rows, NumberType::u8, a) || take_values<float>(rows, NumberType::f32, a) ||
                     take_values<double>(rows, NumberType::f64, a) || take_values<int32_t>(rows, NumberType::i32, a) ||
                     take_values<uint32_t>(rows, NumberType::u32, a) ||
                     take_values<int16_t>(rows, NumberType::i16, a) ||
                     take_values<uint16_t>(rows, NumberType::u16, a) || take_values<int8_t>(rows, NumberType::i8, a);
  if (!taken) refuse(name, "must be numbers of at most 32 bits, or float64");
  return a;
}

nb::list attributes_of(const TriangleMesh& mesh) {
  nb::list list;
  for (const Attribute& a : mesh.attributes)
    list.append(nb::make_tuple(a.name, domain_name(a.domain), typed_values(a), a.labels));
  if (!mesh.gap.empty())
    list.append(nb::make_tuple("gap", "vertex", array_of(mesh.gap, {mesh.gap.size()}), std::vector<std::string>()));
  return list;
}

nb::dict features_of(const TriangleMesh& mesh) {
  const MeshFeatures& f = mesh.features;
  std::vector<int32_t> edges, curves;
  for (const MeshCurveEdge& e : f.curve_edges) {
    edges.insert(edges.end(), {int32_t(e.vertex[0]), int32_t(e.vertex[1])});
    curves.push_back(int32_t(e.curve));
  }
  const size_t edge_count = curves.size();
  nb::dict dict;
  dict["patch"] = array_of(std::vector<int32_t>(f.patch.begin(), f.patch.end()), {f.patch.size()});
  dict["curve_edges"] = array_of(std::move(edges), {edge_count, 2});
  dict["curve"] = array_of(std::move(curves), {edge_count});
  dict["corners"] = array_of(std::vector<int32_t>(f.corners.begin(), f.corners.end()), {f.corners.size()});
  return dict;
}

nb::dict regions_of(const TriangleMesh& mesh) {
  const FaceRegions& r = mesh.regions;
  std::vector<int32_t> labels;
  for (const auto& [behind, front] : r.labels) labels.insert(labels.end(), {behind, front});
  nb::dict names;
  for (const RegionName& region : r.names) names[nb::int_(region.label)] = region.name;
  nb::dict dict;
  dict["labels"] = array_of(std::move(labels), {r.labels.size(), 2});
  dict["background"] = r.background;
  dict["names"] = names;
  return dict;
}

}  // namespace isoshell::python
