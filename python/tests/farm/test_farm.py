"""isoshell farm: many assets, of which some are bad, on a real scheduler."""

import csv
import json
import os
import re
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from conftest import FOREVER, make_ball, write_obj
from farms import (ENDLESS, SMALL, Crasher, assert_is_refused, assert_is_serial, connect, digests_of, farm, files_of,
                   link_assets, make_assets, rows_of)

import isoshell
from isoshell import _isoshell
from isoshell._farm._assets import assets_of
from isoshell._farm._process import Child, Lost


def test_a_farm_writes_what_a_loop_writes_and_does_nothing_twice(assets, serial, tmp_path):
    out = tmp_path / "out"
    done = farm("run", assets, out, *SMALL)
    assert done.returncode == 0, done.stderr
    assert_is_serial(out, serial)
    assert files_of(out) == {name.replace(".ply", end) for name in serial for end in (".ply", ".json")}
    statistics = json.loads((out / "ball0.json").read_text())
    assert statistics["input"]["path"] == str(assets / "ball0.obj") and statistics["output"]["path"] == "ball0.ply"
    before = {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.name != "lock"}
    assert "4 of 4 assets are done already" in farm("run", assets, out, *SMALL).stderr
    assert before == {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.name != "lock"}


def test_only_what_has_changed_is_meshed_again(tmp_path):
    assets, out = make_assets(tmp_path / "assets", 3), tmp_path / "out"
    assert farm("run", assets, out, *SMALL).returncode == 0
    first = rows_of(out)
    os.utime(assets / "ball0.obj", (1, 1))
    vertices, faces = make_ball()
    write_obj(assets / "ball1.obj", vertices * 3, faces)
    (out / "ball2.ply").unlink()
    made = (out / "ball0.ply").stat().st_mtime_ns
    assert farm("run", assets, out, *SMALL).returncode == 0
    second = rows_of(out)
    assert (out / "ball0.ply").stat().st_mtime_ns == made and second["ball0.ply"]["unchanged"]
    assert second["ball0.ply"]["digest"] == first["ball0.ply"]["digest"]
    assert second["ball1.ply"]["output_sha256"] != first["ball1.ply"]["output_sha256"]
    assert second["ball2.ply"]["output_sha256"] == first["ball2.ply"]["output_sha256"] and (out / "ball2.ply").exists()
    assert "0 of 3" not in farm("run", assets, out, *SMALL).stderr
    assert farm("run", assets, out, *SMALL, "--seed", 1).returncode == 0
    assert all(row["options"]["seed"] == "1" for row in rows_of(out).values())


def test_a_bad_asset_is_a_row_with_its_reason_and_harms_no_other(assets, serial, tmp_path):
    mixed = link_assets(assets, tmp_path / "mixed")
    (mixed / "malformed.ply").write_bytes(b"ply\nformat ascii 1.0\nelement vertex 9\n")
    with Crasher(mixed / "crash.obj") as crasher:
        done = farm("run", mixed, tmp_path / "out", *SMALL, *ENDLESS)
    assert done.returncode == 9, done.stderr
    assert_is_serial(tmp_path / "out", serial)
    os.mkfifo(mixed / "endless.obj")  # alone: how long others take is up to the machine
    assert farm("run", mixed, tmp_path / "out", *SMALL, "--time-limit", 1.5).returncode == 9
    rows = {name: row for name, row in rows_of(tmp_path / "out").items() if row["state"] == "failed"}
    assert {name: (row["code"], row["attempts"]) for name, row in rows.items()} == {
        "malformed.ply": ("UNREADABLE_INPUT", 1), "endless.ply": ("TIME_LIMIT", 2), "crash.ply": ("CRASHED", 2)}
    assert "SIGSEGV" in rows["crash.ply"]["message"] and len(crasher.ended) == 2
    assert "1.5 s" in rows["endless.ply"]["message"]
    again = farm("run", mixed, tmp_path / "out", *SMALL, "--time-limit", 1.5)
    assert again.returncode == 9 and "3 failed before" in again.stderr
    said = farm("status", tmp_path / "out").stdout
    assert "7 assets: 4 done, 3 failed, 0 remaining" in said and "TIME_LIMIT: 1" in said
    assert farm("report", tmp_path / "out").returncode == 0
    page = (tmp_path / "out/report.html").read_text()
    assert "CRASHED: 1" in page and 'href="./ball0.ply"' in page and "http" not in page.split("</style>")[1]


def test_assets_that_share_a_process_are_tried_again_and_the_one_that_ends_it_alone(assets, serial, tmp_path):
    mixed = link_assets(assets, tmp_path / "mixed")
    with Crasher(mixed / "crash.obj"):
        done = farm("run", mixed, tmp_path / "out", *SMALL, "--contexts", 2, *ENDLESS, "--device", "cpu")
    assert done.returncode == 9, done.stderr
    assert_is_serial(tmp_path / "out", serial)
    failed = {name: row["code"] for name, row in rows_of(tmp_path / "out").items() if row["state"] == "failed"}
    assert failed == {"crash.ply": "CRASHED"}


def test_an_asset_beyond_its_time_ends_the_process_and_others_in_it_are_not_to_blame(tmp_path):
    """Both would go on for ever."""
    child, lost = Child(2, {}), {}

    def do(name, time_limit):
        os.mkfifo(tmp_path / f"{name}.obj")
        job = {"path": str(tmp_path / f"{name}.obj"), "options": {}, "scratch": str(tmp_path), "known_sha256": None}
        try:
            child.do(job, 1 << 40, time_limit)
        except Lost as error:
            lost[name] = error

    threads = [threading.Thread(target=do, args=each) for each in (("held", None), ("endless", 0.5))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(FOREVER)
    child.stop()
    assert {name: (error.reason, error.is_own_fault) for name, error in lost.items()} == {
        "endless": ("TIME_LIMIT", True), "held": ("STOPPED", False)}
    assert "0.5 s" in str(lost["endless"])


def test_an_asset_that_is_too_large_is_refused_with_its_figure_and_one_that_fits_alone_is_meshed(assets, tmp_path):
    table, ball = assets / "assets.jsonl", "ball0.obj"
    table.write_text("\n".join(json.dumps(row) for row in (
        {"path": ball, "resolution": 40}, {"path": ball, "resolution": 400}, {"path": ball, "resolution": 8000})))
    done = farm("run", table, tmp_path / "out", "--vertices", 150, "--workers", 2, "--memory", "900M")
    assert done.returncode == 9, done.stderr
    rows = rows_of(tmp_path / "out")
    assert [rows[name]["state"] for name in ("ball0.ply", "ball0-2.ply", "ball0-3.ply")] == ["done", "done", "failed"]
    assert rows["ball0-3.ply"]["code"] == "OUT_OF_MEMORY" and "MiB" in rows["ball0-3.ply"]["message"]
    assert rows["ball0-3.ply"]["attempts"] == 2


def test_a_table_has_options_of_its_rows(assets, tmp_path):
    table = assets.parent / "assets.csv"
    with open(table, "w", newline="") as file:
        csv.writer(file).writerows([["path", "vertices", "uniform-area"], [f"{assets.name}/ball0.obj", 120, ""],
                                    [f"{assets.name}/ball1.obj", "", "true"], ["absent.obj", "", ""]])
    done = farm("run", table, tmp_path / "out", *SMALL)
    assert done.returncode == 9, done.stderr
    rows = rows_of(tmp_path / "out")
    assert rows[f"{assets.name}/ball0.ply"]["vertices"] == 120
    assert rows[f"{assets.name}/ball1.ply"]["options"] == {"vertices": "150", "resolution": "40", "uniform_area": True}
    assert rows["absent.ply"]["code"] == "UNREADABLE_INPUT" and rows["absent.ply"]["transient"]


def test_an_option_that_repeats_holds_each_time(tmp_path):
    labels = np.zeros((16, 10, 10), np.int32)
    labels[2:8, 2:8, 2:8], labels[8:14, 2:8, 2:8] = 1, 2
    labels = isoshell.Labels(labels, names={2: "femur"})
    (tmp_path / "in").mkdir()
    labels.save(tmp_path / "in/seg.vdb")
    done = farm("run", tmp_path / "in/*.vdb", tmp_path / "out", "--workers", 1, "--edge-length", 1.5, "--device", "cpu",
                "--region-edge-length", "1=0.8", "--region-edge-length", "femur=1.1")
    assert done.returncode == 0, done.stderr
    row = rows_of(tmp_path / "out")["seg.ply"]
    lengths = {1: 0.8, "femur": 1.1}
    alone = isoshell.remesh(labels, edge_length=1.5, region_edge_length=lengths, stats=True, device="cpu")
    assert row["digest"] == alone.digest
    assert row["options"]["region_edge_length"] == "1=0.8\nfemur=1.1"


def test_a_mesh_that_misses_a_requirement_is_put_aside(assets, tmp_path):
    done = farm("run", assets / "ball[01].obj", tmp_path / "out", *SMALL, "--require", "closed,genus=1")
    assert done.returncode == 9
    assert files_of(tmp_path / "out") == {f"rejected/ball{i}.{end}" for i in (0, 1) for end in ("ply", "json")}
    row = rows_of(tmp_path / "out")["ball0.ply"]
    assert row["code"] == "GATE_FAILED" and len(row["gates"]["missed"]) == 1 and row["rejected"] == "rejected/ball0.ply"


def test_a_sequence_is_one_asset(tmp_path):
    vertices, faces = make_ball()
    for i in (1, 2, 3):
        write_obj(tmp_path / f"cache.{i:04d}.obj", vertices * (1 + 0.01 * i), faces)
    table = tmp_path / "assets.csv"
    table.write_text("path,frames\ncache.####.obj,1-3\ncache.####.obj,1-4\n")
    out = tmp_path / "out"
    done = farm("run", table, out, *SMALL)
    assert done.returncode == 9, done.stderr
    assert {f"cache.000{i}.{end}" for i in (1, 2, 3) for end in ("ply", "json")} == files_of(out)
    rows = rows_of(out)
    assert rows["cache.####.ply"]["frames"] == 3 and "0004" in rows["cache.####-2.ply"]["message"]
    subprocess.run([sys.executable, "-m", "isoshell", tmp_path / "cache.####.obj", tmp_path / "own.####.ply",
                    "--frames", "1-3", *SMALL[:4], "--quiet"], check=True)
    for i in (1, 2, 3):
        assert (tmp_path / f"own.000{i}.ply").read_bytes() == (out / f"cache.000{i}.ply").read_bytes()
    assert "1 of 2 assets are done already" in farm("run", table, out, *SMALL).stderr


def test_inputs_and_outputs_may_be_in_object_storage(assets, tmp_path):
    """file:// is a place of fsspec like any other."""
    out = tmp_path / "out"
    done = farm("run", f"file://{assets}", f"file://{out}", *SMALL)
    assert done.returncode == 0, done.stderr
    assert len(digests_of(out)) == 4
    assert "4 of 4 assets are done already" in farm("run", f"file://{assets}", f"file://{out}", *SMALL).stderr
    assert "4 assets: 4 done" in farm("status", f"file://{out}").stdout


@pytest.mark.parametrize("words, says", [
    (["--verticse", "7"], "verticse"), (["--vertices", "0"], "vertices"),
    (["--asset-memory", "much"], "--asset-memory"), (["--scheduler", "nowhere.json"], "no such file"),
    (["--scheduler", "tcp://127.0.0.1:9", "--workers", "2"], "local"),
])
def test_what_cannot_be_is_refused_before_anything_starts(assets, tmp_path, words, says):
    done = farm("run", assets, tmp_path / "out", *words)
    assert done.returncode == 2 and says in done.stderr and not list(tmp_path.glob("out/*.ply"))


def test_a_place_without_assets_is_refused(tmp_path):
    assert farm("run", tmp_path, tmp_path / "out").returncode == 3
    assert farm("status", tmp_path).returncode == 3
    table = tmp_path / "assets.csv"
    table.write_text("path,verticse\na.obj,7\n")
    refused = farm("run", table, tmp_path / "out")
    assert refused.returncode == 2 and "the column verticse is no option" in refused.stderr


def test_a_folder_has_the_files_of_every_format_that_is_read(tmp_path):
    """The formats are those of the library's table, with the ones that other packages read."""
    folder = tmp_path / "assets"
    folder.mkdir()
    for ending in (*_isoshell.input_formats(), *(row[0] for row in _isoshell.python_formats() if row[2])):
        (folder / f"{ending.replace('.', '_')}.{ending.upper()}").touch()
    for name in ("notes.txt", ".hidden.vtp", "grid.h5", "archive.gz"):
        (folder / name).touch()
    found = assets_of(str(folder), {}, ".ply", str(tmp_path / "out"))
    assert {"nii_gz.ply", "vtp.ply", "msh.ply", "usdz.ply", "obj.ply"} < {asset.output for asset in found}
    assert len(found) == len(list(folder.iterdir())) - 4
    assert all(os.path.basename(asset.path).partition(".")[0] + ".ply" == asset.output for asset in found)
    pattern = assets_of(str(folder / "v*"), {}, ".ply", str(tmp_path / "out"))
    assert {asset.output for asset in pattern} >= {"vtp.ply", "vtu.ply", "vti.ply", "vdb.ply"}


def test_files_of_other_packages_are_assets(tmp_path):
    meshio = pytest.importorskip("meshio")
    vertices, faces = make_ball()
    assets, out = tmp_path / "assets", tmp_path / "out"
    assets.mkdir()
    meshio.Mesh(vertices, [("triangle", faces)]).write(assets / "ball.vtu")
    done = farm("run", assets, out, *SMALL)
    assert done.returncode == 0, done.stderr
    assert files_of(out) == {"ball.ply", "ball.json"}


def test_slurm_jobs_are_described_by_the_configuration_of_dask():
    pytest.importorskip("dask_jobqueue")
    pytest.importorskip("cryptography")
    import dask

    from isoshell._farm._clusters import slurm_cluster

    with pytest.raises(isoshell.Error, match="jobqueue.yaml"):
        slurm_cluster(False)
    job = {"jobqueue.slurm.cores": 16, "jobqueue.slurm.memory": "64GB", "jobqueue.slurm.queue": "short",
           "jobqueue.slurm.account": "art", "jobqueue.slurm.walltime": "02:00:00"}
    with dask.config.set(job), slurm_cluster(False) as cluster:
        script = cluster.job_script()
        key = Path(re.search(r"--tls-key (\S+)", script)[1])
        assert key.stat().st_mode & 0o077 == 0 and "PRIVATE KEY" in key.read_text()
        assert cluster.scheduler_address.startswith("tls://")
        connect(cluster.scheduler_address, security=cluster.security)
        assert_is_refused(cluster.scheduler_address.replace("tls:", "tcp:"))
    assert "#SBATCH -p short" in script and "#SBATCH -A art" in script and "--nthreads" in script
