"""A farm that is ended in the middle, in whatever way, loses nothing and goes on where it was."""

import json
import os
import random
import shutil
import signal
import subprocess

import pytest
from conftest import FOREVER, make_ball, write_obj
from farms import (ENDLESS, SMALL, assert_is_serial, digests_of, end, engine, farm, files_of,  # noqa: F401
                   held, make_assets, processes_of, row_of, rows_of, start_farm, wait_for, wait_for_rows)

from isoshell._farm import _manifest as manifest


def assert_nothing_is_half_written(out):
    for name in files_of(out):
        if name.endswith(".json"):
            json.loads((out / name).read_text())
        elif not name.startswith(".farm/"):
            assert name.endswith(".ply") and (out / name).read_bytes()[:3] == b"ply"


def finish(held, out, serial):
    """What the next farm says, for which nothing holds on any more. The assets that all farms have are then as they are
    elsewhere."""
    (held / "held.obj").unlink()
    write_obj(held / "held.obj", *make_ball())
    done = farm("run", held, out, *SMALL)
    assert done.returncode == 0, done.stderr
    (out / "held.ply").unlink()
    for path in (out / "manifest").glob("*.jsonl"):
        path.write_text("".join(line for line in path.read_text().splitlines(True) if "held.ply" not in line))
    assert_is_serial(out, serial)
    return done.stderr


def assert_goes_on_where_it_was(held, out, serial):
    assert_nothing_is_half_written(out)
    assert "4 of 5 assets are done already" in finish(held, out, serial)


def wait_for_end_of(processes):
    wait_for(lambda: not any(process.is_running() for process in processes))


def test_an_interrupted_farm_says_how_to_go_on_and_leaves_no_process(held, serial, tmp_path):
    out = tmp_path / "out"
    process = start_farm("run", held, out, *SMALL, *ENDLESS)
    wait_for_rows(out, 4)
    children = processes_of(process, "isoshell._farm._child")
    assert children
    os.killpg(process.pid, signal.SIGINT)
    _, said = process.communicate(timeout=FOREVER)
    assert process.returncode == 130 and f"isoshell farm run {held} {out}" in said and "Traceback" not in said
    wait_for_end_of(children)
    assert_goes_on_where_it_was(held, out, serial)
    assert not (out / ".farm").exists()


def test_a_farm_whose_processes_are_all_killed_goes_on_where_it_was(held, serial, tmp_path):
    out = tmp_path / "out"
    process = start_farm("run", held, out, *SMALL, *ENDLESS)
    wait_for_rows(out, 4)
    others = processes_of(process, "isoshell._farm._child")
    assert others
    end(process)
    wait_for_end_of(others)
    assert "4 remaining" not in farm("status", out).stdout
    assert_goes_on_where_it_was(held, out, serial)


def test_a_killed_worker_is_started_again_and_its_assets_are_meshed(engine, held, serial, tmp_path):
    out, (address, _, nanny) = tmp_path / "out", engine
    process = start_farm("run", held, out, *SMALL[:4], "--scheduler", address, *ENDLESS)
    wait_for(lambda: processes_of(nanny, "isoshell._farm._child"))
    killed = {child.parent().pid for child in processes_of(nanny, "isoshell._farm._child")}
    for pid in killed:
        os.kill(pid, signal.SIGKILL)
    wait_for_rows(out, 4)
    wait_for(lambda: {child.ppid() for child in processes_of(nanny, "isoshell._farm._child")} - killed - {1})
    said = end(process, signal.SIGINT)
    assert process.returncode == 130, said
    finish(held, out, serial)
    wait_for(lambda: not (out / ".farm").exists())  # the worker goes on, and tidies up in its own time


def test_a_farm_on_a_scheduler_that_dies_ends_and_says_how_to_go_on(engine, held, serial, tmp_path):
    out, (address, scheduler, _) = tmp_path / "out", engine
    process = start_farm("run", held, out, *SMALL[:4], "--scheduler", address, *ENDLESS)
    wait_for_rows(out, 4)
    scheduler.kill()
    _, said = process.communicate(timeout=FOREVER)
    assert process.returncode == 10 and "does not answer" in said, said
    assert f"isoshell farm run {held} {out}" in said
    assert_goes_on_where_it_was(held, out, serial)


def test_a_full_disk_stops_the_farm_and_room_lets_it_go_on(assets, serial, tmp_path):
    disk = tmp_path / "disk"
    disk.mkdir()
    as_root = ["sudo", "-n"] if os.geteuid() and shutil.which("sudo") else []
    mount = ["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", str(disk)]
    if subprocess.run([*as_root, *mount], capture_output=True).returncode:
        pytest.skip("only root can mount a small disk")
    try:
        out, filler = disk / "out", disk / "filler"
        out.mkdir()
        (out / "manifest").mkdir()
        filler.write_bytes(os.urandom(1000 << 10))
        done = farm("run", assets, out, *SMALL)
        assert done.returncode == 4 and "make room" in done.stderr and "Traceback" not in done.stderr, done.stderr
        assert_nothing_is_half_written(out)
        filler.unlink()
        done = farm("run", assets, out, *SMALL)
        assert done.returncode == 0, done.stderr
        assert_is_serial(out, serial)
    finally:
        subprocess.run([*as_root, "umount", str(disk)], check=True)


def test_a_share_that_comes_back_is_read_by_the_next_run(tmp_path):
    assets, out = make_assets(tmp_path / "assets", 2), tmp_path / "out"
    table = tmp_path / "assets.csv"
    table.write_text("path\nassets/ball0.obj\nassets/ball1.obj\n")
    assets.rename(tmp_path / "away")
    done = farm("run", table, out, *SMALL)
    assert done.returncode == 9 and {row["code"] for row in rows_of(out).values()} == {"UNREADABLE_INPUT"}
    (tmp_path / "away").rename(assets)
    assert farm("run", table, out, *SMALL).returncode == 0
    assert len(digests_of(out)) == 2


def test_a_line_that_was_torn_is_passed_over_wherever_it_was_torn(tmp_path):
    writer = manifest.Writer(str(tmp_path), 0)
    for name in ("a.ply", "b.ply"):
        writer.append(row_of(name, state="failed", code="CRASHED", message="größer"))
    writer.close()
    file = next((tmp_path / "manifest").iterdir())
    whole = file.read_bytes()
    first = whole.index(b"\n") + 1
    for length in random.Random(1).sample(range(first, len(whole) - 1), 40):
        file.write_bytes(whole[:length])
        found = manifest.read(str(tmp_path))
        assert set(found.rows) == {"a.ply"} and not found.damaged
    file.write_bytes(whole)
    assert set(manifest.read(str(tmp_path)).rows) == {"a.ply", "b.ply"}


def test_of_several_rows_of_an_asset_the_last_counts(tmp_path):
    for output_size in (1, 2):
        writer = manifest.Writer(str(tmp_path), manifest.read(str(tmp_path)).newest)
        writer.append(row_of("a.ply", output_size=output_size))
        writer.close()
    assert len(list((tmp_path / "manifest").iterdir())) == 2
    assert manifest.read(str(tmp_path)).rows["a.ply"]["output_size"] == 2


def test_object_storage_keeps_rows_in_files_that_are_put_whole(tmp_path, monkeypatch):
    monkeypatch.setattr(manifest, "ROWS_A_FILE", 3)
    place = f"file://{tmp_path}/out"
    writer = manifest.Writer(place, 0)
    for i in range(7):
        writer.append(row_of(f"{i}.ply"))
    assert len(list((tmp_path / "out/manifest").iterdir())) == 3
    assert len(manifest.read(place).rows) == 7
