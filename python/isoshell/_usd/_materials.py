"""Materials of USD: which faces are bound to which, and their networks, kept from one stage to another."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from .._errors import note
from . import unreadable
from ._faces import Column, Triangles, values_of

if TYPE_CHECKING:
    import numpy as np

    Array = np.ndarray[Any, np.dtype[Any]]

SCOPE = "/Materials"


class Materials:
    """The materials that faces are bound to, by labels: their names, told apart where several have the same."""

    def __init__(self, pxr: Any, time: Any) -> None:
        self._pxr = pxr
        self._time = time
        self._label_of: dict[str, str] = {}
        self._stage = pxr.Usd.Stage.CreateInMemory()

    def add_column(self, prim: Any, triangles: Triangles) -> None:
        """Adds the attribute material, where the prim or a subset of its faces is bound to one."""
        import numpy as np

        labels: list[str] = []

        def number(bound: Any) -> int:
            material = bound.ComputeBoundMaterial()[0]
            if not material:
                return -1
            label = self._label(material.GetPrim())
            if label not in labels:
                labels.append(label)
            return labels.index(label)

        api = self._pxr.UsdShade.MaterialBindingAPI
        values = np.full((triangles.face_count, 1), number(api(prim)), np.int32)
        for subset in api(prim).GetMaterialBindSubsets():
            if subset.GetElementTypeAttr().Get() != self._pxr.UsdGeom.Tokens.face:
                continue
            faces = values_of(subset.GetIndicesAttr(), self._time)
            if np.any((faces < 0) | (faces >= triangles.face_count)):
                raise unreadable(str(subset.GetPath()), f"its indices name a face that is none of the "
                                                        f"{triangles.face_count} of the mesh")
            values[faces] = number(api(subset.GetPrim()))
        if labels:
            triangles.columns["material"] = Column(values, "face", labels)

    def text(self) -> str:
        """All of them as a layer; empty without any."""
        return self._stage.GetRootLayer().ExportToString() if self._label_of else ""

    def _label(self, prim: Any) -> str:
        path = str(prim.GetPath())
        if path not in self._label_of:
            label, count = prim.GetName(), 1
            while label in self._label_of.values():
                count += 1
                label = f"{prim.GetName()}_{count}"
            self._label_of[path] = label
            self._copy(prim, self._pxr.Sdf.Path(f"{SCOPE}/{label}"))
        return self._label_of[path]

    def _copy(self, material: Any, to: Any) -> None:
        """Every prim of a material as composed; what it says at other times is not kept."""
        pxr, root = self._pxr, material.GetPath()
        for prim in pxr.Usd.PrimRange(material, pxr.Usd.TraverseInstanceProxies()):
            made = self._stage.DefinePrim(prim.GetPath().ReplacePrefix(root, to), prim.GetTypeName())
            for schema in prim.GetAppliedSchemas():
                made.AddAppliedSchema(schema)
            for attribute in prim.GetAuthoredAttributes():
                self._copy_attribute(attribute, made, root, to)

    def _copy_attribute(self, attribute: Any, made: Any, root: Any, to: Any) -> None:
        copy = made.CreateAttribute(attribute.GetName(), attribute.GetTypeName(), attribute.IsCustom(),
                                    attribute.GetVariability())
        value = attribute.Get(self._time)
        if value is not None:
            copy.Set(self._absolute(attribute, value))
        if attribute.HasColorSpace():
            copy.SetColorSpace(attribute.GetColorSpace())
        sources = attribute.GetConnections()
        inside = [path.ReplacePrefix(root, to) for path in sources if path.HasPrefix(root)]
        if len(inside) < len(sources):
            note(f"{attribute.GetPath()}: what it is connected to lies outside of its material, and is not kept")
        if inside:
            copy.SetConnections(inside)

    def _absolute(self, attribute: Any, value: Any) -> Any:
        """Files by their full paths, so that they are found from another place."""
        pxr = self._pxr
        if isinstance(value, pxr.Sdf.AssetPathArray):
            return pxr.Sdf.AssetPathArray([self._absolute(attribute, v) for v in value])
        if not isinstance(value, pxr.Sdf.AssetPath) or not value.path:
            return value
        if value.resolvedPath:
            return pxr.Sdf.AssetPath(value.resolvedPath)
        specs = attribute.GetPropertyStack(self._time)
        return pxr.Sdf.AssetPath(specs[0].layer.ComputeAbsolutePath(value.path) if specs else value.path)


def write_materials(pxr: Any, stage: Any, scope: Any, labels: list[str], kept: str, folder: str) -> dict[str, Any]:
    """Defines a material for each label: as the source has it, or else a plain one. By label its prim."""
    source = pxr.Sdf.Layer.CreateAnonymous(".usda")
    if kept and not source.ImportFromString(kept):
        raise ValueError("the materials of an origin are no layer of USD")
    made = {}
    taken = {prim.GetName() for prim in pxr.UsdGeom.Scope.Define(stage, scope).GetPrim().GetChildren()}
    for label in labels:
        name = base = pxr.Tf.MakeValidIdentifier(label) if label else "material"
        while name in taken:
            name = f"{base}_{len(taken) + 1}"
        taken.add(name)
        path = scope.AppendChild(name)
        if source.GetPrimAtPath(f"{SCOPE}/{label}" if pxr.Sdf.Path.IsValidIdentifier(label) else SCOPE + "/_"):
            pxr.Sdf.CopySpec(source, f"{SCOPE}/{label}", stage.GetRootLayer(), path)
        else:
            _define_plain(pxr, stage, path)
        made[label] = stage.GetPrimAtPath(path)
        for prim in pxr.Usd.PrimRange(made[label]):
            for attribute in prim.GetAttributes():
                _make_relative(pxr, attribute, folder)
    return made


def _define_plain(pxr: Any, stage: Any, path: Any) -> None:
    material = pxr.UsdShade.Material.Define(stage, path)
    shader = pxr.UsdShade.Shader.Define(stage, path.AppendChild("Surface"))
    shader.CreateIdAttr("UsdPreviewSurface")
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")


def _make_relative(pxr: Any, attribute: Any, folder: str) -> None:
    value = attribute.Get()
    if isinstance(value, pxr.Sdf.AssetPath) and os.path.isabs(value.path):
        attribute.Set(pxr.Sdf.AssetPath(relative_asset(value.path, folder)))
    elif isinstance(value, pxr.Sdf.AssetPathArray):
        attribute.Set(pxr.Sdf.AssetPathArray([relative_asset(v.path, folder) if os.path.isabs(v.path) else v.path
                                              for v in value]))


def relative_asset(path: str, folder: str) -> str:
    """A file as a stage in that folder names it."""
    relative = os.path.relpath(path, folder).replace(os.sep, "/")
    return relative if relative.startswith("../") else f"./{relative}"
