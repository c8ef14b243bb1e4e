#include "values/grid_source.h"

#include <nanobind/stl/array.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "isoshell/error.h"
#include "isoshell/io/memory_grid.h"
#include "isoshell/io/memory_input.h"
#include "isoshell/run/run.h"
#include "values/labels.h"
#include "vdb_isomesh/memory.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

constexpr char kName[] = "volume";

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::usage, "arguments", what); }

bool is_of(const AnyArray& array, nb::dlpack::dtype_code code, int bits) {
  return array.dtype().code == uint8_t(code) && array.dtype().bits == bits;
}

/// Whether rows follow one another without a gap, if there are some.
bool is_packed(const AnyArray& array) {
  if (array.size() == 0) return true;
  int64_t stride = 1;
  for (size_t axis = array.ndim(); axis-- > 0; stride *= int64_t(array.shape(axis)))
    if (array.shape(axis) > 1 && array.stride(axis) != stride) return false;
  return true;
}

View<const Voxel> voxels_of(const AnyArray& array) {
  static_assert(sizeof(Voxel) == 3 * sizeof(int32_t), "voxels are rows of three whole numbers");
  if (array.ndim() != 2 || array.shape(1) != 3 || !is_of(array, nb::dlpack::dtype_code::Int, 32) || !is_packed(array))
    refuse("coordinates must be int32 of the shape (K, 3), without gaps");
  return {static_cast<const Voxel*>(array.data()), int64_t(array.shape(0))};
}

View<const float> values_of(const AnyArray& array) {
  const float* const first = floats_of("values", array, 1);
  if (!is_packed(array)) refuse("values must be without gaps");
  return {first, int64_t(array.shape(0))};
}

View<const char> bytes_of(const AnyArray& bytes) {
  if (bytes.ndim() != 1 || !is_of(bytes, nb::dlpack::dtype_code::UInt, 8) || !is_packed(bytes))
    refuse("the bytes of a volume must be uint8 in one row, without gaps");
  return {static_cast<const char*>(bytes.data()), int64_t(bytes.shape(0))};
}

/// The largest magnitude of those that are finite.
double largest_of(View<const float> values) {
  float largest = 0;
  for (const float value : values)
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  return double(largest);
}

using Steps = std::array<Triple, 3>;  // from a value to the next, along each axis of the array

std::array<WorldPoint, 3> steps_of(const Steps& steps) {
  return {point_of(steps[0]), point_of(steps[1]), point_of(steps[2])};
}

/// 0 is what is free.
int64_t limit_of(int64_t max_bytes) { return max_bytes > 0 ? max_bytes : tool::default_memory_limit_bytes(); }

GivenGrid dense_grid(const std::string& name, const AnyArray& values, bool is_whole, const Triple& origin,
                     const Steps& steps, int64_t max_bytes) {
  DenseVolume volume;
  volume.values = floats_of("values", values, 3);
  for (size_t i = 0; i < 3; ++i) volume.size[i] = int64_t(values.shape(i)), volume.stride[i] = values.stride(i);
  volume.step_world = steps_of(steps);
  volume.origin_world = point_of(origin);
  const nb::gil_scoped_release others_run;
  return {grid_field(volume, name, is_whole, limit_of(max_bytes))};
}

GivenGrid sparse_grid_of(const std::string& name, const AnyArray& coordinates, const AnyArray& values,
                         double background, bool is_level_set, const Triple& origin, const Steps& steps,
                         int64_t max_bytes) {
  const SparseVolume volume{voxels_of(coordinates), values_of(values), background,
                            is_level_set,           steps_of(steps),   point_of(origin)};
  const nb::gil_scoped_release others_run;
  return {grid_field(sparse_grid(volume, name, limit_of(max_bytes)), name)};
}

GivenGrid vdb_grid(const std::string& name, const AnyArray& bytes) {
  const View<const char> given = bytes_of(bytes);
  const nb::gil_scoped_release others_run;
  return {grid_field_of_vdb(given, name)};
}

GivenGrid vector_grid(const std::string& name, const GivenGrid& x, const GivenGrid& y, const GivenGrid& z) {
  return {vector_field(name, {x.field, y.field, z.field})};
}

}  // namespace

void bind_given_grid(nb::module_& m) {
  nb::class_<GivenGrid>(m, "GivenGrid", "Values that vertices of a result get.")
      .def_static(
          "dense", dense_grid, nb::arg("name"), nb::arg("values"), nb::arg("is_whole"), nb::arg("origin"),
          nb::arg("steps"), nb::arg("max_bytes"),
          nb::sig("def dense(name: str, values: typing.Any, is_whole: bool, origin: collections.abc.Sequence[float], "
                  "steps: collections.abc.Sequence[collections.abc.Sequence[float]], max_bytes: int) -> GivenGrid"))
      .def_static("sparse", sparse_grid_of, nb::arg("name"), nb::arg("coordinates"), nb::arg("values"),
                  nb::arg("background"), nb::arg("is_level_set"), nb::arg("origin"), nb::arg("steps"),
                  nb::arg("max_bytes"),
                  nb::sig("def sparse(name: str, coordinates: typing.Any, values: typing.Any, background: float, "
                          "is_level_set: bool, origin: collections.abc.Sequence[float], steps: "
                          "collections.abc.Sequence[collections.abc.Sequence[float]], max_bytes: int) -> GivenGrid"))
      .def_static("vdb", vdb_grid, nb::arg("name"), nb::arg("bytes"),
                  nb::sig("def vdb(name: str, bytes: typing.Any) -> GivenGrid"))
      .def_static("vector", vector_grid, nb::arg("name"), nb::arg("x"), nb::arg("y"), nb::arg("z"));
}

Source sparse_source(const AnyArray& coordinates, const AnyArray& values, double background, bool is_level_set,
                     const WorldPoint& origin, const std::array<WorldPoint, 3>& steps) {
  const SparseVolume given{voxels_of(coordinates), values_of(values), background, is_level_set, steps, origin};
  Source source;
  source.read = [given](const RunRequest& request, const Context& context) {
    SparseVolume volume = given;
    const auto is_inside = [](float value) { return value < 0; };
    const bool has_iso = request.input.iso.has_value();
    volume.is_level_set |= !has_iso && std::any_of(volume.values.begin(), volume.values.end(), is_inside);
    if (std::isnan(volume.background)) volume.background = has_iso ? 0 : largest_of(volume.values);
    return input_of(sparse_grid(volume, kName, context.memory_limit_bytes), kName, input_request_of(request), context,
                    request.tell);
  };
  source.kept = nb::make_tuple(coordinates, values);
  return source;
}

Source vdb_source(const std::string& name, const AnyArray& bytes) {
  const View<const char> given = bytes_of(bytes);
  Source source;
  source.read = [name, given](const RunRequest& request, const Context& context) {
    return input_of_vdb(given, name, input_request_of(request), context, request.tell);
  };
  source.kept = nb::cast(bytes);
  return source;
}

}  // namespace isoshell::python
