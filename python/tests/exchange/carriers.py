"""A mesh with everything that a mesh may have, and what carries it from one run to the next."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any, Callable

import isoshell
import numpy as np

RUN = {"vertices": 400, "resolution": 32, "features": "auto"}
PARTS = {1: "left", 2: "right"}

Array = Any


def patch(at: Callable[[Array, Array], list[Array]], cells: int, first: int) -> tuple[Array, Array]:
    """A square of cells x cells quads as triangles."""
    side = np.arange(cells + 1) / cells
    u, v = (a.reshape(-1) for a in np.meshgrid(side, side, indexing="ij"))
    i, j = (a.reshape(-1) for a in np.meshgrid(range(cells), range(cells), indexing="ij"))
    a, b = first + i * (cells + 1) + j, first + (i + 1) * (cells + 1) + j
    return np.stack(at(u, v), axis=1), np.concatenate([np.stack([a, b, b + 1], 1), np.stack([a, b + 1, a + 1], 1)])


def sides() -> list[tuple[Callable[[Array, Array], list[Array]], tuple[int, int]]]:
    """Two cubes of edge 1 beside each other with a wall between them: of each square its places, and its two regions."""
    made: list[tuple[Callable[[Array, Array], list[Array]], tuple[int, int]]] = []
    for x, region in ((0.0, 1), (1.0, 2)):
        made += [(lambda u, v, x=x: [x + v, u, 0 * u], (region, 0)), (lambda u, v, x=x: [x + u, v, 0 * u + 1], (region, 0)),
                 (lambda u, v, x=x: [x + u, 0 * u, v], (region, 0)), (lambda u, v, x=x: [x + v, 0 * u + 1, u], (region, 0))]
    return [*made, (lambda u, v: [0 * u, v, u], (1, 0)), (lambda u, v: [0 * u + 2, u, v], (2, 0)),
            (lambda u, v: [0 * u + 1, u, v], (1, 2))]


def full_mesh(with_regions: bool = True, with_colors: bool = True) -> isoshell.Mesh:
    """Its attributes are functions of the place, of the side, or of the region."""
    points, faces, labels, count = [], [], [], 0
    for at, pair in sides():
        if not with_regions and pair == (1, 2):
            continue
        vertices, triangles = patch(at, 8, count)
        points.append(vertices)
        faces.append(triangles)
        labels.append(np.repeat([pair], len(triangles), axis=0))
        count += len(vertices)
    vertices, triangles, pairs = np.concatenate(points), np.concatenate(faces), np.concatenate(labels).astype(np.int32)
    corners = vertices[triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.repeat((across / np.linalg.norm(across, axis=1)[:, None])[:, None], 3, axis=1)
    of_vertices = {"heat": vertices[:, 0] + 2 * vertices[:, 2]}
    if with_colors:
        of_vertices["color"] = np.rint(vertices * 100).astype(np.uint8)
    return isoshell.Mesh(vertices, triangles, of_vertices=of_vertices,
                         of_faces={"part": (corners[:, :, 0].mean(1) > 1).astype(np.int32)},
                         of_corners={"uv": (corners[:, :, :2] * [0.5, 1]).astype(np.float32),
                                     "normal": normals.astype(np.float32)},
                         regions={"labels": pairs, "background": 0, "names": PARTS} if with_regions else None)


def check_values(result: isoshell.Result, lost: set[str], regions: bool, tolerance: float = 0.02) -> None:
    """Everything that is not among the lost is there, and is what it was made of."""
    vertices, faces = result.vertices, result.faces
    corners = vertices[faces]
    expected = {"heat": vertices[:, 0] + 2 * vertices[:, 2], "color": vertices * 100, "uv": corners[:, :, :2] * [0.5, 1]}
    attributes = {name.lower().lstrip("_"): values for name, values in result.attributes.items()}  # glTF has _HEAT
    for name in {"heat", "color", "uv", "normal", "part"} - lost:
        assert name in attributes, name
        values = attributes[name].astype(float)
        if name == "color":  # of any type, and with an alpha in some formats
            values = values[:, :3] * (255 if attributes[name].dtype.kind == "f" else 1)
        if name in expected:
            scale = 100 if name == "color" else 1
            assert np.abs(values - expected[name]).max() < tolerance * scale + (name == "color"), name
    if "part" not in lost:
        clear = np.abs(corners[:, :, 0].mean(1) - 1) > 0.05
        assert np.array_equal(result.attributes["part"][clear] > 0.5, corners[clear][:, :, 0].mean(1) > 1)
    if "normal" not in lost:
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        across /= np.linalg.norm(across, axis=1)[:, None]
        assert np.einsum("mij,mj->mi", result.attributes["normal"], across).min() > 0.9
    if regions and "regions" not in lost:
        assert set(map(tuple, np.unique(result.regions["labels"], axis=0).tolist())) == {(1, 0), (2, 0), (1, 2)}
        if "names" not in lost:
            assert result.region_names == PARTS


def told(run: Callable[[], isoshell.Result]) -> tuple[isoshell.Result, str]:
    """What it makes, and what it warns of."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", isoshell.RunWarning)
        made = run()
    return made, "\n".join(str(warning.message) for warning in caught)


def by_file(ending: str) -> Callable[[isoshell.Result, Path], Any]:
    """Carries a result as a file."""
    def carry(result: isoshell.Result, folder: Path) -> Any:
        path = folder / f"carried.{ending}"
        result.save(path)
        return path
    return carry
