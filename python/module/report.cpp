#include "module/report.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <utility>
#include <vector>

#include "isoshell/distance.h"
#include "isoshell/error.h"
#include "module/watched.h"
#include "values/arrays.h"
#include "values/attributes.h"
#include "values/result.h"
#include "values/text.h"
#include "vdb_isomesh/command.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

/// What the run of a request starts from, to be read again.
Source source_of(const RunRequest& request) {
  return {"",
          [request](const RunRequest& again, const Context& context) {
            return read_input_of(request, context, again.tell);
          },
          {},
          {}};
}

TriangleMesh surface_of(Input input) {
  if (input.stage) return to_world(input.stage->surface);
  TriangleMesh mesh;
  mesh.vertices = std::move(input.soup.vertices);
  mesh.triangles = std::move(input.soup.triangles);
  mesh.regions = std::move(input.soup.regions);
  return mesh;
}

/// The surface that a run starts from, as it is read: vertices, triangles, and of each the regions that it parts, if
/// any.
nb::tuple read_surface(Place& place, const Source& source, const Keywords& keywords, nb::object tell) {
  const RequestFromPython requested = request_from_python(source, keywords, "", nb::none(), std::move(tell));
  TriangleMesh mesh =
      watched(place, source, requested, [read = source.read](const RunRequest& request, Context& context) {
        return surface_of(input_of_run(read, request, context));
      });
  const nb::object owner = nb::cast(std::move(mesh));
  const auto& kept = nb::cast<const TriangleMesh&>(owner);
  return nb::make_tuple(rows_of(kept.vertices, owner), rows_of(kept.triangles, owner),
                        nb::object(regions_of(kept)["labels"]));
}

using Numbers = nb::ndarray<nb::numpy, double, nb::shape<-1>, nb::c_contig>;

Numbers distances_to(const AnyArray& points, const AnyArray& vertices, const AnyArray& faces) {
  const std::vector<WorldPoint> from = points_of("points", points);
  TriangleMesh mesh;
  mesh.vertices = points_of("vertices", vertices);
  mesh.triangles = triangles_of("faces", faces, mesh.vertices.size());
  auto made = std::make_unique<std::vector<double>>();
  {
    const nb::gil_scoped_release released;
    Context context;
    *made = distances(from, mesh, context);
  }
  const nb::capsule owner(made.get(), [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
  std::vector<double>& kept = *made.release();
  return {kept.data(), {kept.size()}, owner};
}

nb::tuple side_of(const OneSidedDistance& distance, const NormalDeviation& normals) {
  return nb::make_tuple(distance.mean, distance.rms, distance.max, normals.mean_deg, normals.max_deg);
}

nb::tuple surface_distance(const AnyArray& vertices, const AnyArray& faces, const AnyArray& reference_vertices,
                           const AnyArray& reference_faces) {
  TriangleMesh mesh, reference;
  mesh.vertices = points_of("vertices", vertices);
  mesh.triangles = triangles_of("faces", faces, mesh.vertices.size());
  reference.vertices = points_of("reference_vertices", reference_vertices);
  reference.triangles = triangles_of("reference_faces", reference_faces, reference.vertices.size());
  MeshDistance d;
  {
    const nb::gil_scoped_release released;
    Context context;
    d = measure_distance(mesh, reference, context);
  }
  return nb::make_tuple(d.diagonal, side_of(d.to_reference, d.normal_to_reference),
                        side_of(d.from_reference, d.normal_from_reference));
}

int command(const std::vector<std::string>& arguments, const nb::object& write_report, const std::string& also_reads,
            const std::string& also_writes) {
  std::vector<const char*> words;
  for (const std::string& word : arguments) words.push_back(word.c_str());
  tool::WriteReport write;
  if (!write_report.is_none())
    write = [&](const RunRequest& request, const RunResult& result) {
      const nb::gil_scoped_acquire acquired;
      const auto failure = nb::cast<std::string>(
          write_report(nb::cast(made_of(result)), nb::cast(source_of(request)), request.report, request.overwrite));
      if (!failure.empty()) throw Error(ErrorCode::unwritable_output, "report", failure);
    };
  const nb::gil_scoped_release released;
  return tool::command(int(words.size()), words.data(), write, {arguments.at(0), also_reads, also_writes});
}

}  // namespace

void bind_report(nb::module_& m) {
  m.def("read_surface", read_surface, nb::arg("place"), nb::arg("source"), nb::arg("keywords"), nb::arg("tell"),
        nb::sig("def read_surface(place: Place, source: Source, keywords: collections.abc.Sequence[tuple[str, str | "
                "None]], tell: typing.Any) -> tuple[typing.Any, typing.Any, typing.Any]"));
  m.def("distances", distances_to, nb::arg("points"), nb::arg("vertices"), nb::arg("faces"),
        nb::sig("def distances(points: typing.Any, vertices: typing.Any, faces: typing.Any) -> typing.Any"),
        "Of each point to the nearest one of the mesh.");
  m.def(
      "surface_distance", surface_distance, nb::arg("vertices"), nb::arg("faces"), nb::arg("reference_vertices"),
      nb::arg("reference_faces"),
      nb::sig("def surface_distance(vertices: typing.Any, faces: typing.Any, reference_vertices: typing.Any, "
              "reference_faces: typing.Any) -> tuple[float, tuple[float, float, float, float, float], "
              "tuple[float, float, float, float, float]]"),
      "Between two meshes: the diagonal of the reference, and to it and from it the mean, the root of the mean square "
      "and the largest distance, in world units, and the mean and largest angle between normals, in degrees.");
  m.def("command", command, nb::arg("arguments"), nb::arg("write_report").none(), nb::arg("also_reads"),
        nb::arg("also_writes"),
        nb::sig("def command(arguments: collections.abc.Sequence[str], write_report: typing.Any, also_reads: str, "
                "also_writes: str) -> int"),
        "The command, with its name in messages and help as the first argument. Returns its exit status; signals end "
        "the process from then on. write_report(result, source, path, overwrite) makes the page of --report, and "
        "returns why it could not; None: the option is refused. also_reads and also_writes are lines of the help.");
}

}  // namespace isoshell::python
