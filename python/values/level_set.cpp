#include "values/level_set.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "isoshell/advanced/each_voxel.h"
#include "isoshell/advanced/voxel_set_of_leaves.h"
#include "isoshell/error.h"
#include "isoshell/io/vdb_file.h"
#include "values/arrays.h"
#include "values/packed.h"
#include "values/text.h"
#include "vdb_isomesh/memory.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

using DenseArray = nb::ndarray<nb::numpy, float, nb::ndim<3>, nb::c_contig>;
using Coordinates = nb::ndarray<nb::numpy, int32_t, nb::shape<-1, 3>, nb::c_contig>;
using Values = nb::ndarray<nb::numpy, float, nb::ndim<1>, nb::c_contig>;

/// As files of level sets have it.
float in_world(const LevelSet& set, double distance_vox) { return float(distance_vox * set.frame.voxel_size); }

float background_of(const LevelSet& set) { return in_world(set, set.band_vox); }

/// An array of numpy over the elements of a vector, which it owns.
template <class Array, class T>
Array owning(std::unique_ptr<std::vector<T>> values, std::initializer_list<size_t> shape) {
  T* const first = values->data();
  return Array(first, shape, owner_of(std::move(values)));
}

Coordinates coordinates(const MadeLevelSet& made) {
  const size_t count = size_t(made.set->voxels.voxel_count());
  auto rows = std::make_unique<std::vector<int32_t>>(3 * count);
  const Voxel first = made.set->frame.index_space().first;
  for_each_voxel(made.set->voxels, [&](Voxel v, int64_t i) {
    int32_t* const row = rows->data() + 3 * i;
    row[0] = first.x + v.x, row[1] = first.y + v.y, row[2] = first.z + v.z;
  });
  return owning<Coordinates>(std::move(rows), {count, 3});
}

Values values(const MadeLevelSet& made) {
  const size_t count = size_t(made.set->voxels.voxel_count());
  auto distances = std::make_unique<std::vector<float>>(count);
  for (size_t i = 0; i < count; ++i) (*distances)[i] = in_world(*made.set, double(made.set->distance_vox[int64_t(i)]));
  return owning<Values>(std::move(distances), {count});
}

struct VoxelBox {
  Voxel first{0, 0, 0};
  int64_t size[3] = {0, 0, 0};
};

/// Around all voxels.
VoxelBox box_of(const LevelSet& set) {
  constexpr int32_t kMost = std::numeric_limits<int32_t>::max();
  Voxel low{kMost, kMost, kMost}, high{-1, -1, -1};
  for_each_voxel(set.voxels, [&](Voxel v, int64_t) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  });
  if (set.voxels.voxel_count() == 0) return {};
  return {low, {int64_t(high.x) - low.x + 1, int64_t(high.y) - low.y + 1, int64_t(high.z) - low.z + 1}};
}

/// From NaN to the side of the voxel before along z; the box begins outside. Two voxels with the surface between them
/// are not both farther than half a voxel from it, so that one has a value.
void fill_sides(std::vector<float>& values, int64_t along_z, float background) {
  for (auto row = values.begin(); row != values.end(); row += along_z) {
    float side = background;
    for (auto value = row; value != row + along_z; ++value)
      if (std::isnan(*value))
        *value = side;
      else
        side = *value < 0 ? -background : background;
  }
}

DenseArray dense(const MadeLevelSet& made, int64_t max_bytes) {
  const LevelSet& set = *made.set;
  const VoxelBox box = box_of(set);
  const int64_t *const size = box.size, bytes = size[0] * size[1] * size[2] * int64_t(sizeof(float));
  const int64_t limit = max_bytes > 0 ? max_bytes : tool::default_memory_limit_bytes();
  if (limit > 0 && bytes > limit)
    throw Error(ErrorCode::out_of_memory, "memory",
                "an array of " + std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " +
                    std::to_string(size[2]) + " values takes " + std::to_string(bytes >> 20) +
                    " MiB, more than the limit of " + std::to_string(limit >> 20) +
                    " MiB; use coordinates and values, lower the resolution or raise max_memory");
  auto values = std::make_unique<std::vector<float>>(size_t(size[0] * size[1] * size[2]), NAN);
  for_each_voxel(set.voxels, [&](Voxel v, int64_t i) {
    const int64_t x = v.x - box.first.x, y = v.y - box.first.y, z = v.z - box.first.z;
    (*values)[size_t((x * size[1] + y) * size[2] + z)] = in_world(set, double(set.distance_vox[i]));
  });
  fill_sides(*values, size[2], background_of(set));
  return owning<DenseArray>(std::move(values), {size_t(size[0]), size_t(size[1]), size_t(size[2])});
}

/// Where coordinates (0, 0, 0) are, in world units.
std::array<double, 3> origin_of(const LevelSet& set) {
  const WorldPoint zero = set.frame.index_space().zero_world;
  return {zero.x, zero.y, zero.z};
}

void save(const MadeLevelSet& made, const std::string& path, const std::string& grid, bool half, bool overwrite) {
  save_level_set(path, *made.set, {grid, half, overwrite});
}

constexpr char kType[] = "isoshell.LevelSet";

template <class T>
Buffer<T> buffer_of(nb::handle state) {
  const std::vector<T> values = unpacked<T>(state, kType);
  Buffer<T> buffer(int64_t(values.size()));
  std::copy(values.begin(), values.end(), buffer.begin());
  return buffer;
}

nb::tuple state_of(const MadeLevelSet& made) {
  const LevelSet& set = *made.set;
  return nb::make_tuple(packed(&set.frame, 1), packed(set.voxels.leaf_key), packed(set.voxels.mask),
                        packed(set.distance_vox), set.band_vox);
}

/// Whether a pickled one has numbers that one has.
bool is_sound(const LevelSet& set) {
  const LatticeFrame& frame = set.frame;
  const auto is_finite = [](double value) { return std::isfinite(value); };
  return set.distance_vox.size() == set.voxels.voxel_count() && is_finite(frame.origin.x) &&
         is_finite(frame.origin.y) && is_finite(frame.origin.z) && is_finite(frame.voxel_size) &&
         frame.voxel_size > 0 && set.band_vox >= 1 && set.band_vox <= kMaxLevelSetBandVox &&
         std::all_of(set.distance_vox.begin(), set.distance_vox.end(), is_finite);
}

MadeLevelSet level_set_of_state(const nb::tuple& s) {
  try {
    if (s.size() != 5) refuse_state(kType);
    LevelSet set;
    const std::vector<LatticeFrame> frame = unpacked<LatticeFrame>(s[0], kType);
    if (frame.size() != 1) refuse_state(kType);
    set.frame = frame[0];
    set.voxels = voxel_set_of_leaves(buffer_of<uint64_t>(s[1]), buffer_of<LeafMask>(s[2]), set.frame.extent_vox);
    set.distance_vox = buffer_of<float>(s[3]);
    set.band_vox = nb::cast<double>(s[4]);
    if (!is_sound(set)) refuse_state(kType);
    return {std::make_shared<const LevelSet>(std::move(set))};
  } catch (const nb::cast_error&) {
    refuse_state(kType);
  }
}

}  // namespace

void bind_level_set(nb::module_& m) {
  nb::class_<MadeLevelSet>(m, "MadeLevelSet", "Signed distances near a surface.")
      .def("coordinates", coordinates, nb::sig("def coordinates(self) -> typing.Any"))
      .def("values", values, nb::sig("def values(self) -> typing.Any"))
      .def("dense", dense, nb::arg("max_bytes"), nb::sig("def dense(self, max_bytes: int) -> typing.Any"))
      .def("save", save, nb::arg("path"), nb::arg("grid"), nb::arg("half"), nb::arg("overwrite"),
           nb::call_guard<nb::gil_scoped_release>())
      .def("__getstate__", state_of, nb::sig("def __getstate__(self) -> tuple[typing.Any, ...]"))
      .def(
          "__setstate__",
          [](MadeLevelSet& made, const nb::tuple& state) { new (&made) MadeLevelSet(level_set_of_state(state)); },
          nb::sig("def __setstate__(self, state: tuple[typing.Any, ...], /) -> None"))
      .def_prop_ro("voxels", [](const MadeLevelSet& made) { return made.set->voxels.voxel_count(); })
      .def_prop_ro("voxel_size", [](const MadeLevelSet& made) { return made.set->frame.voxel_size; })
      .def_prop_ro("background", [](const MadeLevelSet& made) { return double(background_of(*made.set)); })
      .def_prop_ro("band", [](const MadeLevelSet& made) { return made.set->band_vox; })
      .def_prop_ro(
          "origin", [](const MadeLevelSet& made) { return origin_of(*made.set); },
          nb::for_getter(nb::sig("def origin(self, /) -> list[float]")));
}

}  // namespace isoshell::python
