#include "values/labels.h"

#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>

#include <algorithm>
#include <new>
#include <utility>

#include "isoshell/io/label_file.h"
#include "values/text.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

void write(const std::string& path, const AnyArray& labels, const LabelLattice& lattice, bool overwrite) {
  const LabelVolume volume = label_volume_of(labels, lattice);
  LabelWriteOptions options;
  options.overwrite = overwrite;
  const nb::gil_scoped_release released;
  write_labels(path, volume, options);
}

}  // namespace

LabelVolume label_volume_of(const AnyArray& labels, const LabelLattice& lattice) {
  LabelVolume volume;
  volume.labels = labels_of("labels", labels);
  for (size_t axis = 0; axis < 3; ++axis) {
    volume.size_vox[axis] = int32_t(std::min(labels.shape(axis), size_t(INT32_MAX)));
    volume.step_world[axis] = point_of(lattice.steps[axis]);
  }
  volume.origin_world = point_of(lattice.origin);
  volume.background = lattice.background;
  volume.smallest_island_vox = lattice.smallest_island_vox;
  volume.smoothing_vox = lattice.smoothing_vox;
  volume.is_periodic = lattice.is_periodic;
  for (const auto& [label, name] : lattice.names) volume.names.push_back({label, name});
  return volume;
}

void bind_labels(nb::module_& m) {
  nb::class_<LabelLattice>(m, "LabelLattice", "Where voxels of labels are, and what the regions are called.")
      .def(
          "__init__",
          [](LabelLattice* self, const Triple& origin, const std::array<Triple, 3>& steps, int32_t background,
             std::map<int32_t, std::string> names, int64_t smallest_island, double smoothing,
             std::array<bool, 3> periodic) {
            new (self) LabelLattice{origin, steps, background, std::move(names), smallest_island, smoothing, periodic};
          },
          nb::arg("origin"), nb::arg("steps"), nb::arg("background"), nb::arg("names"), nb::arg("smallest_island"),
          nb::arg("smoothing"), nb::arg("periodic"),
          nb::sig("def __init__(self, origin: collections.abc.Sequence[float], steps: "
                  "collections.abc.Sequence[collections.abc.Sequence[float]], background: int, names: dict[int, str], "
                  "smallest_island: int, smoothing: float, periodic: collections.abc.Sequence[bool]) -> None"));
  m.def("write_labels", write, nb::arg("path"), nb::arg("labels"), nb::arg("lattice"), nb::arg("overwrite"),
        nb::sig("def write_labels(path: str, labels: typing.Any, lattice: LabelLattice, overwrite: bool) -> None"));
}

}  // namespace isoshell::python
