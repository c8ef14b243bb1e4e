"""The recipes of the documentation, run as they stand there, on small inputs."""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import isoshell
import numpy as np
import pytest
from conftest import FOREVER, SOURCE, Mesh, python_of_openvdb, write_obj

RECIPES = SOURCE / "examples/recipes"


def run(recipe: str, *arguments: object, python: str = sys.executable) -> str:
    command = [python, str(RECIPES / recipe), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=FOREVER)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_soup_of_two_boxes_becomes_one_printable_solid(box: Mesh, tmp_path: Path) -> None:
    vertices, faces = box
    triangles = np.concatenate([faces[:, :3], faces[:, [0, 2, 3]]])
    soup = np.concatenate([vertices[triangles], vertices[triangles] + 0.5]).reshape(-1, 3)  # no vertex is shared
    write_obj(tmp_path / "soup.obj", soup, np.arange(len(soup)).reshape(-1, 3))
    assert "genus 0" in run("print_ready.py", tmp_path / "soup.obj", tmp_path / "out.stl", 600)
    assert isoshell.remesh(tmp_path / "out.stl", vertices=200).report["input"]["closed"]


def test_a_training_set_holds_what_can_be_meshed_and_says_what_cannot(ball: Mesh, tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    write_obj(tmp_path / "in/ball.obj", ball[0] * 3 + 7, ball[1])
    (tmp_path / "in/broken.obj").write_text("v 0 0\n")
    run("training_set.py", tmp_path / "in", tmp_path / "out", 200)
    index = json.loads((tmp_path / "out/index.json").read_text())
    assert index["ball.obj"]["genus"] == 0
    assert index["broken.obj"]["code"] == "UNREADABLE_INPUT"
    with np.load(tmp_path / "out/ball.obj.npz") as made:
        assert made["vertices"].shape == (200, 3)
        assert np.ptp(made["vertices"], axis=0).max() == pytest.approx(1)


def test_a_simulation_mesh_has_as_many_vertices_as_its_field_asks_for(ball: Mesh, tmp_path: Path) -> None:
    python = python_of_openvdb()
    if python is None:
        pytest.skip("no Python module of OpenVDB, such as python3-openvdb")
    fine, coarse = 0.06, 0.25
    write_obj(tmp_path / "ball.obj", *ball)
    run("size_field.py", tmp_path / "field.vdb", 0, 0, 1, 1.0, fine, coarse, python=python)
    run("simulation_mesh.py", tmp_path / "ball.obj", tmp_path / "field.vdb", tmp_path / "out.off",
        tmp_path / "stats.json")
    assert json.loads((tmp_path / "stats.json").read_text())["topology"]["closed"]
    rows = (tmp_path / "out.off").read_text().split("\n")
    heights = np.array([float(row.split()[2]) for row in rows[2:2 + int(rows[1].split()[0])]])
    # A vertex of edges L takes sqrt(3) / 2 L^2, and what is within r of the pole has the area pi r^2; L = fine + g r.
    g = coarse - fine
    near = 2 * np.pi / g**2 * (np.log(coarse / fine) + fine / coarse - 1) / (3**0.5 / 2)
    far = np.pi / coarse**2 / (3**0.5 / 2)
    assert (heights > 0.5).sum() == pytest.approx(near, rel=0.1)
    assert (heights < -0.5).sum() == pytest.approx(far, rel=0.1)


def test_volumes_for_houdini_are_a_mesh_two_stage_files_and_a_preview(ball: Mesh, tmp_path: Path) -> None:
    write_obj(tmp_path / "ball.obj", *ball)
    run("volumes_for_houdini.py", tmp_path / "ball.obj", tmp_path / "out", 200)
    made = {path.name for path in (tmp_path / "out").iterdir()}
    assert made == {"mesh.ply", "mesh.shell.vdb", "mesh.voronoi.vdb", "mesh.voronoi.preview.vdb"}
    assert isoshell.remesh(tmp_path / "out/mesh.voronoi.vdb").vertices.shape == (200, 3)


class StandIn:
    """As much of Houdini's node and geometry as the Python SOP calls; polygons turn clockwise."""

    def __init__(self, vertices: np.ndarray, faces: np.ndarray) -> None:
        self.points, self.polygons = vertices.tolist(), [list(map(int, face[::-1])) for face in faces]

    def geometry(self) -> StandIn:
        return self

    def evalParm(self, name: str) -> int:
        return {"vertices": 150}[name]

    def pointFloatAttribValuesAsString(self, name: str) -> bytes:
        return {"P": np.array(self.points, np.float32).tobytes()}[name]

    def prims(self) -> list[SimpleNamespace]:
        def corner(i: int) -> SimpleNamespace:
            return SimpleNamespace(point=lambda: SimpleNamespace(number=lambda: i))

        return [SimpleNamespace(vertices=lambda p=polygon: [corner(i) for i in p]) for polygon in self.polygons]

    def clear(self) -> None:
        self.points, self.polygons = [], []

    def createPoints(self, positions: list[list[float]]) -> list[int]:
        self.points += positions
        return list(range(len(positions)))

    def createPolygons(self, polygons: list[list[int]]) -> None:
        self.polygons += polygons


def test_a_sop_of_houdini_remeshes_its_geometry_and_turns_it_back(ball: Mesh, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(RECIPES)
    cook = importlib.import_module("houdini_sop").cook
    node = StandIn(*ball)
    cook(node)
    assert len(node.points) == 150
    made = isoshell.mesh_info((np.array(node.points), np.array(node.polygons)[:, ::-1]))
    assert made["topology"]["closed_manifold"] and made["topology"]["volume"] == pytest.approx(4 / 3 * np.pi, rel=0.05)


def test_a_sequence_for_nuke_is_one_stage_with_velocities(ball: Mesh, tmp_path: Path) -> None:
    usd = pytest.importorskip("pxr.Usd")
    geom = pytest.importorskip("pxr.UsdGeom")
    for frame in (1, 2, 3):
        write_obj(tmp_path / f"ball.{frame:04}.obj", ball[0] + [0.25 * frame, 0, 0], ball[1])
    said = run("sequence_for_nuke.py", tmp_path / "ball.####.obj", "1-3", tmp_path / "out.usdc", 150)
    assert "has points at [1.0, 2.0, 3.0]" in said
    stage = usd.Stage.Open(str(tmp_path / "out.usdc"))
    mesh = next(geom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(geom.Mesh))
    velocities = np.array(mesh.GetVelocitiesAttr().Get(2))
    assert velocities.shape == (150, 3)
    moved = 0.25 * stage.GetTimeCodesPerSecond()  # vertices also slide a little
    assert np.median(velocities, axis=0) == pytest.approx([moved, 0, 0], abs=0.05 * moved)
