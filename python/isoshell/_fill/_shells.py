"""The closed surfaces that bound the regions of a result."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Sequence

from .._errors import Error

if TYPE_CHECKING:
    import numpy as np

    from .._result import Result

    Array = np.ndarray[Any, np.dtype[Any]]


class Part(NamedTuple):
    """A connected piece of a region: what lies within one closed surface, but not within those of its hollows."""

    label: int
    name: str
    shells: list[Array]  # (F, 3) each, of the result's vertices, facing out of the piece; the outer one first


def parts_of(result: Result) -> list[Part]:
    """All pieces of all regions; without regions those of the mesh, of label 1.

    Raises:
        Error: of code USAGE for a mesh that is not closed.
    """
    import numpy as np

    background = result.regions["background"]
    labels = np.setdiff1d(result.regions["labels"], background).tolist()
    numbers = {row.tobytes(): number for number, row in enumerate(_without_signs_of_zero(result.vertices))}
    if not labels and not _is_closed(result.faces):
        raise Error("the mesh is open, and encloses nothing that could be filled; close its borders", stage="fill")
    parts = []
    for label in labels or [1]:
        mesh: Any = result.region(label) if labels else result  # where a region touches itself its sheets are apart
        corners = np.array([numbers[row.tobytes()] for row in _without_signs_of_zero(mesh.vertices)], np.int64)
        shells = [corners[faces] for faces in _connected(np.asarray(mesh.faces), len(mesh.vertices))]
        name = mesh.name if labels else "the mesh"
        parts += [Part(label, name, nested) for nested in _nested(result.vertices, shells, name)]
    return parts


def _without_signs_of_zero(vertices: Array) -> Array:
    """Places that are the same have the same bytes."""
    import numpy as np

    return np.ascontiguousarray(vertices) + 0.0


def volume_of(vertices: Array, faces: Array) -> float:
    import numpy as np

    a, b, c = (vertices[faces[:, i]] - vertices[faces[0, 0]] for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6


def _is_closed(faces: Array) -> bool:
    """Whether every edge that a face passes is passed in the other direction by as many."""
    import numpy as np

    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    there, back = (np.sort(ends[:, i] * (ends.max() + 1) + ends[:, 1 - i]) for i in (0, 1))
    return np.array_equal(there, back)


def _connected(faces: Array, count: int) -> list[Array]:
    """The faces of each set of faces that share vertices; sets by their first face."""
    import numpy as np

    root = np.arange(count)
    while True:  # each vertex takes the least number around it, and then the number of that
        least = root[faces].min(axis=1)
        for i in range(3):
            np.minimum.at(root, faces[:, i], least)
        before, root = root, root[root]
        if np.array_equal(before, root) and (root[faces] == root[faces[:, :1]]).all():
            break
    of_face = root[faces[:, 0]]
    return [faces[of_face == number] for number in dict.fromkeys(of_face.tolist())]


def _nested(vertices: Array, shells: Sequence[Array], name: str) -> list[list[Array]]:
    """Outer shells, each with those of the hollows in it."""
    volumes = [volume_of(vertices, shell) for shell in shells]
    outer = sorted((i for i, volume in enumerate(volumes) if volume > 0), key=lambda i: volumes[i])
    pieces = {i: [shells[i]] for i in sorted(outer)}
    for i, volume in enumerate(volumes):
        if volume > 0:
            continue
        inside = vertices[shells[i][0]].mean(axis=0)
        around = next((o for o in outer if volumes[o] > -volume and _winds_around(vertices, shells[o], inside)), None)
        if around is None:
            x, y, z = inside
            raise Error(f"{name} has a surface that is inside out near {x:g} {y:g} {z:g}, and lies in no other of its "
                        "surfaces", stage="fill")
        pieces[around].append(shells[i])
    return [*pieces.values()]


def _winds_around(vertices: Array, faces: Array, point: Array) -> bool:
    """Whether the solid angle that a closed surface has from there is a full one."""
    import numpy as np

    a, b, c = (vertices[faces[:, i]] - point for i in range(3))
    la, lb, lc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c))
    along = (la * lb * lc + np.einsum("ij,ij->i", a, b) * lc + np.einsum("ij,ij->i", b, c) * la +
             np.einsum("ij,ij->i", c, a) * lb)
    return bool(np.arctan2(volume, along).sum() > np.pi)
