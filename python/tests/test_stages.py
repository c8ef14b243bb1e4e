"""The stages one by one."""

import isoshell
import numpy as np
import pytest
from isoshell import ErrorCode

SMALL = {"vertices": 100, "resolution": 32}


def test_stages_make_the_mesh_and_the_digests_of_the_run(nefertiti):
    options = {"vertices": 300, "resolution": 64}
    whole = isoshell.remesh(nefertiti, stats=True, **options)
    stages = isoshell.Stages(nefertiti, **options)
    assert stages.digests == {}
    assert set(stages.prepare().digests) >= {"surface", "sites", "sheet", "shell"}
    result = stages.relax().triangulate()
    assert result.digest == whole.digest
    for name, digest in stages.digests.items():
        assert whole.report["digests"].get(name, digest) == digest
    assert result.report["topology"]["closed"] and result.report["quality"] == whole.report["quality"]


def test_every_stage_runs_those_before_it(ball):
    stages = isoshell.Stages(ball, **SMALL)
    assert stages.triangulate().digest == isoshell.remesh(ball, **SMALL).digest
    assert stages.triangulate().digest == stages.triangulate().digest
    assert stages.seeds.shape == (100, 3) and np.allclose(np.linalg.norm(stages.seeds, axis=1), 1, atol=0.1)


def test_products_are_arrays_in_the_world(ball):
    stages = isoshell.Stages((ball[0] + 5, ball[1]), **SMALL)
    vertices, faces = stages.sheet
    assert vertices.dtype == np.float64 and faces.dtype == np.int32 and faces.max() == len(vertices) - 1
    assert np.allclose(np.linalg.norm(vertices - 5, axis=1), 1, atol=0.1)
    assert stages.frame["resolution"] == 32 and stages.frame["voxel_size"] > 0


def test_stage_files_are_those_of_the_run(tmp_path, ball):
    options = {**SMALL, "features": "off"}
    isoshell.remesh(ball, save_shell=tmp_path / "a.vdb", save_voronoi=tmp_path / "b.vdb", **options)
    stages = isoshell.Stages(ball, **options)
    stages.save_shell(tmp_path / "ours_a.vdb")
    stages.save_voronoi(tmp_path / "ours_b.vdb")
    for name in ("a.vdb", "b.vdb"):
        assert isoshell.remesh(tmp_path / f"ours_{name}").digest == isoshell.remesh(tmp_path / name).digest
    with pytest.raises(isoshell.Error, match="exists already"):
        stages.save_shell(tmp_path / "a.vdb")
    assert stages.triangulate().digest == isoshell.remesh(ball, **options).digest


def test_stages_that_were_stopped_begin_anew(nefertiti):
    def stop(stage, fraction):
        raise ValueError("enough")

    stages = isoshell.Stages(nefertiti, progress=stop)
    with pytest.raises(ValueError, match="enough"):
        stages.prepare()
    with pytest.raises(isoshell.Error, match="begin anew"):
        stages.relax()


def test_stages_refuse_what_concerns_whole_runs(tmp_path, ball, box):
    with pytest.raises(isoshell.Error, match="require: only remesh"):
        isoshell.Stages(ball, require="closed")
    with pytest.raises(isoshell.Error, match="features off"):
        isoshell.Stages(box, **SMALL).save_voronoi(tmp_path / "box.vdb")
    isoshell.Stages(ball, **SMALL).save_shell(tmp_path / "ball.vdb")
    with pytest.raises(isoshell.Error, match="resumes from it") as caught:
        isoshell.Stages(tmp_path / "ball.vdb").prepare()
    assert caught.value.code == ErrorCode.USAGE
