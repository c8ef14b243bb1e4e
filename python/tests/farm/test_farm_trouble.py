"""Names, tables and journals that are not as they should be, and a second farm in the same place."""

import json
import os
import random
import shutil
import time

import pytest
from conftest import make_ball, write_obj
from farms import (ENDLESS, SMALL, assert_is_serial, digests_of, end, engine, farm, held, make_assets,  # noqa: F401
                   row_of, rows_of, start_farm, wait_for_rows)

import isoshell
from isoshell._farm import _manifest as manifest
from isoshell._farm import _page, _plan, _status
from isoshell._farm._assets import assets_of
from isoshell._farm._rows import line_of

NAMES = (b"b\xff.obj", "grün.obj".encode(), "grün.obj".encode("latin-1"), b"a\nb.obj", b"<!--.obj")


def strange_assets(folder):
    folder.mkdir()
    vertices, faces = make_ball()
    for name in NAMES:
        write_obj(folder / os.fsdecode(name), vertices, faces)
    return folder


@pytest.mark.parametrize("is_local", [True, False])
def test_names_that_are_not_utf_8_are_names_as_any_other(is_local, tmp_path, request):
    assets, out = strange_assets(tmp_path / "assets"), tmp_path / "out"
    words = SMALL if is_local else [*SMALL[:4], "--scheduler", request.getfixturevalue("engine")[0]]
    done = farm("run", assets, out, *words)
    assert done.returncode == 0, done.stderr
    made = {os.fsencode(path.name) for path in out.glob("*.ply")}
    assert made == {name.replace(b".obj", b".ply") for name in NAMES}
    assert {row["asset"] for row in rows_of(out).values()} == {str(path) for path in assets.iterdir()}
    assert len({path.read_bytes() for path in out.glob("*.ply")}) == 1
    for path in out.glob("*.json"):
        assert json.loads(path.read_text())["input"]["path"] in {str(asset) for asset in assets.iterdir()}
    assert "5 of 5 assets are done already" in farm("run", assets, out, *words).stderr
    assert "b\\udcff.obj" in farm("status", out).stdout
    assert farm("report", out).returncode == 0
    page = (out / "report.html").read_text(encoding="utf-8")
    assert 'href="./b%FF.ply"' in page and "<!--" not in page.split("</header>")[1]


def test_a_sequence_may_have_a_name_that_is_not_utf_8(tmp_path):
    vertices, faces = make_ball()
    for number in (1, 2):
        write_obj(tmp_path / os.fsdecode(b"c\xff.%d.obj" % number), vertices * (1 + 0.01 * number), faces)
    table = tmp_path / "assets.jsonl"
    table.write_text(json.dumps({"path": os.fsdecode(b"c\xff.#.obj"), "frames": "1-2"}))
    done = farm("run", table, tmp_path / "out", *SMALL)
    assert done.returncode == 0, done.stderr
    assert {os.fsencode(path.name) for path in (tmp_path / "out").glob("*.ply")} == {b"c\xff.1.ply", b"c\xff.2.ply"}


@pytest.mark.parametrize("content, says", [
    (b"path,vertices\na.obj,100\ngr\xfcn.obj,100\n", "line 3 is not UTF-8"),
    (b"path,frames\na.####.obj,1-9999999999\n", "row 1: frames is '1-9999999999', which are 9999999999 frames"),
    (b"path,frames\na.obj,1-9" + b"9" * 5000, "row 1: frames is"),
    (b"path,frames\na.%099999999d.obj,1-2\n", "row 1:"),
    (b"path,vertices\na.obj,100,200\n", "line 2 has more cells"),
    (b'path,vertices\n"a.obj,100\n', "line 2: "),
    (b"path,vertices\na\0.obj,100\n", "NUL"),
])
def test_a_table_that_cannot_be_is_refused_with_its_place(content, says, tmp_path):
    table = tmp_path / "assets.csv"
    table.write_bytes(content)
    done = farm("run", table, tmp_path / "out")
    assert done.returncode == 2 and f"{table}: " in done.stderr and says in done.stderr, done.stderr
    assert "Traceback" not in done.stderr


def test_a_table_of_json_is_refused_with_its_line(tmp_path):
    table = tmp_path / "assets.jsonl"
    for content, says in ((b'{"path": "a\xff.obj"}', "line 1 is not UTF-8"), (b'{}\n{"path": "a\\u0000"}', "row 1"),
                          (b"[" * 100000, "line 1 is no JSON"), (b'{"path": "a.obj"}\n7', "line 2 is no object")):
        table.write_bytes(content)
        done = farm("run", table, tmp_path / "out")
        assert done.returncode == 2 and says in done.stderr and "Traceback" not in done.stderr, done.stderr


def test_a_second_farm_in_the_same_place_is_refused_and_says_who_is_there(held, serial, tmp_path):
    out = tmp_path / "out"
    first = start_farm("run", held, out, *SMALL, *ENDLESS)
    try:
        wait_for_rows(out, 4)
        second = farm("run", held, out, *SMALL, *ENDLESS)
        assert second.returncode == 4 and f"process {first.pid} of " in second.stderr, second.stderr
        assert "4 done" in farm("status", out).stdout
    finally:
        end(first)
    (held / "held.obj").unlink()
    assert farm("run", held, out, *SMALL).returncode == 0
    assert_is_serial(out, serial)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """Two assets that are done, and one that has failed."""
    folder = tmp_path_factory.mktemp("finished")
    assets = make_assets(folder / "assets", 2)
    (assets / "malformed.ply").write_bytes(b"ply\nformat ascii 1.0\nelement vertex 9\n")
    assert farm("run", assets, folder / "out", *SMALL).returncode == 9
    return folder


def journal_of(out):
    return sorted((out / "manifest").glob("*.jsonl"))


def test_a_flipped_bit_is_named_and_what_it_hit_is_made_again(finished):
    out = finished / "out"
    options = {"vertices": "150", "resolution": "40"}
    assets = assets_of(str(finished / "assets"), options, ".ply", str(out))
    whole = manifest.read(str(out))
    random_numbers = random.Random(20261128)
    for _ in range(1500):
        file = random_numbers.choice(journal_of(out))
        content = file.read_bytes()
        at, bit = random_numbers.randrange(len(content)), random_numbers.randrange(8)
        file.write_bytes(content[:at] + bytes([content[at] ^ 1 << bit]) + content[at + 1:])
        try:
            found = manifest.read(str(out))
            lost = set(whole.rows) - set(found.rows)
            assert all(found.rows[name] == whole.rows[name] for name in found.rows)
            assert all(run in whole.runs for run in found.runs)
            assert found.damaged or at == len(content) - 1  # without its end the last line is as one that was torn
            assert len(lost) + len(whole.runs) - len(found.runs) in (1, 2)  # two where the line between them is gone
            plan = _plan.plan_of(assets, found.rows, str(out), False)
            assert {asset.output for asset, _ in plan.wanted} == lost
            if found.runs:
                _page.page(found, str(out), str(out))
                _status.counts_of(found)
        finally:
            file.write_bytes(content)


def test_a_damaged_journal_is_told_of_and_mended_by_the_next_run(finished, tmp_path):
    out = tmp_path / "out"
    shutil.copytree(finished / "out", out)
    before = digests_of(out)
    damaged = journal_of(out)
    for file in damaged:
        file.write_bytes(file.read_bytes().replace(b'"state"', b'"stale"').replace(b'"began"', b'"begun"'))
    done = farm("status", out)
    assert done.returncode == 3 and "checksum" in done.stderr and "Traceback" not in done.stderr
    done = farm("run", finished / "assets", out, *SMALL)
    assert done.returncode == 9 and "4 damaged rows are passed over" in done.stderr, done.stderr
    assert damaged[0].name in done.stderr and "line 1" in done.stderr
    assert "3 assets: 2 done, 1 failed" in farm("status", out).stdout
    after = manifest.read(str(out)).rows
    assert {name: (row["digest"], row["output_sha256"]) for name, row in after.items()
            if row["state"] == "done"} == before


@pytest.mark.parametrize("change", [{"time": "now"}, {"time": float("nan")}, {"output": 7}, {"options": []},
                                    {"state": "lost"}, {"output_size": None}, {"seconds": True}, {"quality": "good"},
                                    {"version": None}, {"time": time.time() + 1e6}])
def test_a_row_that_is_whole_and_means_nothing_is_named(change, tmp_path):
    (tmp_path / "manifest").mkdir()
    line = line_of({**row_of("a.ply"), "time": 1.0, **change})
    (tmp_path / "manifest/by-hand.jsonl").write_bytes(line_of({**row_of("b.ply"), "time": 1.0}) + line)
    found = manifest.read(str(tmp_path))
    assert set(found.rows) == {"b.ply"}
    assert len(found.damaged) == 1 and found.damaged[0].startswith("manifest/by-hand.jsonl, line 2: ")
    assert next(iter(change)) in found.damaged[0]


def test_rows_of_a_clock_that_was_ahead_and_of_another_version_do_not_hold_up_a_run(finished, tmp_path):
    out = tmp_path / "out"
    shutil.copytree(finished / "out", out)
    rows = manifest.read(str(out)).rows
    ahead = {**rows["ball0.ply"], "state": "failed", "code": "CRASHED", "message": "", "transient": True,
             "time": time.time() + 3600}
    other = {**rows["ball1.ply"], "version": "99.0", "time": time.time() + 3600}
    (out / "manifest/ahead.jsonl").write_bytes(line_of(ahead) + line_of(other))
    done = farm("run", finished / "assets", out, *SMALL)
    assert done.returncode == 9 and "0 of 3 assets are done already" in done.stderr, done.stderr
    after = manifest.read(str(out)).rows
    assert [(after[f"ball{i}.ply"]["state"], after[f"ball{i}.ply"]["version"]) for i in (0, 1)] == [
        ("done", isoshell.__version__)] * 2
    assert "2 of 3 assets are done already" in farm("run", finished / "assets", out, *SMALL).stderr
