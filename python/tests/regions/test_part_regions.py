"""Meshes whose parts touch: regions of components, groups and attributes of faces."""

from __future__ import annotations

import isoshell
import numpy as np
import pytest

QUICK = {"vertices": 800, "device": "cpu", "require": "regions"}
QUADS = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]


def box(low: tuple[float, ...], high: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray]:
    corners = [[(high if i >> axis & 1 else low)[axis] for axis in range(3)] for i in range(8)]
    faces = [face for a, b, c, d in QUADS for face in ((a, b, c), (a, c, d))]
    return np.array(corners, float), np.array(faces)


def boxes_in_a_row(count: int) -> tuple[np.ndarray, np.ndarray]:
    parts = [box((i, 0, 0), (i + 1, 1, 1)) for i in range(count)]
    return (np.concatenate([vertices for vertices, _ in parts]),
            np.concatenate([faces + 8 * i for i, (_, faces) in enumerate(parts)]))


def volume_of(mesh: isoshell.Mesh) -> float:
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] for corner in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6


def test_components_share_their_walls() -> None:
    result = isoshell.remesh(boxes_in_a_row(3), regions="components", **QUICK)
    assert len(result.vertices) == 800
    pairs = {tuple(sorted(pair)) for pair in result.regions["labels"].tolist()}
    assert pairs == {(0, 1), (0, 2), (0, 3), (1, 2), (2, 3)}
    for label in (1, 2, 3):
        assert volume_of(result.region(label)) == pytest.approx(1, abs=1e-6)


def test_an_attribute_of_faces_says_what_a_part_is() -> None:
    vertices, faces = boxes_in_a_row(4)
    mesh = isoshell.Mesh(vertices, faces, of_faces={"part": np.repeat([7, 7, 3, 3], 12)})
    result = isoshell.remesh(mesh, regions="part", **QUICK)
    assert result.region_names == {1: "7", 2: "3"}
    assert volume_of(result.region(2)) == pytest.approx(2, abs=1e-6)


def test_what_is_no_attribute_of_faces_is_refused() -> None:
    with pytest.raises(isoshell.Error, match="no attribute of one number of that name"):
        isoshell.remesh(boxes_in_a_row(2), regions="parts", **QUICK)


def test_level_sets_of_a_file_are_regions_and_faces_on_a_reference_have_its_material(tmp_path) -> None:
    few = {"vertices": 800, "device": "cpu"}
    isoshell.remesh(box((0, 0, 0), (3, 2, 1)), resolution=40, save_level_set=tmp_path / "body.vdb", **few)
    pieces = f"{tmp_path / 'body.vdb'}:sur*"
    result = isoshell.remesh(pieces, reference=tmp_path / "body.vdb", **QUICK)
    assert result.region_names == {1: "surface"}
    assert not result.attributes["material"].any()  # all are exterior
    assert not isoshell.remesh(pieces, union=True, **few).region_names
    with pytest.raises(isoshell.Error, match="is for several level sets"):
        isoshell.remesh(tmp_path / "body.vdb", union=True, **few)
