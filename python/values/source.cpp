#include "values/source.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "isoshell/error.h"
#include "isoshell/io/memory_input.h"
#include "isoshell/io/sizing_vdb.h"
#include "isoshell/io/velocity_vdb.h"
#include "isoshell/run/steps.h"
#include "isoshell/triangle_mesh.h"
#include "values/arrays.h"
#include "values/attributes.h"
#include "values/grid_source.h"
#include "values/labels.h"
#include "values/result.h"
#include "values/text.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

using Steps = std::array<Triple, 3>;  // from a value to the next, along each axis of the array

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, "arguments", message); }

/// Of what is in memory and no volume of labels.
void refuse_label_options(const RunRequest& request) {
  if (const char* const option = request.input.labels.given())
    refuse(std::string(option) + " is for volumes of labels; leave it out");
}
/// Of what is no volume.
void refuse_volume_options(const RunRequest& request) {
  if (request.input.iso) refuse("--iso is for volumes; leave it out");
  refuse_label_options(request);
}

/// The first one, and those that are read with it.
Source files(const std::vector<std::string>& paths) {
  if (paths.empty()) refuse("a list of files as a source must have one");
  Source source{paths[0], {}, {}, {}};
  source.also.assign(paths.begin() + 1, paths.end());
  return source;
}

Source surface(const std::string& name, TriangleSoup soup) {
  const auto given = std::make_shared<TriangleSoup>(std::move(soup));
  return {"",
          [name, given](const RunRequest& request, const Context&) {
            refuse_volume_options(request);
            return input_of(std::move(*given), name, request.tell);
          },
          {},
          {},
          {},
          given};
}

using GivenAttribute = std::tuple<std::string, std::string, AnyArray, std::vector<std::string>>;

Source triangles(const std::string& name, const AnyArray& vertices, const AnyArray& faces,
                 const std::vector<GivenAttribute>& attributes, const MadeResult* regions_of) {
  TriangleSoup soup;
  soup.vertices = points_of("vertices", vertices);
  soup.triangles = triangles_of("faces", faces, soup.vertices.size());
  for (const auto& [attribute, domain, values, labels] : attributes)
    soup.attributes.push_back(attribute_of(attribute, domain, values, labels));
  if (regions_of) soup.regions = regions_of->mesh.regions;
  return surface(name, std::move(soup));
}

PolygonSoup polygon_soup(const AnyArray& vertices, const AnyArray& sizes, const AnyArray& corners) {
  PolygonSoup soup;
  soup.vertices = points_of("vertices", vertices);
  soup.sizes = indices_of("sizes of faces", sizes, size_t(UINT32_MAX));
  soup.corners = indices_of("faces", corners, soup.vertices.size());
  return soup;
}

Source polygons(const std::string& name, const AnyArray& vertices, const AnyArray& sizes, const AnyArray& corners) {
  return surface(name, split_polygons(polygon_soup(vertices, sizes, corners), name));
}

/// What split_polygons makes of the faces: their triangles, in the faces' order.
nb::object split(const std::string& name, const AnyArray& vertices, const AnyArray& sizes, const AnyArray& corners) {
  TriangleMesh mesh;
  mesh.triangles = split_polygons(polygon_soup(vertices, sizes, corners), name).triangles;
  const nb::object owner = nb::cast(std::move(mesh));
  return nb::cast(rows_of(nb::cast<const TriangleMesh&>(owner).triangles, owner));
}

Source points(const AnyArray& positions, const std::optional<AnyArray>& normals) {
  PointCloud cloud;
  cloud.position = points_of("points", positions);
  if (normals) cloud.normal = points_of("normals", *normals);
  const auto given = std::make_shared<PointCloud>(std::move(cloud));
  return {"",
          [given](const RunRequest& request, const Context& context) {
            refuse_volume_options(request);
            if (request.input.keep_points) return input_of_points(*given, "points", request.tell);
            return input_of(*given, "points", context.memory_limit_bytes, request.tell,
                            volume_creases(request.options.values.features),
                            request.options.values.boundary == Boundary::keep);
          },
          {},
          {}};
}

/// The lattice of the first three dimensions of an array.
DenseVolume lattice(const float* first, const AnyArray& values, const Triple& origin, const Steps& steps) {
  DenseVolume v;
  v.values = first;
  for (size_t i = 0; i < 3; ++i) {
    v.size[i] = int64_t(values.shape(i));
    v.stride[i] = values.stride(i);
    v.step_world[i] = point_of(steps[i]);
  }
  v.origin_world = point_of(origin);
  return v;
}

DenseVolume dense_volume(const char* argument, const AnyArray& values, const Triple& origin, const Steps& steps) {
  return lattice(floats_of(argument, values, 3), values, origin, steps);
}

/// Python has looked whether there is such a name.
VolumeSides sides_named(const std::string& name, Boundary boundary) {
  if (name.empty()) return boundary == Boundary::keep ? VolumeSides::open : VolumeSides::sample;
  return name == "open" ? VolumeSides::open : name == "cell" ? VolumeSides::cell : VolumeSides::sample;
}

Source volume(const AnyArray& values, const Triple& origin, const Steps& steps, const std::string& sides, bool is_mask,
              const std::array<bool, 3>& periodic) {
  const DenseVolume v = dense_volume("volume", values, origin, steps);
  return {"",
          [v, sides, is_mask, periodic](const RunRequest& request, const Context& context) {
            refuse_label_options(request);
            const Boundary boundary = request.options.values.boundary;
            const VolumeReadOptions options{"",
                                            request.input.iso,
                                            context.memory_limit_bytes,
                                            volume_creases(request.options.values.features),
                                            sides_named(sides, boundary),
                                            is_mask,
                                            boundary == Boundary::keep,
                                            periodic};
            return input_of(v, "volume", options, request.tell);
          },
          nb::cast(values),
          {}};
}

Source sparse(const AnyArray& coordinates, const AnyArray& values, double background, bool is_level_set,
              const Triple& origin, const Steps& steps) {
  return sparse_source(coordinates, values, background, is_level_set, point_of(origin),
                       {point_of(steps[0]), point_of(steps[1]), point_of(steps[2])});
}

Source labels(const AnyArray& values, const LabelLattice& lattice) {
  const auto given = std::make_shared<LabelVolume>(label_volume_of(values, lattice));
  return {"",
          [given](const RunRequest& request, const Context& context) {
            if (request.input.iso) refuse("--iso is for volumes; leave it out");
            if (request.input.labels.given())
              refuse(std::string(request.input.labels.given()) + " is for files; give it to isoshell.Labels");
            return input_of(std::move(*given), "labels", context, request.tell);
          },
          {},
          {}};
}

void set_velocities(Source& source, const AnyArray& vectors, const Triple& origin, const Steps& steps) {
  const float* first = floats_of("velocities", vectors, 4);
  const auto part = [&](int64_t axis) { return lattice(first + axis * vectors.stride(3), vectors, origin, steps); };
  source.velocity = [parts = std::array<DenseVolume, 3>{part(0), part(1), part(2)}] {
    return velocity_of(parts, "velocities");
  };
  source.kept = nb::make_tuple(source.kept, vectors);
}

void set_velocities_of_vertices(Source& source, const AnyArray& velocities, const AnyArray& vertices,
                                const AnyArray& faces) {
  TriangleSoup soup;
  soup.vertices = points_of("vertices", vertices);
  soup.triangles = triangles_of("faces", faces, soup.vertices.size());
  source.velocity = [soup = std::move(soup), given = points_of("velocities", velocities)] {
    return velocity_on(soup, given);
  };
}

void set_sizing(Source& source, const AnyArray& lengths, const Triple& origin, const Steps& steps) {
  source.sizing = sizing_of(dense_volume("sizing", lengths, origin, steps), "sizing");
}

TriangleSoup& surface_in(Source& source) {
  if (!source.surface) refuse("sizing as an array is for meshes in memory; give an isoshell.Volume of edge lengths");
  return *source.surface;
}

void set_sizing_of_vertices(Source& source, const AnyArray& lengths) {
  const float* first = floats_of("sizing", lengths, 1);
  std::vector<double> values;
  for (size_t i = 0; i < lengths.shape(0); ++i) values.push_back(double(first[int64_t(i) * lengths.stride(0)]));
  source.sizing = sizing_on(surface_in(source), std::move(values), "sizing");
}

using LabelPairs = nb::ndarray<const int32_t, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;

/// Of each face the region behind it and the one in front, in the order that FaceRegions has them in; names by label.
void set_regions(Source& source, const LabelPairs& labels, int32_t background,
                 const std::map<int32_t, std::string>& names) {
  FaceRegions regions;
  regions.background = background;
  for (size_t i = 0; i < labels.shape(0); ++i) regions.labels.push_back({labels(i, 0), labels(i, 1)});
  for (const auto& [label, name] : names) regions.names.push_back({label, name});
  surface_in(source).regions = std::move(regions);
}

/// What the mesh had beside its positions and a run does not carry, with the reasons.
void set_dropped(Source& source, const std::vector<std::pair<std::string, std::string>>& dropped) {
  for (const auto& [name, reason] : dropped) surface_in(source).dropped_attributes.push_back({name, reason});
}

/// Files are pickled as their names; what is in memory is not.
std::vector<std::string> state_of(const Source& source) {
  if (!source.is_file()) refuse("a source in memory cannot be pickled");
  std::vector<std::string> paths{source.path};
  paths.insert(paths.end(), source.also.begin(), source.also.end());
  return paths;
}

}  // namespace

Input input_of_run(const ReadMemory& read, const RunRequest& request, const Context& context) {
  return read ? read(request, context) : read_input_of(request, context, request.tell);
}

RunResult run_from(const ReadMemory& read, const RunRequest& request, Context& context) {
  RunSteps steps(request);
  if (read) steps.read(context, [&] { return read(request, context); });
  return steps.finish(context);
}

void bind_source(nb::module_& m) {
  bind_given_grid(m);
  nb::class_<Source>(m, "Source", "What one run starts from.")
      .def_prop_ro("is_file", &Source::is_file)
      .def_static("files", files, nb::arg("paths"))
      .def_static("triangles", triangles, nb::arg("name"), nb::arg("vertices"), nb::arg("faces"), nb::arg("attributes"),
                  nb::arg("regions_of").none(),
                  nb::sig("def triangles(name: str, vertices: typing.Any, faces: typing.Any, attributes: "
                          "list[tuple[str, str, typing.Any, list[str]]], regions_of: RunResult | None) -> Source"))
      .def_static("polygons", polygons, nb::arg("name"), nb::arg("vertices"), nb::arg("sizes"), nb::arg("corners"),
                  nb::sig("def polygons(name: str, vertices: typing.Any, sizes: typing.Any, corners: typing.Any) -> "
                          "Source"))
      .def_static("points", points, nb::arg("positions"), nb::arg("normals").none(),
                  nb::sig("def points(positions: typing.Any, normals: typing.Any) -> Source"))
      .def_static(
          "volume", volume, nb::arg("values"), nb::arg("origin"), nb::arg("steps"), nb::arg("sides"),
          nb::arg("is_mask"), nb::arg("periodic"),
          nb::sig("def volume(values: typing.Any, origin: collections.abc.Sequence[float], steps: "
                  "collections.abc.Sequence[collections.abc.Sequence[float]], sides: str, is_mask: bool, periodic: "
                  "collections.abc.Sequence[bool]) -> Source"))
      .def_static(
          "sparse", sparse, nb::arg("coordinates"), nb::arg("values"), nb::arg("background"), nb::arg("is_level_set"),
          nb::arg("origin"), nb::arg("steps"),
          nb::sig(
              "def sparse(coordinates: typing.Any, values: typing.Any, background: float, is_level_set: bool, origin: "
              "collections.abc.Sequence[float], steps: "
              "collections.abc.Sequence[collections.abc.Sequence[float]]) -> Source"))
      .def_static("vdb", vdb_source, nb::arg("name"), nb::arg("bytes"),
                  nb::sig("def vdb(name: str, bytes: typing.Any) -> Source"))
      .def_static("labels", labels, nb::arg("values"), nb::arg("lattice"),
                  nb::sig("def labels(values: typing.Any, lattice: LabelLattice) -> Source"))
      .def("set_velocities_of_vertices", set_velocities_of_vertices, nb::arg("velocities"), nb::arg("vertices"),
           nb::arg("faces"),
           nb::sig("def set_velocities_of_vertices(self, velocities: typing.Any, vertices: typing.Any, faces: "
                   "typing.Any) -> None"))
      .def(
          "add_grid", [](Source& source, const GivenGrid& grid) { source.grids.push_back(grid.field); },
          nb::arg("grid"))
      .def("set_sizing", set_sizing, nb::arg("lengths"), nb::arg("origin"), nb::arg("steps"),
           nb::sig("def set_sizing(self, lengths: typing.Any, origin: collections.abc.Sequence[float], steps: "
                   "collections.abc.Sequence[collections.abc.Sequence[float]]) -> None"))
      .def("set_sizing_of_vertices", set_sizing_of_vertices, nb::arg("lengths"),
           nb::sig("def set_sizing_of_vertices(self, lengths: typing.Any) -> None"))
      .def("set_regions", set_regions, nb::arg("labels"), nb::arg("background"), nb::arg("names"),
           nb::sig("def set_regions(self, labels: typing.Any, background: int, names: dict[int, str]) -> None"))
      .def("set_dropped", set_dropped, nb::arg("dropped"))
      .def("__getstate__", state_of)
      .def("__setstate__",
           [](Source& source, const std::vector<std::string>& paths) { new (&source) Source(files(paths)); })
      .def("set_velocities", set_velocities, nb::arg("vectors"), nb::arg("origin"), nb::arg("steps"),
           nb::sig("def set_velocities(self, vectors: typing.Any, origin: collections.abc.Sequence[float], steps: "
                   "collections.abc.Sequence[collections.abc.Sequence[float]]) -> None"));
  m.def(
      "split_polygons", split, nb::arg("name"), nb::arg("vertices"), nb::arg("sizes"), nb::arg("corners"),
      nb::sig("def split_polygons(name: str, vertices: typing.Any, sizes: typing.Any, corners: typing.Any) -> "
              "typing.Any"),
      "The triangles of faces of any number of corners, in their order; what has no area or no finite place has none.");
}

}  // namespace isoshell::python
