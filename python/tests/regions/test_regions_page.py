"""docs/guide/regions.md: its code as it stands there, on fewer voxels and vertices."""

from __future__ import annotations

import re
import sys
from types import SimpleNamespace

import isoshell
import numpy as np
import pytest
from conftest import SOURCE

BLOCKS = re.findall(r"```python\n(.*?)```", (SOURCE / "docs/guide/regions.md").read_text(), re.S)


@pytest.fixture(scope="module")
def two_bones() -> np.ndarray:
    array = np.zeros((20, 20, 10), np.int16)
    array[4:10, 4:16, 2:8], array[10:16, 4:16, 2:8] = 1, 2
    return array


def run(block: str, **names: object) -> isoshell.Result:
    smaller = re.sub(r"vertices=[\d_]+", "vertices=1500", block).replace("n = 64", "n = 20").replace("(40, 3)", "(6, 3)")
    names["isoshell"] = isoshell
    exec(smaller, names)
    result = names["result"]
    assert isinstance(result, isoshell.Result)
    return result


def block_with(words: str) -> str:
    return next(block for block in BLOCKS if words in block)


def test_an_array_of_labels_has_names(two_bones):
    result = run(block_with("femur"), array=two_bones)
    assert result.region_names == {1: "femur", 2: "tibia"} and result.report["regions"]["every_region_closed"]


def test_a_volume_of_nibabel_stands_where_its_affine_says(two_bones, tmp_path, monkeypatch):
    affine = np.array([[-1, 0, 0, 9], [0, 1, 0, 3], [0, 0.2, 2, 1], [0, 0, 0, 1.0]])
    image = SimpleNamespace(dataobj=two_bones, affine=affine)
    monkeypatch.setitem(sys.modules, "nibabel", SimpleNamespace(load=lambda path: image))
    monkeypatch.chdir(tmp_path)
    result = run(block_with("nibabel"))
    ends = affine @ (np.array([(4, 4, 2), (15, 15, 7)]).T.tolist() + [[1, 1]])
    assert np.allclose(result.vertices.mean(axis=0), ends[:3].mean(axis=1), atol=0.5)
    assert (tmp_path / "anatomy.ply").is_file()


def test_every_region_is_filled_and_the_walls_stay_as_they_are(tmp_path, monkeypatch, capsys):
    pytest.importorskip("tetgen")
    monkeypatch.chdir(tmp_path)
    grains = np.zeros((20, 20, 20), np.int32)
    grains[2:10, 2:18, 2:18], grains[10:18, 2:18, 2:18] = 1, 2
    result = isoshell.remesh(isoshell.Labels(grains, names={2: "steel"}), vertices=1500, device="cpu")
    run(block_with("result.fill"), result=result)
    assert "steel" in capsys.readouterr().out and (tmp_path / "grains.msh").is_file()



def test_the_grains_of_a_polycrystal_fill_their_cube():
    regions = run(block_with("grains = numpy.zeros"))
    volume = sum(region["volume"] for region in regions.report["regions"]["regions"])
    assert volume == pytest.approx(1, rel=0.1)
