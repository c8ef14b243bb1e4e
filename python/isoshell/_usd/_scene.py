"""The mesh prims of a stage of USD, where they stand in the world."""

from __future__ import annotations

import contextlib
import os
from collections import Counter
from typing import Any, Callable, Iterator, Optional, Sequence

from .._errors import Error, note, warn
from .._isoshell import ErrorCode
from . import reason_of, unreadable

Placed = tuple[Any, Any]  # a prim, and its matrix to the world
MAX_DEPTH = 32  # of instancers in instancers, which may go round


@contextlib.contextmanager
def reading(pxr: Any, file: str) -> Iterator[None]:
    """What USD says meanwhile stays off the terminal, and what it throws is an Error of code UNREADABLE_INPUT."""
    delegate = pxr.UsdUtils.CoalescingDiagnosticDelegate()
    try:
        yield
    except (pxr.Tf.ErrorException, RuntimeError, TypeError, UnicodeDecodeError) as error:
        raise unreadable(file, f"USD cannot read it: {reason_of(error)}") from error
    finally:
        delegate.TakeUncoalescedDiagnostics()
        del delegate


def open_stage(pxr: Any, file: str) -> Any:
    """The stage of a file.

    Raises:
        Error: of code UNREADABLE_INPUT for what is no file of USD.
    """
    if not os.path.isfile(file):
        raise unreadable(file, "is a directory" if os.path.isdir(file) else "no such file")
    stage = pxr.Usd.Stage.Open(file)
    if not stage:
        raise unreadable(file, "USD cannot read it")
    broken = stage.GetCompositionErrors()
    if broken:
        warn(f"{file}: {len(broken)} references or layers are not resolved, and what they hold is missing: {broken[0]}")
    return stage


def time_of(pxr: Any, stage: Any, time: Optional[float]) -> Any:
    """The time code to read at: where the stage starts, unless it is given."""
    if time is not None:
        return pxr.Usd.TimeCode(float(time))
    if stage.HasAuthoredTimeCodeRange():
        return pxr.Usd.TimeCode(stage.GetStartTimeCode())
    return pxr.Usd.TimeCode.EarliestTime()


def root_of(pxr: Any, stage: Any, file: str, name: Optional[str]) -> Any:
    """The prim of that path, or the whole stage.

    Raises:
        Error: of code USAGE for a path that names none.
    """
    if not name:
        return stage.GetPseudoRoot()
    path = name if name.startswith("/") else f"/{name}"
    if not pxr.Sdf.Path.IsValidPathString(path):
        raise Error(f"{file}: '{name}' is no path of a prim; give one such as {file}:/World/Mesh", stage="read")
    prim = stage.GetPrimAtPath(path)
    if not prim:
        near = [str(p.GetPath()) for p in _all(pxr, stage.GetPseudoRoot()) if p.IsA(pxr.UsdGeom.Mesh)][:5]
        raise Error(f"{file}: there is no prim {path}; its first meshes are {', '.join(near) or 'none'}", stage="read")
    return prim


def meshes_of(pxr: Any, file: str, root: Any, time: Any, purposes: Sequence[str]) -> list[Placed]:
    """Every mesh that is seen from the root on, with those of instances; a root that is a mesh is always seen.

    Raises:
        Error: of code NOTHING_TO_MESH without one.
    """
    cache = pxr.UsdGeom.XformCache(time)
    if root.IsA(pxr.UsdGeom.Mesh):
        return [(root, cache.GetLocalToWorldTransform(root))]
    hidden: Counter[str] = Counter()

    def is_seen(prim: Any) -> bool:
        image = pxr.UsdGeom.Imageable(prim)
        if image.ComputeVisibility(time) == pxr.UsdGeom.Tokens.invisible:
            hidden["invisible"] += 1
        elif image.ComputePurpose() not in purposes:
            hidden[f"of the purpose {image.ComputePurpose()}"] += 1
        else:
            return True
        return False

    found = list(_walk(pxr, root, time, is_seen, cache.GetLocalToWorldTransform, 0))
    left_out = ", ".join(f"{count} {what}" for what, count in sorted(hidden.items()))
    if not found:
        raise Error(f"{file}: {root.GetPath()} has no mesh that is seen{f' (left out: {left_out})' if hidden else ''}"
                    f"{_other_shapes(pxr, root)}; name the mesh to read as {file}:/World/Mesh",
                    ErrorCode.NOTHING_TO_MESH, "read")
    if hidden:
        note(f"{file}: meshes left out: {left_out}")
    return found


def is_skinned(pxr: Any, mesh: Any) -> bool:
    """Whether a mesh is bound to joints, or has blend shapes."""
    binding = pxr.UsdSkel.BindingAPI(mesh)
    joints = pxr.UsdGeom.PrimvarsAPI(mesh).FindPrimvarWithInheritance("skel:jointIndices")
    is_bound = bool(binding.GetInheritedSkeleton()) and joints and joints.HasValue()
    return bool(is_bound or binding.GetBlendShapeTargetsRel().GetTargets())


def sampled_times(pxr: Any, root: Any) -> list[float]:
    """When something changes of the meshes from the root on, of their places, or of whether they are seen."""
    times: set[float] = set()
    seen: set[Any] = set()

    def look_at_place(prim: Any) -> None:
        if not prim or prim.IsPseudoRoot() or prim.GetPath() in seen:
            return
        seen.add(prim.GetPath())
        times.update(pxr.UsdGeom.Xformable(prim).GetTimeSamples() if prim.IsA(pxr.UsdGeom.Xformable) else [])
        times.update(pxr.UsdGeom.Imageable(prim).GetVisibilityAttr().GetTimeSamples())
        look_at_place(prim.GetParent())

    def look(top: Any) -> None:
        for prim in _all(pxr, top):
            is_instancer = prim.IsA(pxr.UsdGeom.PointInstancer)
            if prim.GetPath() in seen or not is_instancer and not prim.IsA(pxr.UsdGeom.Mesh):
                continue
            look_at_place(prim)
            for attribute in prim.GetAuthoredAttributes():
                times.update(attribute.GetTimeSamples())
            if is_instancer:
                for target in pxr.UsdGeom.PointInstancer(prim).GetPrototypesRel().GetForwardedTargets():
                    if prim.GetStage().GetPrimAtPath(target):
                        look(prim.GetStage().GetPrimAtPath(target))

    look(root)
    return sorted(times)


def _all(pxr: Any, root: Any) -> Any:
    return pxr.Usd.PrimRange(root, pxr.Usd.TraverseInstanceProxies())


def _other_shapes(pxr: Any, root: Any) -> str:
    kinds = Counter(str(prim.GetTypeName()) for prim in _all(pxr, root)
                    if prim.IsA(pxr.UsdGeom.Gprim) and not prim.IsA(pxr.UsdGeom.Mesh))
    counts = ", ".join(f"{count} {kind}" for kind, count in sorted(kinds.items()))
    return f"; its {counts} are not read" if kinds else ""


def _walk(pxr: Any, root: Any, time: Any, is_seen: Callable[[Any], bool], place: Callable[[Any], Any],
          depth: int) -> Iterator[Placed]:
    prims = iter(_all(pxr, root))
    for prim in prims:
        if prim.IsA(pxr.UsdGeom.PointInstancer):
            prims.PruneChildren()  # its prototypes stand where the instances are
            if is_seen(prim):
                yield from _instances(pxr, prim, time, is_seen, place(prim), depth + 1)
        elif prim.IsA(pxr.UsdGeom.Mesh) and is_seen(prim):
            yield prim, place(prim)


def _instances(pxr: Any, prim: Any, time: Any, is_seen: Callable[[Any], bool], to_world: Any,
               depth: int) -> Iterator[Placed]:
    if depth > MAX_DEPTH:
        raise unreadable(str(prim.GetPath()), f"instancers are nested more than {MAX_DEPTH} deep")
    instancer = pxr.UsdGeom.PointInstancer(prim)
    kinds = instancer.GetProtoIndicesAttr().Get(time) or []
    targets = instancer.GetPrototypesRel().GetForwardedTargets()
    keep = instancer.ComputeMaskAtTime(time)
    matrices = instancer.ComputeInstanceTransformsAtTime(
        time, time, pxr.UsdGeom.PointInstancer.IncludeProtoXform, pxr.UsdGeom.PointInstancer.IgnoreMask)
    if len(matrices) != len(kinds):
        raise unreadable(str(prim.GetPath()), f"it has {len(kinds)} protoIndices and {len(matrices)} places")
    cache = pxr.UsdGeom.XformCache(time)
    for i, kind in enumerate(kinds):
        if keep and not keep[i]:
            continue
        if not 0 <= kind < len(targets):
            raise unreadable(str(prim.GetPath()), f"protoIndices[{i}] is {kind}, and there are {len(targets)} "
                                                  "prototypes")
        prototype = prim.GetStage().GetPrimAtPath(targets[kind])
        if not prototype:
            raise unreadable(str(prim.GetPath()), f"its prototype {targets[kind]} is missing")
        matrix = matrices[i] * to_world

        def place(p: Any, prototype: Any = prototype, matrix: Any = matrix) -> Any:
            return cache.ComputeRelativeTransform(p, prototype)[0] * matrix

        yield from _walk(pxr, prototype, time, is_seen, place, depth)
