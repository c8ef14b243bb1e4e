#include "values/result.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <utility>

#include "isoshell/advanced/digest.h"
#include "isoshell/io/mesh_file.h"
#include "isoshell/region_census.h"
#include "values/arrays.h"
#include "values/attributes.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

const TriangleMesh& mesh_of(nb::handle self) { return nb::cast<const RunResult&>(self).mesh; }

void save(const RunResult& result, const std::string& path, bool overwrite) {
  MeshWriteOptions options;
  options.overwrite = overwrite;
  write_mesh(path, result.mesh, options);
}

/// Vertices, faces and attributes of one region's boundary.
nb::tuple region(const RunResult& result, int32_t label) {
  TriangleMesh mesh = [&] {
    const nb::gil_scoped_release released;
    return region_of(result.mesh, label);
  }();
  const nb::object owner = nb::cast(std::move(mesh));
  const auto& kept = nb::cast<const TriangleMesh&>(owner);
  return nb::make_tuple(rows_of(kept.vertices, owner), rows_of(kept.triangles, owner), attributes_of(kept));
}

}  // namespace

void bind_result(nb::module_& m) {
  nb::class_<RunResult>(m, "RunResult", "What a run made.")
      .def_prop_ro("vertices", [](nb::handle self) { return rows_of(mesh_of(self).vertices, self); })
      .def_prop_ro("faces", [](nb::handle self) { return rows_of(mesh_of(self).triangles, self); })
      .def_prop_ro(
          "attributes", [](const RunResult& r) { return attributes_of(r.mesh); },
          nb::for_getter(nb::sig("def attributes(self, /) -> list[tuple[str, str, typing.Any, list[str]]]")))
      .def_prop_ro(
          "features", [](const RunResult& r) { return features_of(r.mesh); },
          nb::for_getter(nb::sig("def features(self, /) -> dict[str, typing.Any]")))
      .def_prop_ro(
          "regions", [](const RunResult& r) { return regions_of(r.mesh); },
          nb::for_getter(nb::sig("def regions(self, /) -> dict[str, typing.Any]")))
      .def_prop_ro("statistics", [](const RunResult& r) { return statistics_json(r.record); })
      .def_prop_ro("digest", [](const RunResult& r) { return digest_text(digest(r.mesh)); })
      .def_ro("gates", &RunResult::gates)
      .def_ro("missed_gates", &RunResult::missed_gates)
      .def("region", region, nb::arg("label"),
           nb::sig("def region(self, label: int) -> tuple[typing.Any, typing.Any, list[tuple[str, str, typing.Any, "
                   "list[str]]]]"))
      .def("save", save, nb::arg("path"), nb::arg("overwrite"), nb::call_guard<nb::gil_scoped_release>());
}

}  // namespace isoshell::python
