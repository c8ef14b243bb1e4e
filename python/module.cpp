// Python's view of the library's run: options as JSON, the mesh as arrays over its own memory.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include "isoshell/isoshell.h"

namespace nb = nanobind;
using namespace isoshell;

namespace {

struct Result {
  TriangleMesh mesh;
  std::string report;
};

static_assert(sizeof(WorldPoint) == 3 * sizeof(double), "vertices are shown as rows of three doubles");

Result result_of(RunResult run) { return {std::move(run.mesh), statistics_json(run.record)}; }

Result remesh_file(const std::string& path, const std::string& options) {
  const nb::gil_scoped_release released;
  Context context;
  RunRequest request;
  request.input = named_input(path);
  request.options = parse_options_json(options);
  return result_of(run(request, context));
}

template <class T>
using View = nb::ndarray<nb::numpy, T, nb::shape<-1, 3>, nb::c_contig>;

View<const double> vertices(nb::handle self) {
  const TriangleMesh& mesh = nb::cast<Result&>(self).mesh;
  return {reinterpret_cast<const double*>(mesh.vertices.data()), {mesh.vertices.size(), 3}, self};
}

/// Indices of a mesh stay below 2^31: as signed numbers, which numpy's users expect, they are the same bits.
View<const int32_t> faces(nb::handle self) {
  const TriangleMesh& mesh = nb::cast<Result&>(self).mesh;
  return {reinterpret_cast<const int32_t*>(mesh.triangles.data()), {mesh.triangles.size(), 3}, self};
}

void save(const Result& result, const std::string& path, bool overwrite) {
  MeshWriteOptions options;
  options.overwrite = overwrite;
  write_mesh(path, result.mesh, options);
}

}  // namespace

NB_MODULE(_isoshell, m) {
  nb::class_<Result>(m, "Result")
      .def_prop_ro("vertices", [](nb::handle self) { return vertices(self); })
      .def_prop_ro("faces", [](nb::handle self) { return faces(self); })
      .def_prop_ro("_report", [](const Result& r) { return r.report; })
      .def("save", save, nb::arg("path"), nb::arg("overwrite") = false, nb::call_guard<nb::gil_scoped_release>());
  m.def("remesh_file", remesh_file, nb::arg("path"), nb::arg("options"));
}
