#include "values/result.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/vector.h>

#include <utility>

#include "isoshell/advanced/digest.h"
#include "isoshell/io/file_format.h"
#include "isoshell/io/mesh_file.h"
#include "isoshell/region_census.h"
#include "isoshell/run/run.h"
#include "values/arrays.h"
#include "values/attributes.h"
#include "values/level_set.h"
#include "values/result_state.h"
#include "values/text.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

const TriangleMesh& mesh_of(nb::handle self) { return nb::cast<const MadeResult&>(self).mesh; }

/// What "auto" or three numbers subtract; none where that is not asked for.
std::optional<std::array<double, 3>> offset(const MadeResult& result, const std::string& recenter) {
  if (recenter.empty()) return {};
  const std::optional<WorldPoint> given = parse_recenter(recenter).offset_world;
  const WorldPoint by = given ? *given : offset_to_origin(result.mesh);
  return std::array<double, 3>{by.x, by.y, by.z};
}

/// Result: what there is to warn of.
std::vector<std::string> save(const MadeResult& result, const std::string& path, bool overwrite,
                              const std::string& recenter) {
  MeshWriteOptions options;
  options.format = named_output(path, "", StopAfter::mesh).format;
  options.overwrite = overwrite;
  options.made_of = result.frame_note;
  const auto by = offset(result, recenter).value_or(std::array<double, 3>{});
  options.held = positions_in_file(result.mesh, options.format, {by[0], by[1], by[2]}).held;
  write_mesh(path, result.mesh, options);
  return warnings_of_files({{path, options.format, *options.held}}, offset_to_origin(result.mesh));
}

/// What a file of that name does not hold of the result, with the reasons.
std::vector<std::string> not_held(const MadeResult& result, const std::string& path) {
  const size_t dot = path.find_last_of('.');
  const std::string format = dot == std::string::npos ? "" : path.substr(dot + 1);
  std::vector<std::string> lost;
  for (const Attribute& a : result.mesh.attributes)
    if (const std::string why = why_not_held(format, a); !why.empty()) lost.push_back(a.name + ": " + why);
  const FileFormat* const found = find_format(format);
  if (!result.mesh.regions.empty() && found && !found->holds_regions)
    lost.push_back("regions: " + format + " files do not say which regions a face parts");
  return lost;
}

/// Vertices, faces and attributes of one region's boundary.
nb::tuple region(const MadeResult& result, int32_t label) {
  TriangleMesh mesh = [&] {
    const nb::gil_scoped_release released;
    return region_of(result.mesh, label);
  }();
  const nb::object owner = nb::cast(std::move(mesh));
  const auto& kept = nb::cast<const TriangleMesh&>(owner);
  return nb::make_tuple(rows_of(kept.vertices, owner), rows_of(kept.triangles, owner), attributes_of(kept));
}

}  // namespace

MadeResult made_of(RunResult result) {
  return {std::move(result.mesh),         statistics_json(result.record), std::move(result.gates),
          std::move(result.missed_gates), std::move(result.made_of),      std::move(result.level_set)};
}

void bind_result(nb::module_& m) {
  nb::class_<MadeResult>(m, "RunResult", "What a run made.")
      .def_prop_ro("vertices", [](nb::handle self) { return rows_of(mesh_of(self).vertices, self); })
      .def_prop_ro("faces", [](nb::handle self) { return rows_of(mesh_of(self).triangles, self); })
      .def_prop_ro(
          "attributes", [](const MadeResult& r) { return attributes_of(r.mesh); },
          nb::for_getter(nb::sig("def attributes(self, /) -> list[tuple[str, str, typing.Any, list[str]]]")))
      .def_prop_ro(
          "features", [](const MadeResult& r) { return features_of(r.mesh); },
          nb::for_getter(nb::sig("def features(self, /) -> dict[str, typing.Any]")))
      .def_prop_ro(
          "regions", [](const MadeResult& r) { return regions_of(r.mesh); },
          nb::for_getter(nb::sig("def regions(self, /) -> dict[str, typing.Any]")))
      .def_ro("statistics", &MadeResult::statistics)
      .def_prop_ro("digest", [](const MadeResult& r) { return digest_text(digest(r.mesh)); })
      .def_prop_ro("level_set",
                   [](const MadeResult& r) {
                     return r.level_set ? std::optional<MadeLevelSet>(MadeLevelSet{r.level_set}) : std::nullopt;
                   })
      .def_ro("gates", &MadeResult::gates)
      .def_ro("missed_gates", &MadeResult::missed_gates)
      .def("region", region, nb::arg("label"),
           nb::sig("def region(self, label: int) -> tuple[typing.Any, typing.Any, list[tuple[str, str, typing.Any, "
                   "list[str]]]]"))
      .def("offset", offset, nb::arg("recenter"),
           nb::sig("def offset(self, recenter: str) -> tuple[float, float, float] | None"))
      .def("save", save, nb::arg("path"), nb::arg("overwrite"), nb::arg("recenter"),
           nb::call_guard<nb::gil_scoped_release>())
      .def("not_held", not_held, nb::arg("path"))
      .def("__getstate__", state_of, nb::sig("def __getstate__(self) -> tuple[typing.Any, ...]"))
      .def(
          "__setstate__", [](MadeResult& r, const nb::tuple& state) { new (&r) MadeResult(result_of_state(state)); },
          nb::sig("def __setstate__(self, state: tuple[typing.Any, ...]) -> None"));
}

}  // namespace isoshell::python
