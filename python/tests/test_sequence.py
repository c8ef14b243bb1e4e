"""Sequences: frame by frame what the command makes of all."""

import gc
import json
import subprocess
import sys
import weakref

import isoshell
import numpy as np
import pytest
from conftest import make_ball, write_obj
from isoshell import ErrorCode
from moving_shapes import MOTION, spin_between, twisted

SMALL = {"vertices": 200, "features": "off"}
SMALL_WORDS = ("--vertices", 200, "--features", "off")


@pytest.fixture
def frames(tmp_path):
    """Four frames as files."""
    for n in range(1, 5):
        write_obj(tmp_path / f"in.{n:04}.obj", *twisted(n))
    return tmp_path / "in.####.obj"


@pytest.fixture
def of_command(command, tmp_path, frames):
    """What the command makes of the files: their bytes, and their statistics."""

    def run(*words, numbers=(1, 2, 3, 4)):
        folder = tmp_path / "command"
        folder.mkdir(exist_ok=True)
        done = command(frames, folder / "out.##.ply", "--frames", f"{numbers[0]}-{numbers[-1]}", "--stats",
                       folder / "s.##.json", "--force", *SMALL_WORDS, *words)
        assert done.returncode == 0, done.stderr
        return ([(folder / f"out.{n:02}.ply").read_bytes() for n in numbers],
                [json.loads((folder / f"s.{n:02}.json").read_text()) for n in numbers])

    return run


def digests(written):
    return [one["digests"]["mesh"] for one in written]


def test_files_give_the_files_of_the_command(tmp_path, frames, of_command):
    expected, written = of_command()
    made = list(isoshell.remesh_sequence(frames, frames="1-4", output=tmp_path / "out.##.ply",
                                         stats=tmp_path / "s.##.json", **SMALL))
    assert [(tmp_path / f"out.{n:02}.ply").read_bytes() for n in range(1, 5)] == expected
    assert [result.digest for result in made] == digests(written)
    assert [result.frame for result in made] == [1, 2, 3, 4]
    assert json.loads((tmp_path / "s.03.json").read_text())["coherence"] == written[2]["coherence"]


def test_arrays_give_the_meshes_of_the_command(tmp_path, of_command):
    expected, written = of_command()
    made = isoshell.remesh_sequence((twisted(n) for n in range(1, 5)), output=tmp_path / "out.##.ply", **SMALL)
    assert [result.digest for result in made] == digests(written)
    assert [(tmp_path / f"out.{n:02}.ply").read_bytes() for n in range(1, 5)] == expected


def test_every_other_frame_and_frames_of_their_own_are_those_of_the_command(frames, of_command, command, tmp_path):
    expected = digests(of_command("--no-coherence")[1])
    assert [r.digest for r in isoshell.remesh_sequence(frames, frames="1-4", no_coherence=True, **SMALL)] == expected
    command(frames, tmp_path / "other.#.ply", "--frames", "1-4x2", *SMALL_WORDS, "--stats", tmp_path / "other.#.json")
    expected = [json.loads((tmp_path / f"other.{n}.json").read_text())["digests"]["mesh"] for n in (1, 3)]
    for numbers in ("1-4x2", range(1, 5, 2)):
        assert [r.digest for r in isoshell.remesh_sequence(frames, frames=numbers, **SMALL)] == expected


def test_a_frame_has_its_motion_and_how_steady_it_is():
    first, second = isoshell.remesh_sequence(map(twisted, (0, 1)), **SMALL)
    assert not MOTION & set(first.attributes) and first.report["coherence"] is None
    assert MOTION <= set(second.attributes) and second.report["coherence"]["began_warm"]
    assert second.report["coherence"]["kept_edges_pct"] > 90
    old = second.attributes["born"] == 0
    assert old.sum() == 200 - second.report["coherence"]["born"]
    moved = np.column_stack([second.attributes[name] for name in ("vx", "vy", "vz")])
    in_file = first.vertices.astype(np.float32).astype(float)
    assert np.allclose((second.vertices - moved)[old], in_file[old], atol=1e-6)
    assert np.all(moved[~old] == 0)


def test_every_kind_of_source_can_be_a_frame(tmp_path, frames):
    third = isoshell.Mesh(*twisted(3), of_vertices={"heat": np.arange(len(twisted(3)[0]))})
    kinds = [str(frames).replace("####", "0001"), twisted(2), third, isoshell.remesh(twisted(4), **SMALL)]
    made = list(isoshell.remesh_sequence(iter(kinds), frames=range(10, 14), **SMALL))
    assert [result.frame for result in made] == [10, 11, 12, 13]
    assert "heat" in made[2].attributes and MOTION <= set(made[2].attributes)
    assert all(result.report["coherence"]["began_warm"] for result in made[1:])


def spinning(angle, with_velocities):
    """An ellipsoid that spins about z by so much a frame: distances, and velocities around it."""
    n, spacing = 32, 0.1
    at = (np.indices((n, n, n)) - (n - 1) / 2) * spacing
    x, y = np.cos(angle) * at[0] + np.sin(angle) * at[1], np.cos(angle) * at[1] - np.sin(angle) * at[0]
    values = np.sqrt(x ** 2 + (y / 0.8) ** 2 + at[2] ** 2) - 1
    velocities = np.stack([-0.1 * at[1], 0.1 * at[0], np.zeros_like(at[0])], axis=-1) if with_velocities else None
    return isoshell.Volume(values, spacing, -(n - 1) / 2 * spacing, velocities)


def test_vertices_of_volumes_go_along_their_velocities():
    def spin_of(with_velocities):
        sources = [spinning(0.1 * frame, with_velocities) for frame in range(2)]
        return spin_between(*isoshell.remesh_sequence(sources, iso=0, **SMALL))

    assert abs(spin_of(True) - 0.1) < 0.01
    assert abs(spin_of(False)) < 0.05


def test_vertices_of_meshes_with_other_faces_go_along_their_velocities():
    def spin_of(with_velocities):
        sources = []
        for frame in range(2):
            vertices, faces = make_ball(16 + 2 * frame)
            velocities = np.cross([0, 0, 0.1], vertices) if with_velocities else None
            sources.append(isoshell.Mesh(vertices, faces, velocities=velocities))
        first, second = isoshell.remesh_sequence(sources, **SMALL)
        return spin_between(first, second)

    assert abs(spin_of(True) - 0.1) < 0.01
    assert abs(spin_of(False)) < 0.01
    vertices, faces = make_ball()
    broken = isoshell.Mesh(vertices * [1, 1, np.nan], faces, velocities=np.zeros_like(vertices))
    with pytest.raises(isoshell.Error, match="frame 1: .*must be finite"):
        next(isoshell.remesh_sequence([broken], **SMALL))
    wrong = isoshell.Mesh(vertices, faces, velocities=np.zeros((7, 3)))
    with pytest.raises(isoshell.Error, match=r"frame 1: velocities must have the shape \(266, 3\)"):
        next(isoshell.remesh_sequence([wrong], **SMALL))


def test_velocities_that_fit_no_volume_are_refused_by_their_frame():
    volume = spinning(0, True)
    volume.velocities = volume.velocities[:-1]
    with pytest.raises(isoshell.Error, match=r"frame 1: velocities must have the shape \(32, 32, 32, 3\)"):
        next(isoshell.remesh_sequence([volume], iso=0, **SMALL))
    with pytest.raises(isoshell.Error, match="frame 1: velocity names a grid"):
        next(isoshell.remesh_sequence([twisted(1)], velocity="v", **SMALL))


def test_masks_need_no_isovalue_in_any_frame():
    at = np.indices((24, 24, 24)) - 12
    masks = [isoshell.Volume((at ** 2).sum(axis=0) < r * r) for r in (8, 9)]
    assert len(list(isoshell.remesh_sequence(masks, **SMALL))) == 2


def test_a_frame_is_made_when_it_is_asked_for_and_not_kept(tmp_path):
    asked = []

    def sources():
        for n in range(1, 100):
            asked.append(n)
            yield twisted(n)

    made = isoshell.remesh_sequence(sources(), output=tmp_path / "out.##.ply", **SMALL)
    assert asked == []
    first = weakref.ref(next(made))
    next(made)
    gc.collect()
    assert asked == [1, 2] and first() is None
    made.close()
    assert asked == [1, 2] and list(made) == []
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out.01.ply", "out.02.ply"]
    with isoshell.remesh_sequence(sources(), **SMALL) as made:
        next(made)
    assert list(made) == []


def test_it_resumes_to_the_same_bytes_from_files_and_from_arrays(tmp_path, frames, of_command):
    expected, _ = of_command()
    list(isoshell.remesh_sequence(frames, frames="1-2", output=tmp_path / "out.##.ply", **SMALL))
    made = isoshell.remesh_sequence(frames, frames="1-3", output=tmp_path / "out.##.ply", resume=True, **SMALL)
    assert [result.frame for result in made] == [3]
    arrays = [twisted(n) for n in range(1, 5)]
    made = isoshell.remesh_sequence(arrays, output=tmp_path / "out.##.ply", resume=True, **SMALL)
    assert [(result.frame, result.report["coherence"]["began_warm"]) for result in made] == [(4, True)]
    assert [(tmp_path / f"out.{n:02}.ply").read_bytes() for n in range(1, 5)] == expected
    for output in (None, tmp_path / "out.##.stl", tmp_path / "out.usda"):
        with pytest.raises(isoshell.Error, match="PLY"):
            isoshell.remesh_sequence(arrays, output=output, resume=True, **SMALL)


def test_a_bad_frame_ends_the_sequence_by_name(tmp_path, frames):
    (tmp_path / "in.0002.obj").write_text("v 0 0 0\nf 1 2 3\n")
    made = isoshell.remesh_sequence(frames, frames="1-4", output=tmp_path / "out.#.ply", **SMALL)
    next(made)
    with pytest.raises(isoshell.Error, match="frame 2: .*in.0002.obj") as caught:
        next(made)
    assert caught.value.code == ErrorCode.UNREADABLE_INPUT
    assert list(made) == [] and (tmp_path / "out.1.ply").exists()
    wrong = (twisted(1)[0], [(0, 1, 10**6)])
    with pytest.raises(isoshell.Error, match="frame 2: faces.*1000000"):
        list(isoshell.remesh_sequence([twisted(1), wrong], **SMALL))


def test_keeping_on_it_yields_the_others_and_says_what_went_wrong(tmp_path, frames, of_command, command):
    (tmp_path / "in.0002.obj").unlink()
    made = isoshell.remesh_sequence(frames, frames="1-4", keep_going=True, **SMALL)
    with pytest.warns(isoshell.RunWarning, match="frame 2: .*no such file"):
        results = list(made)
    assert [result.frame for result in results] == [1, 3, 4]
    assert list(made.errors) == [2] and made.errors[2].code == ErrorCode.UNREADABLE_INPUT
    command(frames, tmp_path / "out.##.ply", "--frames", "1-4", "--keep-going", *SMALL_WORDS)
    for result in results:
        result.save(tmp_path / "ours.ply", overwrite=True)
        assert (tmp_path / "ours.ply").read_bytes() == (tmp_path / f"out.{result.frame:02}.ply").read_bytes()


def test_a_frame_that_misses_a_requirement_is_in_the_error_or_with_keep_going_among_the_others():
    arrays = [twisted(1), twisted(9)]
    made = isoshell.remesh_sequence(arrays, require="closed,born=0", **SMALL)
    next(made)
    with pytest.raises(isoshell.Error, match="frame 2: .*born=0") as caught:
        next(made)
    assert caught.value.code == ErrorCode.GATE_FAILED and len(caught.value.result.vertices) == 200
    made = isoshell.remesh_sequence(arrays, require="closed,born=0", keep_going=True, quiet=True, **SMALL)
    assert len(list(made)) == 2 and made.errors[2].code == ErrorCode.GATE_FAILED


def test_what_can_be_checked_is_refused_before_it_starts(tmp_path, frames):
    (tmp_path / "in.0002.obj").unlink()
    (tmp_path / "there.1.ply").write_text("there")
    out, arrays = tmp_path / "out.#.ply", [twisted(1)]
    for source, given, words, code in (
        (frames, {"frames": "1-4"}, "1 frame is missing: frame 2", ErrorCode.UNREADABLE_INPUT),
        (frames, {}, "Give frames", ErrorCode.USAGE),
        (frames, {"frames": "4-1"}, "frames is '4-1'", ErrorCode.USAGE),
        (frames, {"frames": 1.5}, "frames is 1.5", ErrorCode.USAGE),
        (frames, {"frames": range(0)}, "range", ErrorCode.USAGE),
        (tmp_path / "in.obj", {"frames": "1-4"}, "no place for the number", ErrorCode.USAGE),
        (arrays, {"output": tmp_path / "out.ply"}, "no place for the number", ErrorCode.USAGE),
        (arrays, {"output": tmp_path / "there.#.ply"}, "frame 1, .*force replaces", ErrorCode.UNWRITABLE_OUTPUT),
        (arrays, {"output": out, "report": tmp_path / "r.html"}, "report", ErrorCode.USAGE),
        (arrays, {"stats": "-"}, "pattern", ErrorCode.USAGE),
        (arrays, {"keep_going": 1}, "keep_going is 1", ErrorCode.USAGE),
        (arrays, {"verticse": 7}, "did you mean vertices", ErrorCode.USAGE),
        (7, {}, "is int", ErrorCode.USAGE),
    ):
        with pytest.raises(isoshell.Error, match=words) as caught:
            isoshell.remesh_sequence(source, **given)
        assert caught.value.code == code, words


@pytest.mark.parametrize("frames, words", [("1-3", "ended before frame 3"), (1, "a source after that of frame 1")])
def test_sources_and_numbers_end_together(frames, words):
    with pytest.raises(isoshell.Error, match=words):
        list(isoshell.remesh_sequence([twisted(1), twisted(2)], frames=frames, vertices=100))


def test_an_interruption_ends_the_sequence_and_leaves_the_context_to_others():
    class Stop(Exception):
        pass

    def progress(stage, part):
        if stage == "relax":
            raise Stop

    context = isoshell.Context(progress=progress)
    made = isoshell.remesh_sequence(map(twisted, range(5)), context=context, keep_going=True, **SMALL)
    with pytest.raises(Stop):
        next(made)
    assert list(made) == []
    context.progress = None
    assert len(isoshell.remesh(twisted(0), context=context, **SMALL).vertices) == 200


def test_progress_is_of_all_frames_and_never_goes_back():
    heard = []
    made = isoshell.remesh_sequence([twisted(0), twisted(1), twisted(2)], **SMALL,
                                    progress=lambda stage, fraction: heard.append(fraction))
    assert len(made) == 3 and made
    for number, _ in enumerate(made, 1):
        assert heard[-1] == pytest.approx(number / 3)
    assert heard[0] == 0 and heard[-1] == 1 and heard == sorted(heard)
    unknown = isoshell.remesh_sequence(map(twisted, range(2)), **SMALL)
    with pytest.raises(TypeError, match="give frames"):
        len(unknown)
    assert len(list(unknown)) == 2


def test_any_number_of_threads_gives_the_same_bytes():
    once = [r.digest for r in isoshell.remesh_sequence(map(twisted, range(3)), threads=1, **SMALL)]
    assert [r.digest for r in isoshell.remesh_sequence(map(twisted, range(3)), threads=2, **SMALL)] == once


def test_the_module_that_runs_is_the_command_for_sequences_too(tmp_path, frames, of_command):
    expected, _ = of_command()
    done = subprocess.run([sys.executable, "-m", "isoshell", frames, tmp_path / "out.##.ply", "--frames", "1-4",
                           *map(str, SMALL_WORDS)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert [(tmp_path / f"out.{n:02}.ply").read_bytes() for n in range(1, 5)] == expected
