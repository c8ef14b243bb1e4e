#include "values/result_state.h"

#include <nanobind/stl/vector.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "values/packed.h"
#include "values/text.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

using Texts = std::vector<std::string>;

[[noreturn]] void refuse() { refuse_state("isoshell.Result"); }

nb::tuple part(const nb::tuple& state, size_t i, size_t size) {
  auto found = nb::cast<nb::tuple>(state[i]);
  if (found.size() != size) refuse();
  return found;
}

nb::tuple state_of_attribute(const Attribute& a) {
  return nb::make_tuple(a.name, int(a.type), a.components, packed(a.values), int(a.domain), packed(a.index), a.labels);
}

Attribute attribute_of(const nb::tuple& s) {
  if (s.size() != 7) refuse();
  return {nb::cast<std::string>(s[0]), NumberType(nb::cast<int>(s[1])),      nb::cast<int32_t>(s[2]),
          unpacked<double>(s[3]),      AttributeDomain(nb::cast<int>(s[4])), unpacked<uint32_t>(s[5]),
          nb::cast<Texts>(s[6])};
}

nb::tuple state_of_regions(const FaceRegions& r) {
  std::vector<int32_t> labels;
  Texts names;
  for (const RegionName& region : r.names) {
    labels.push_back(region.label);
    names.push_back(region.name);
  }
  return nb::make_tuple(packed(r.labels), r.background, r.are_of_voxels, r.voxel_size_world, packed(r.side),
                        packed(labels), names);
}

FaceRegions regions_of(const nb::tuple& s) {
  FaceRegions r;
  r.labels = unpacked<std::array<int32_t, 2>>(s[0]);
  r.background = nb::cast<int32_t>(s[1]);
  r.are_of_voxels = nb::cast<bool>(s[2]);
  r.voxel_size_world = nb::cast<double>(s[3]);
  r.side = unpacked<uint8_t>(s[4]);
  const auto labels = unpacked<int32_t>(s[5]);
  const auto names = nb::cast<Texts>(s[6]);
  if (labels.size() != names.size()) refuse();
  for (size_t i = 0; i < labels.size(); ++i) r.names.push_back({labels[i], names[i]});
  return r;
}

nb::tuple state_of_mesh(const TriangleMesh& m) {
  nb::list attributes;
  for (const Attribute& a : m.attributes) attributes.append(state_of_attribute(a));
  const MeshFeatures& f = m.features;
  return nb::make_tuple(packed(m.vertices), packed(m.triangles), packed(m.gap), attributes,
                        nb::make_tuple(m.files.materials, m.files.textures, m.files.gltf_materials),
                        nb::make_tuple(packed(f.patch), packed(f.curve_edges), packed(f.corners)),
                        state_of_regions(m.regions));
}

TriangleMesh mesh_of(const nb::tuple& s) {
  TriangleMesh m;
  m.vertices = unpacked<WorldPoint>(s[0]);
  m.triangles = unpacked<std::array<uint32_t, 3>>(s[1]);
  for (const auto& t : m.triangles)
    for (const uint32_t v : t)
      if (v >= m.vertices.size()) refuse();
  m.gap = unpacked<uint8_t>(s[2]);
  for (const nb::handle a : nb::cast<nb::list>(s[3])) m.attributes.push_back(attribute_of(nb::cast<nb::tuple>(a)));
  const nb::tuple files = part(s, 4, 3), features = part(s, 5, 3);
  m.files = {nb::cast<Texts>(files[0]), nb::cast<Texts>(files[1]), nb::cast<std::string>(files[2])};
  m.features = {unpacked<uint32_t>(features[0]), unpacked<MeshCurveEdge>(features[1]), unpacked<uint32_t>(features[2])};
  m.regions = regions_of(part(s, 6, 7));
  return m;
}

}  // namespace

nb::tuple state_of(const MadeResult& result) {
  return nb::make_tuple(state_of_mesh(result.mesh), result.statistics, result.gates, result.missed_gates,
                        result.frame_note);
}

MadeResult result_of_state(const nb::tuple& s) {
  try {
    if (s.size() != 5) refuse();
    return {mesh_of(part(s, 0, 7)), nb::cast<std::string>(s[1]), nb::cast<Texts>(s[2]), nb::cast<Texts>(s[3]),
            nb::cast<std::string>(s[4])};
  } catch (const nb::cast_error&) {
    refuse();
  }
}

}  // namespace isoshell::python
