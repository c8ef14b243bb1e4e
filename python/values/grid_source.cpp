#include "values/grid_source.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "isoshell/error.h"
#include "isoshell/io/memory_grid.h"
#include "isoshell/run/run.h"

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

/// The largest magnitude of those that are finite.
double largest_of(View<const float> values) {
  float largest = 0;
  for (const float value : values)
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  return double(largest);
}

}  // namespace

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
  if (bytes.ndim() != 1 || !is_of(bytes, nb::dlpack::dtype_code::UInt, 8) || !is_packed(bytes))
    refuse("the bytes of a volume must be uint8 in one row, without gaps");
  const View<const char> given{static_cast<const char*>(bytes.data()), int64_t(bytes.shape(0))};
  Source source;
  source.read = [name, given](const RunRequest& request, const Context& context) {
    return input_of_vdb(given, name, input_request_of(request), context, request.tell);
  };
  source.kept = nb::cast(bytes);
  return source;
}

}  // namespace isoshell::python
