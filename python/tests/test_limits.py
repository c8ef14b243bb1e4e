"""docs/guide/limits.md, claim by claim: each test names the words of the page that it checks, by runs on small shapes.

The words must be there as they stand here, and no item of the page may be without a test unless it is named at the end:
who changes the page changes this file. `pytest -v python/tests/test_limits.py` prints the claims.
"""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path
from typing import Any, Callable, NamedTuple

import isoshell
import numpy as np
import pytest
from conftest import COMMAND, FOREVER, SOURCE, Mesh, make_ball, make_box, write_obj

PAGE = (SOURCE / "docs/guide/limits.md").read_text()
claimed: list[str] = []


def claims(*words: str) -> Callable[[Any], Any]:
    """These are words of the page, and the test checks them."""
    claimed.extend(words)
    return pytest.mark.parametrize("claim", [words], ids=[words[0][:60].strip("*. ")])


def items() -> list[str]:
    """Items of lists and rows of tables, each on one line."""
    blocks = re.split(r"\n(?=- |\| |\n)", PAGE)
    rows = [" ".join(block.split()) for block in blocks if block.startswith(("- ", "| "))]
    return [row for row in rows if not row.startswith(("| | ", "| ---"))]


class Run(NamedTuple):
    status: int
    said: str
    stats: dict[str, Any]
    output: Path

    def mesh(self) -> Mesh:
        lines = self.output.read_text().split("\n")
        vertices, faces = map(int, lines[1].split()[:2])
        rows = [line.split() for line in lines[2:2 + vertices + faces]]
        return np.array(rows[:vertices], float), np.array(rows[vertices:], int)[:, 1:4]


@pytest.fixture
def run(tmp_path: Path) -> Callable[..., Run]:
    """Runs the command; the output is out.off unless said otherwise."""

    def call(source: object, *options: object, output: str = "out.off", device: str = "cpu") -> Run:
        stats, path = tmp_path / "stats.json", tmp_path / output
        words = [*COMMAND, source, path, "--stats", stats, "--device", device, "--force", *options]
        done = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=FOREVER)
        measured = json.loads(stats.read_text()) if done.returncode in (0, 6) else {}
        return Run(done.returncode, done.stderr, measured, path)

    return call


def joined(*meshes: Mesh) -> Mesh:
    starts = np.cumsum([0] + [len(vertices) for vertices, _ in meshes])
    return (np.concatenate([vertices for vertices, _ in meshes]),
            np.concatenate([faces + start for (_, faces), start in zip(meshes, starts)]))


def box(low: tuple[float, ...], high: tuple[float, ...]) -> Mesh:
    vertices, faces = make_box()
    return np.array(low) + vertices * (np.array(high) - np.array(low)), faces


def without_floor(vertices: np.ndarray, faces: np.ndarray) -> Mesh:
    return vertices, faces[vertices[faces][:, :, 2].max(axis=1) > vertices[:, 2].min()]


def sheet(x: tuple[float, ...], y: tuple[float, ...], corner: tuple[float, ...] = (0, 0, 0), n: int = 20) -> Mesh:
    """A parallelogram of n by n squares."""
    i, j = np.divmod(np.arange((n + 1) ** 2), n + 1)
    vertices = np.array(corner) + np.outer(i / n, x) + np.outer(j / n, y)
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    quads = np.stack([first, first + n + 1, first + n + 2, first + 1], axis=1)
    return vertices, np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]])


def enclosed(vertices: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = vertices[faces].transpose(1, 0, 2)
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


@claims("as many vertices as you ask for", "what is smaller than an edge is rounded off", "`--require max-deviation=W`")
def test_detail(run, tmp_path, claim):
    vertices, faces = make_ball(60)
    x, y, z = vertices.T
    ripples = vertices * (1 + 0.02 * np.cos(25 * x) * np.cos(25 * y) * np.cos(25 * z))[:, None]  # .13 from top to foot
    source = write_obj(tmp_path / "ripples.obj", ripples, faces)
    done = run(source, "--vertices", 300, "--require", "max-deviation=0.1")
    radii = np.linalg.norm(done.mesh()[0], axis=1)
    assert done.status == 0 and len(radii) == 300
    assert np.ptp(radii) < 0.75 * np.ptp(np.linalg.norm(ripples, axis=1))
    assert run(source, "--vertices", 300, "--require", "max-deviation=0.01").status == 6


@claims("Slits below two voxels", "parts so near become", "a warning says so, and `topology.agrees_with_input`",
        "closed surfaces are meshed on their own triangles, and stay apart")
def test_slits(run, tmp_path, claim):
    voxel = 1 / 64
    near = (box((0, 0, 0), (1, 1, 1)), box((1 + voxel, 0, 0), (2, 1, 1)))
    source = write_obj(tmp_path / "slit.obj", *joined(*near))
    open_source = write_obj(tmp_path / "open.obj", *joined(*(without_floor(*part) for part in near)))
    wide = write_obj(tmp_path / "wide.obj", *joined(box((0, 0, 0), (1, 1, 1)), box((1 + 3 * voxel, 0, 0), (2, 1, 1))))
    usual = ("--vertices", 500, "--voxel-size", voxel)
    done = run(source, *usual, "--method", "shell")
    assert done.stats["topology"]["components"] == 1 and not done.stats["topology"]["agrees_with_input"]
    assert "warning: the solid has 1 component " in done.said
    assert run(wide, *usual, "--method", "shell").stats["topology"]["components"] == 2
    assert run(open_source, *usual, "--features", "off").stats["topology"]["components"] == 1
    for options in ((), ("--features", "off"), ("--edge-length", 0.1)):
        apart = run(source, "--voxel-size", voxel, *(options or ("--vertices", 500)))
        assert apart.stats["topology"]["agrees_with_input"] and apart.status == 0
        assert apart.stats["topology"]["components"] == 2 and "solid has" not in apart.said


@claims("cost memory with the square of their number")
def test_memory(run, tmp_path, claim):
    source = write_obj(tmp_path / "ball.obj", *make_ball())
    known = []
    for resolution in (1024, 2048, 4096):
        words = [*COMMAND, source, tmp_path / "out.ply", "--resolution", resolution, "--dry-run"]
        said = subprocess.run([str(word) for word in words], capture_output=True, text=True).stderr
        number, unit = re.search(r"about ([\d.]+) ([MG])iB", said).groups()
        known.append(float(number) * (1024 if unit == "G" else 1))
    assert 3.4 < known[1] / known[0] < 4.4 and 3.4 < known[2] / known[1] < 4.4


@claims("A closed wall keeps its thickness, also of a tenth of a voxel", "kept exactly, elsewhere on average",
        "rounded by an edge length", "Triangles across the rim get narrow")
def test_thin_walls(run, tmp_path, claim):
    thick = 1 / 640
    source = write_obj(tmp_path / "wall.obj", *box((0, 0, 0), (1, 1, thick)))
    crisp = run(source, "--vertices", 1000, "--voxel-size", 1 / 64)
    vertices, faces = crisp.mesh()
    snapped = 1 / 64 / 256  # the grid that points are on
    assert np.abs(vertices[:, 2] - np.round(vertices[:, 2] / thick) * thick).max() <= 2 * snapped
    assert crisp.stats["quality"]["theta_min_deg"] < 10
    soft = run(source, "--vertices", 1000, "--voxel-size", 1 / 64, "--features", "off")
    vertices, faces = soft.mesh()
    a, b, c = vertices[faces].transpose(1, 0, 2)
    assert enclosed(vertices, faces) / (np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 4) == pytest.approx(
        thick, rel=0.05)
    assert soft.stats["distance"]["from_input_max"] <= np.linalg.norm(b - a, axis=1).mean()


@claims("Only crisp parts have creases that `auto` finds")
def test_creases_of_scans(run, tmp_path, nefertiti, claim):
    assert run(nefertiti, "--vertices", 500).stats["features"]["curves"] == 0
    assert run(write_obj(tmp_path / "box.obj", *make_box()), "--vertices", 300).stats["features"]["curves"] == 12


@claims("Where creases meet at a small angle", "triangles have small angles. A warning names the worst",
        "`--require min-angle=DEG` refuses such a result", "`--features off` rounds creases off and has wide angles")
def test_angles_beside_creases(run, tmp_path, claim):
    vertices = np.array([(x, y, z) for z in (0.0, 1.0) for x, y in ((0, 0), (2, 0), (2, 0.35))])  # a wedge of 10 degrees
    faces = np.array([(0, 2, 1), (3, 4, 5), (0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (2, 0, 3), (2, 3, 5)])
    source = write_obj(tmp_path / "wedge.obj", vertices, faces)
    options = ("--vertices", 500, "--require", "min-angle=30")
    kept = run(source, *options)
    assert kept.status == 6 and kept.stats["quality"]["theta_min_deg"] < 15
    assert "triangles have angles below 30 degrees" in kept.said
    assert run(source, *options, "--features", "off").status == 0


@claims("the least creases, by turn times length, are left out, and the longest are named",
        "`--require features`")
def test_lost_curves(run, tmp_path, claim):
    def cubes(n: int) -> Mesh:  # small ones on a large one
        at = [((i + 0.5) / n, (j + 0.5) / n, 0.9) for i in range(n) for j in range(n)]
        return joined(box((0, 0, 0), (1, 1, 1)), *(box((x, y, z), (x + 0.02, y + 0.02, 1.02)) for x, y, z in at))

    few = run(write_obj(tmp_path / "few.obj", *cubes(1)), "--vertices", 100, "--require", "features")
    assert few.status == 0 and few.stats["features"]["curves"] == 24
    many = run(write_obj(tmp_path / "many.obj", *cubes(6)), "--vertices", 100, "--require", "features")
    features = many.stats["features"]
    assert many.status == 6 and many.stats["features"]["curves"] == 12
    assert features["lost_curves"] > 6 * 6 * 8 and len(features["lost"]) == 100
    assert [of["curves"] for of in features["lost_by_reason"]] == [features["lost_curves"]]
    assert all("edges are too long" in curve["reason"] for curve in features["lost"])


@claims("**Edges of three faces**", "The result follows the surface around them, and a warning says where")
def test_edges_of_three_faces(run, tmp_path, claim):
    tee = joined(sheet((1, 0, 0), (0, 1, 0)), sheet((1, 0, 0), (0, 0, 0.5), (0, 0.5, 0)))
    done = run(write_obj(tmp_path / "tee.obj", *tee), "--vertices", 500)
    assert done.stats["topology"]["manifold"] and done.stats["topology"]["closed"]
    assert re.search(r"edges of more than two faces, .*the first at ", done.said)


@claims("**Attributes** that a format cannot hold: the statistics list what was dropped",
        "warning of the run that resumes names those of its input")
def test_attributes(run, tmp_path, claim):
    vertices, faces = make_ball()
    source = isoshell.Mesh(vertices, faces, of_vertices={"color": np.full((len(vertices), 3), 200, np.uint8)})
    isoshell.remesh(source, vertices=200, output=tmp_path / "in.ply")
    assert run(tmp_path / "in.ply", "--vertices", 100, output="out.ply").stats["attributes"]["kept"] == ["color"]
    for output, options in {"out.stl": (), "out.vdb": ("--stop-after", "voronoi")}.items():
        dropped = run(tmp_path / "in.ply", "--vertices", 100, *options, output=output).stats["attributes"]["dropped"]
        assert [one["name"] for one in dropped] == ["color"]
    assert "the result is without color" in run(tmp_path / "out.vdb").said


@claims("Holes are closed by their own shape", "Look at `gap` in the result", "keep borders with `--boundary keep`")
def test_holes(run, tmp_path, claim):
    vertices, faces = make_ball(24)
    source = write_obj(tmp_path / "hole.obj", vertices, faces[(vertices[faces][:, :, 2] < 0.95).any(axis=1)])
    done = run(source, "--vertices", 300, output="out.ply")
    assert done.stats["topology"]["closed"] and done.stats["gaps"]["vertices"] > 0
    assert b"property uchar gap" in done.output.read_bytes()
    open_too = run(source, "--vertices", 300, "--boundary", "keep", "--close-gaps", 0)
    assert open_too.stats["topology"]["boundary_loops"] == 1


@claims("**The back of a cloud**", "closed smoothly", "reports how much that is")
def test_back_of_a_cloud(run, tmp_path, claim):
    points = make_ball(50)[0]
    np.savetxt(tmp_path / "half.xyz", points[points[:, 2] > 0])
    done = run(tmp_path / "half.xyz", "--vertices", 300)
    assert done.stats["topology"]["closed"]
    assert re.search(r"\d+ % of the surface has no points near it and was closed smoothly", done.said)


@claims("**Points are points of a surface.**", "as particles of a fluid do", "have no flat neighbourhood", "splashsurf")
def test_particles_of_a_fluid(run, tmp_path, claim):
    inside = np.random.default_rng(1).uniform(-1, 1, (4000, 3))
    np.savetxt(tmp_path / "particles.xyz", inside[(inside**2).sum(axis=1) < 1])
    np.savetxt(tmp_path / "scan.xyz", make_ball(50)[0])
    said = run(tmp_path / "particles.xyz", "--vertices", 300, "--allow-intersections").said
    share = re.search(r"fill a volume, as particles of a fluid do: (\d+) % of them have no flat neighbourhood", said)
    assert share and 78 < int(share[1]) < 88
    assert "splashsurf" in said
    assert "fill a volume" not in run(tmp_path / "scan.xyz", "--vertices", 300).said


@claims("**Surfaces without thickness**", "unless borders are kept", "seven voxels, a 25th of its side",
        "three of the voxels of `--voxel-size` a 64th of it")
def test_surfaces_without_thickness(run, tmp_path, claim):
    source = write_obj(tmp_path / "sheet.obj", *sheet((1, 0, 0), (0, 1, 0)))
    for options, voxels, thick in (((), 7, 1 / 25), (("--voxel-size", 1 / 64), 3, 3 / 64)):
        done = run(source, "--vertices", 1000, *options)
        apart = float(re.search(r"both of its sides, about ([\d.]+) apart", done.said).group(1))
        assert done.stats["topology"]["closed"] and apart == pytest.approx(thick, rel=0.02)
        assert apart / done.stats["grid"]["voxel_size"] == pytest.approx(voxels, rel=0.01)
    assert not run(source, "--vertices", 300, "--boundary", "keep").stats["topology"]["closed"]


@claims("With `--boundary keep` the result has the intersections of the input's own triangles",
        "a warning counts them", "exit status is 6 unless `--allow-intersections` is given")
def test_intersections_of_the_input(run, tmp_path, claim):
    crossed = joined(sheet((1, 0, 0), (0, 1, 0)), sheet((1, 0, 0), (0, 0, 1), (0, 0.51, -0.5)))
    source = write_obj(tmp_path / "crossed.obj", *crossed)
    usual = ("--vertices", 500, "--boundary", "keep")
    done = run(source, *usual)
    assert done.status == 6 and done.stats["topology"]["self_intersections"] > 0
    assert "pairs of triangles intersect, near " in done.said
    assert ", where the input's own triangles do" in done.said
    assert run(source, *usual, "--allow-intersections").status == 0


@claims("Genus and number of components follow the closed voxels", "`--require genus=G,components=N`")
def test_gates_on_topology(run, tmp_path, claim):
    near = joined(box((0, 0, 0), (1, 1, 1)), box((1 + 1 / 64, 0, 0), (2, 1, 1)))
    source = write_obj(tmp_path / "slit.obj", *near)
    usual = ("--vertices", 300, "--voxel-size", 1 / 64, "--method", "shell", "--require")
    assert run(source, *usual, "genus=0,components=2").status == 6
    assert run(source, *usual, "genus=1,components=1").status == 6
    assert run(source, *usual, "genus=0,components=1").status == 0


@claims("The largest deviation is measured at samples: it is a lower bound")
def test_largest_deviation(run, tmp_path, nefertiti, claim):
    done = run(nefertiti, "--vertices", 300)
    searched = isoshell.mesh_info(done.output, ref=nefertiti)["distance"]
    for way in ("to", "from"):  # the input was snapped to a 256th of a voxel
        most = searched[f"{way}_reference"]["max_at_most"] + done.stats["grid"]["voxel_size"] / 256
        assert done.stats["distance"][f"{way}_input_max"] <= most


@claims("The memory of a run that resumes is not estimated in advance", "does not hold it on the CPU")
def test_memory_of_a_run_that_resumes(run, tmp_path, claim):
    source = write_obj(tmp_path / "ball.obj", *make_ball())
    run(source, "--vertices", 200, "--stop-after", "shell", output="shell.vdb")
    stage = tmp_path / "shell.vdb"
    assert run(stage, "--vertices", 200, "--max-memory", "100K").status == 7
    done = run(stage, "--vertices", 200, "--max-memory", str(stage.stat().st_size + 1))
    assert done.status == 0 and done.stats["memory_bytes"]["estimate"] is None


def refused(run: Callable[..., Run], folder: Path, status: int, source: Path, *options: object, **how: str) -> None:
    """The run ends with this status, and leaves no file that was not there."""
    before = sorted(folder.iterdir())
    assert run(source, *options, **how).status == status
    assert sorted(folder.iterdir()) == before


@claims("files that are cut off, lie about their counts, or need a glTF extension that is not read | 3 |")
def test_broken_files(run, tmp_path, nefertiti, claim):
    (tmp_path / "cut.ply").write_bytes(nefertiti.read_bytes()[:100_000])
    (tmp_path / "lies.off").write_text("OFF\n4 900 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n")
    hidden = {"asset": {"version": "2.0"}, "extensionsRequired": ["KHR_node_visibility"]}
    (tmp_path / "hidden.gltf").write_text(json.dumps(hidden))
    for name in ("cut.ply", "lies.off", "hidden.gltf"):
        refused(run, tmp_path, 3, tmp_path / name)
    assert "KHR_node_visibility" in run(tmp_path / "hidden.gltf").said


@claims("points with NaN or infinity, and arrays with infinity, from memory | 3 |")
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_numbers_that_are_none(value, claim):
    vertices, faces = make_ball()
    vertices[5, 1] = value
    lattice = np.where(np.arange(27) == 13, np.inf, -1).reshape(3, 3, 3)
    for source in ((vertices, faces), isoshell.Points(vertices), isoshell.Volume(lattice)):
        with pytest.raises(isoshell.Error) as caught:
            isoshell.remesh(source, vertices=100)
        assert caught.value.code == 3


@claims("options out of their range | 2 |", "input without a face or point that can be used | 5 |",
        "a run whose estimate is above `--max-memory` | 7 |",
        "an input whose reading takes more than `--max-memory`, as standard input that never ends | 7 |",
        "a device that is not there or too old | 8 |",
        "A failed run leaves no half-written file")
def test_what_is_refused(run, tmp_path, claim):
    source = write_obj(tmp_path / "ball.obj", *make_ball())
    (tmp_path / "empty.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 1 2\n")
    refused(run, tmp_path, 2, source, "--gradation", 11)
    refused(run, tmp_path, 2, source, "--resolution", 7)
    refused(run, tmp_path, 5, tmp_path / "empty.obj")
    refused(run, tmp_path, 7, source, "--max-memory", "1M")
    refused(run, tmp_path, 7, "/dev/zero", "--input-format", "ply", "--max-memory", "64M")
    refused(run, tmp_path, 8, source, device="cuda:99")


NOT_CHECKED = ("The interface of the library may change",)


def test_the_page_has_these_words_and_no_item_without_a_test():
    page = " ".join(PAGE.split())
    assert [words for words in claimed if words not in page] == []
    known = (*claimed, *NOT_CHECKED)
    assert [item for item in items() if not any(words in item for words in known)] == []
