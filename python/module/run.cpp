#include "module/run.h"

#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <utility>

#include "module/watched.h"
#include "values/level_set.h"
#include "values/result.h"
#include "values/text.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

MadeResult remesh(Place& place, const Source& source, const Keywords& keywords, const std::string& output,
                  bool measure_all, bool keep_level_set, nb::object progress, nb::object tell) {
  RequestFromPython requested = request_from_python(source, keywords, output, std::move(progress), std::move(tell));
  if (measure_all) requested.arguments.run.measures = Measures::all;
  requested.arguments.run.level_set.keep = keep_level_set;
  return watched(place, source, requested, [read = source.read](const RunRequest& request, Context& context) {
    return made_of(run_from(read, request, context));
  });
}

MadeLevelSet level_set(Place& place, const Source& source, const Keywords& keywords, nb::object progress,
                       nb::object tell) {
  RequestFromPython requested = request_from_python(source, keywords, "", std::move(progress), std::move(tell));
  requested.arguments.run.stop_after = StopAfter::level_set;
  requested.arguments.run.level_set.keep = true;
  return watched(place, source, requested, [read = source.read](const RunRequest& request, Context& context) {
    return MadeLevelSet{run_from(read, request, context).level_set};
  });
}

nb::dict estimate(Place& place, const Source& source, const Keywords& keywords, nb::object tell) {
  const RequestFromPython requested = request_from_python(source, keywords, "", nb::none(), std::move(tell));
  const RunEstimate e =
      watched(place, source, requested, [read = source.read](const RunRequest& request, Context& context) {
        return read ? dry_run(read(request, context), request, context) : dry_run(request, context);
      });
  nb::dict dict;
  dict["resolution"] = e.resolution;
  dict["voxel_size"] = e.voxel_size_world;
  dict["vertices"] = e.vertices;
  dict["sites"] = e.sites;
  dict["active_voxels"] = e.active_voxels;
  dict["sheet_vertices"] = e.sheet_vertices;
  dict["memory_bytes"] = e.bytes;
  return dict;
}

}  // namespace

void bind_run(nb::module_& m) {
  m.def("remesh", remesh, nb::arg("place"), nb::arg("source"), nb::arg("keywords"), nb::arg("output"),
        nb::arg("measure_all"), nb::arg("keep_level_set"), nb::arg("progress").none(), nb::arg("tell"));
  m.def("level_set", level_set, nb::arg("place"), nb::arg("source"), nb::arg("keywords"), nb::arg("progress").none(),
        nb::arg("tell"));
  m.def(
      "estimate", estimate, nb::arg("place"), nb::arg("source"), nb::arg("keywords"), nb::arg("tell"),
      nb::sig("def estimate(place: Place, source: Source, keywords: collections.abc.Sequence[tuple[str, str | None]], "
              "tell: typing.Any) -> dict[str, typing.Any]"));
  m.def("end_jobs_left_alone", end_jobs_left_alone);
}

}  // namespace isoshell::python
