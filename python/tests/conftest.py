"""Shapes that several tests start from, and the command to compare with."""

from __future__ import annotations

import _thread
import os
import subprocess
import sys
import threading
from pathlib import Path
from typing import Callable

import numpy as np
import pytest
from left_out import pytest_sessionfinish, pytest_terminal_summary  # noqa: F401, hooks

SOURCE = Path(__file__).resolve().parents[2]
COMMAND = os.environ.get("VDB_ISOMESH", "").split() or [sys.executable, "-m", "isoshell"]

FOREVER = 1200  # seconds, as a limit that only a test that hangs reaches

Mesh = tuple[np.ndarray, np.ndarray]


def assert_is_interrupted(run: Callable[[Callable[[], None]], object]) -> None:
    """A run that would go on for long ends as KeyboardInterrupt, by a key that is pressed once it calls what it is
    given."""
    begun = threading.Event()

    def press() -> None:
        begun.wait(FOREVER)
        _thread.interrupt_main()

    thread = threading.Thread(target=press)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        run(begun.set)
    thread.join()


def make_ball(rings: int = 12) -> Mesh:
    """A closed ball of radius 1 around (0, 0, 0)."""
    around = 2 * rings
    vertices = [(0.0, 0.0, 1.0)]
    for i in range(1, rings):
        for j in range(around):
            a, b = np.pi * i / rings, np.pi * j / rings
            vertices.append((np.sin(a) * np.cos(b), np.sin(a) * np.sin(b), np.cos(a)))
    vertices.append((0.0, 0.0, -1.0))
    last, faces = len(vertices) - 1, []
    for j in range(around):
        k = (j + 1) % around
        faces += [(0, 1 + j, 1 + k), (last, last - around + k, last - around + j)]
        for i in range(rings - 2):
            a, b = 1 + i * around + j, 1 + i * around + k
            faces += [(a, a + around, b), (b, a + around, b + around)]
    return np.array(vertices), np.array(faces, np.int64)


def make_box() -> Mesh:
    """A cube of edge 1 of six quads."""
    vertices = np.array([(x, y, z) for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)])
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return vertices, np.array(quads, np.int64)


def write_obj(path: Path, vertices: np.ndarray, faces: np.ndarray) -> Path:
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += ["f " + " ".join(str(corner + 1) for corner in face) for face in faces.tolist()]
    path.write_text("\n".join(lines) + "\n")
    return path


def python_of_openvdb() -> str | None:
    """A Python that has OpenVDB's module: the distribution's, or this one."""
    for python in ("/usr/bin/python3", sys.executable):
        probe = "try: import pyopenvdb\nexcept ImportError: import openvdb"
        if os.path.exists(python) and subprocess.run([python, "-c", probe], capture_output=True).returncode == 0:
            return python
    return None


@pytest.fixture(scope="session")
def ball() -> Mesh:
    return make_ball()


@pytest.fixture(scope="session")
def box() -> Mesh:
    return make_box()


@pytest.fixture(scope="session")
def nefertiti() -> Path:
    return SOURCE / "tests/data/nefertiti.ply"


@pytest.fixture
def command() -> Callable[..., subprocess.CompletedProcess[str]]:
    """Runs the command with these arguments."""

    def run(*arguments: object) -> subprocess.CompletedProcess[str]:
        return subprocess.run([*COMMAND, *map(str, arguments)], capture_output=True, text=True, timeout=FOREVER)

    return run


@pytest.fixture(scope="module")
def assets(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of a few balls."""
    folder = tmp_path_factory.mktemp("assets")
    vertices, faces = make_ball()
    for i in range(4):
        write_obj(folder / f"ball{i}.obj", vertices * np.array([1, 1 + 0.1 * i, 1]), faces)
    return folder


@pytest.fixture(scope="module")
def serial(assets: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[str, bytes]]:
    """What a loop over them makes, with 150 vertices each: digest and file, by name."""
    import isoshell

    folder, made = tmp_path_factory.mktemp("serial"), {}
    for path in sorted(assets.glob("*.obj")):
        name = f"{path.stem}.ply"
        result = isoshell.remesh(path, vertices=150, resolution=40, threads=1, output=folder / name)
        made[name] = (result.digest, (folder / name).read_bytes())
    return made
