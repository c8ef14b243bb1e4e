#include "values/result.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/vector.h>

#include <utility>

#include "isoshell/advanced/digest.h"
#include "isoshell/io/mesh_file.h"
#include "isoshell/region_census.h"
#include "isoshell/run/run.h"
#include "values/arrays.h"
#include "values/attributes.h"
#include "values/text.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

const TriangleMesh& mesh_of(nb::handle self) { return nb::cast<const RunResult&>(self).mesh; }

/// What "auto" or three numbers subtract; none where that is not asked for.
std::optional<std::array<double, 3>> offset(const RunResult& result, const std::string& recenter) {
  if (recenter.empty()) return {};
  const std::optional<WorldPoint> given = parse_recenter(recenter).offset_world;
  const WorldPoint by = given ? *given : offset_to_origin(result.mesh);
  return std::array<double, 3>{by.x, by.y, by.z};
}

/// Result: what there is to warn of.
std::vector<std::string> save(const RunResult& result, const std::string& path, bool overwrite,
                              const std::string& recenter) {
  MeshWriteOptions options;
  options.overwrite = overwrite;
  if (const auto by = offset(result, recenter)) options.offset_world = {(*by)[0], (*by)[1], (*by)[2]};
  options.made_of = result.made_of;
  write_mesh(path, result.mesh, options);
  const std::string format = named_output(path, "", StopAfter::mesh).format;
  return warnings_of_files({{path, format, positions_in_file(result.mesh, format, options.offset_world).held}},
                           offset_to_origin(result.mesh));
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
      .def("offset", offset, nb::arg("recenter"),
           nb::sig("def offset(self, recenter: str) -> tuple[float, float, float] | None"))
      .def("save", save, nb::arg("path"), nb::arg("overwrite"), nb::arg("recenter"),
           nb::call_guard<nb::gil_scoped_release>());
}

}  // namespace isoshell::python
