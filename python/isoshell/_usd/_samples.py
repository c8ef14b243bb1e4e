"""A sequence of results as one stage of USD with time samples."""

from __future__ import annotations

import os
import shutil
import tempfile
from typing import TYPE_CHECKING, Any, Optional, Union

from .._paths import writing
from .._result import Result
from . import Origin, library, reason_of
from ._attributes import PrimvarWriter, velocity_of
from ._materials import write_materials
from ._regions import SampledRegions
from ._write import MATERIALS, begin_stage, define_mesh, offset_of, save_stage, write_shape

if TYPE_CHECKING:
    import numpy as np

    Array = np.ndarray[Any, np.dtype[Any]]

MOTION = ("vx", "vy", "vz")
HELD_BYTES = 64 << 20  # of samples in memory, about


class SampledStage:
    """A stage that grows sample by sample, in a binary file beside its target, and is written there in the end.

    What was added lies in that file, so that the length of a sequence takes no memory.
    """

    def __init__(self, target: str, overwrite: bool) -> None:
        self._pxr = library()
        self._target = target
        self._overwrite = overwrite
        self._folder = ""
        self._stage: Any = None
        self._mesh: Any = None
        self._primvars: Any = None
        self._materials: Any = None
        self._regions: Any = None
        self._last: Optional[Union[int, float]] = None
        self._held_bytes = 0

    def add(self, result: Result) -> None:
        """The sample at the time code that is the frame of the result."""
        with writing(self._target, self._pxr.Tf.ErrorException, reason_of):
            if self._stage is None:
                self._begin(result, result.origin or Origin())
            self._add(result)

    def _add(self, result: Result) -> None:
        assert result.frame is not None
        time = self._pxr.Usd.TimeCode(result.frame)
        write_shape(self._pxr, self._mesh, result, self._offset, time)
        self._add_velocities(result, time)
        self._primvars.write(result, MOTION, result.frame)
        self._materials.add(result, time)
        self._regions.add(result, time)
        self._stage.SetEndTimeCode(result.frame)
        self._last = result.frame
        self._held_bytes += 2 * (result.vertices.nbytes + result.faces.nbytes)
        if self._held_bytes > HELD_BYTES:
            self._stage.GetRootLayer().Save()
            self._held_bytes = 0

    def finish(self) -> None:
        """Writes the stage, if it has a sample."""
        if self._stage is not None:
            save_stage(self._pxr, self._stage, self._target, self._overwrite)

    def discard(self) -> None:
        """Lets go of what was added."""
        self._stage = self._mesh = self._primvars = self._materials = self._regions = None
        if self._folder:
            shutil.rmtree(self._folder, ignore_errors=True)
            self._folder = ""

    def _begin(self, result: Result, origin: Origin) -> None:
        pxr = self._pxr
        folder = os.path.dirname(os.path.abspath(self._target))
        self._folder = tempfile.mkdtemp(prefix=".isoshell-", dir=folder)
        name = os.path.splitext(os.path.basename(self._target))[0]
        self._stage = stage = pxr.Usd.Stage.CreateNew(os.path.join(self._folder, f"{name}.usdc"))
        stage.SetStartTimeCode(result.frame)
        stage.SetTimeCodesPerSecond(origin.time_codes_per_second)
        stage.SetFramesPerSecond(origin.time_codes_per_second)
        root = begin_stage(pxr, stage, origin, origin.up_axis, origin.meters_per_unit)
        name = pxr.Tf.MakeValidIdentifier(origin.name)
        path = root.GetPath().AppendChild(f"{name}_1" if name == MATERIALS else name)
        self._mesh = define_mesh(pxr, stage, path, result)
        self._offset = offset_of(result.vertices)
        self._time_codes_per_second = origin.time_codes_per_second
        self._primvars = PrimvarWriter(pxr, self._mesh, origin, is_sampled=True)
        self._materials = _Materials(pxr, stage, root.GetPath().AppendChild(MATERIALS), self._mesh, folder)
        self._regions = SampledRegions(pxr, self._mesh)

    def _add_velocities(self, result: Result, time: Any) -> None:
        """The motion since the sample before, in units a second; none where a frame follows no other. Those of a grid
        take its place."""
        import numpy as np

        if velocity_of(result) is not None:
            return
        parts = [result.attributes[name] for name in MOTION if result.domains.get(name) == "vertex"]
        attribute = self._mesh.GetVelocitiesAttr()
        if self._last is not None and result.frame is not None and len(parts) == len(MOTION):
            a_second = self._time_codes_per_second / (result.frame - self._last)
            velocities = (np.column_stack(parts) * a_second).astype(np.float32)
            if not attribute.HasAuthoredValue():
                self._mesh.CreateVelocitiesAttr().Set(self._pxr.Sdf.ValueBlock(), self._stage.GetStartTimeCode())
            attribute.Set(self._pxr.Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(velocities)), time)
        elif attribute.HasAuthoredValue():
            attribute.Set(self._pxr.Sdf.ValueBlock(), time)


class _Materials:
    """Which faces have which material, sample by sample: a subset of faces for each, but for one that all have at
    first, which the mesh is bound to."""

    def __init__(self, pxr: Any, stage: Any, scope: Any, mesh: Any, folder: str) -> None:
        self._pxr = pxr
        self._stage = stage
        self._scope = scope
        self._mesh = mesh
        self._folder = folder
        self._of_all: Optional[str] = None
        self._subsets: dict[str, Any] = {}
        self._first: Any = None

    def add(self, result: Result, time: Any) -> None:
        """The materials of a result."""
        import numpy as np

        labels = result.labels.get("material", []) if result.domains.get("material") == "face" else []
        numbers = result.attributes["material"] if labels else np.zeros(0, np.int32)
        used = {label: np.flatnonzero(numbers == i).astype(np.int32) for i, label in enumerate(labels)
                if np.any(numbers == i)}
        if self._first is None:
            self._first = time
            self._of_all = next((label for label, faces in used.items() if len(faces) == len(result.faces)), None)
            if self._of_all is not None:
                self._bind(self._mesh.GetPrim(), self._of_all, result)
        used.pop(self._of_all or "", None)
        for label in set(used) - set(self._subsets):
            self._define(label, result, time)
        for label, subset in self._subsets.items():
            faces = used.get(label, np.zeros(0, np.int32))
            subset.GetIndicesAttr().Set(self._pxr.Vt.IntArray.FromNumpy(faces), time)

    def _define(self, label: str, result: Result, time: Any) -> None:
        pxr = self._pxr
        binding = pxr.UsdShade.MaterialBindingAPI.Apply(self._mesh.GetPrim())
        empty = pxr.Vt.IntArray()
        subset = binding.CreateMaterialBindSubset(pxr.Tf.MakeValidIdentifier(label or "material"), empty)
        subset.GetIndicesAttr().ClearDefault()
        subset.GetIndicesAttr().Set(empty, self._first)
        binding.SetMaterialBindSubsetsFamilyType(pxr.UsdGeom.Tokens.nonOverlapping)
        self._bind(subset.GetPrim(), label, result)
        self._subsets[label] = subset

    def _bind(self, prim: Any, label: str, result: Result) -> None:
        origin = result.origin or Origin()
        made = write_materials(self._pxr, self._stage, self._scope, [label], origin.materials, self._folder)
        self._pxr.UsdShade.MaterialBindingAPI.Apply(prim).Bind(self._pxr.UsdShade.Material(made[label]))
