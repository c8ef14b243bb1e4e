"""Many sources side by side: the results of remesh(), in the order of the sources."""

import gc
import subprocess
import sys
import time

import isoshell
import numpy as np
import pytest
from conftest import FOREVER, assert_is_interrupted, make_ball, write_obj
from isoshell import ErrorCode

SMALL = {"vertices": 60, "resolution": 24}


def ball_at(i):
    """A source that is unlike those of other numbers."""
    vertices, faces = make_ball()
    return vertices * (1, 1, 1 + 0.1 * i), faces


def bad_source():
    vertices, faces = make_ball()
    return vertices, faces + 1000


def digests_alone(numbers):
    return [isoshell.remesh(ball_at(i), **SMALL).digest for i in numbers]


@pytest.mark.parametrize("workers", [None, 1, 3])
def test_results_come_in_the_order_of_the_sources_and_are_those_of_remesh(workers):
    made = isoshell.remesh_many([ball_at(i) for i in range(8)], workers=workers, **SMALL)
    assert [result.digest for result in made] == digests_alone(range(8))


def test_no_sources_give_no_results():
    assert list(isoshell.remesh_many([], **SMALL)) == []


def test_results_have_a_length_where_the_sources_have_one():
    with isoshell.remesh_many([ball_at(i) for i in range(3)], **SMALL) as made:
        assert len(made) == 3 and made
        next(made)
        assert len(made) == 3  # what a progress bar asks for
    assert list(made) == []
    none = isoshell.remesh_many(iter([ball_at(0)]), **SMALL)
    assert none
    with pytest.raises(TypeError, match="give a list"):
        len(none)
    assert len(list(none)) == 1


def test_sources_are_whatever_remesh_takes(tmp_path):
    vertices, faces = make_ball()
    labels = np.linalg.norm(np.indices((12, 12, 12)) - 5.5, axis=0) < 4
    color = isoshell.Mesh(vertices, faces, of_vertices={"heat": vertices[:, 0].astype(np.float32)})
    sources = [write_obj(tmp_path / "ball.obj", vertices, faces), (vertices, faces), color, isoshell.Volume(labels),
               isoshell.Points(vertices, normals=vertices)]
    made = list(isoshell.remesh_many(sources, stats=True, **SMALL))
    assert [result.digest for result in made] == [isoshell.remesh(source, **SMALL).digest for source in sources]
    assert "heat" in made[2].attributes
    assert all(result.report["digests"]["mesh"] == result.digest for result in made)


def test_sources_are_read_as_they_are_needed():
    read = []

    def endless():
        while True:
            read.append(len(read))
            yield ball_at(read[-1])

    made = isoshell.remesh_many(endless(), workers=2, **SMALL)
    assert read == []
    for number in range(10):
        next(made)
        time.sleep(0.05)  # slower than the workers
        assert len(read) - number <= 9
    made.close()
    assert list(made) == []


def test_an_error_is_raised_where_its_result_would_come_and_names_the_source():
    made = isoshell.remesh_many([ball_at(0), ball_at(1), bad_source(), ball_at(3)], workers=2, **SMALL)
    assert [next(made).digest, next(made).digest] == digests_alone([0, 1])
    with pytest.raises(isoshell.Error, match="source 2: .*1000") as caught:
        next(made)
    assert caught.value.code == ErrorCode.UNREADABLE_INPUT or caught.value.code == ErrorCode.USAGE
    assert list(made) == []


def test_errors_are_returned_in_the_place_of_results_where_that_is_asked_for(tmp_path):
    sources = [ball_at(0), bad_source(), tmp_path / "none.ply", 7, ball_at(4)]
    made = list(isoshell.remesh_many(sources, on_error="return", **SMALL))
    assert [made[0].digest, made[4].digest] == digests_alone([0, 4])
    for source, error in zip(sources[1:4], made[1:4]):
        with pytest.raises(isoshell.Error) as caught:
            isoshell.remesh(source, **SMALL)
        assert isinstance(error, isoshell.Error)
        assert (str(error), error.code, error.stage) == (str(caught.value), caught.value.code, caught.value.stage)


def sources_that_cannot_be():
    vertices, faces = make_ball()
    labels = np.tile([1, 0], (len(faces), 1))

    def mesh(**parts):
        return isoshell.Mesh(vertices, faces, **parts)

    yield from ("a\0.ply", "a\0.vtp", "a\0.usda", "a\ud800.ply", None, (vertices[:, :2], faces), (vertices, faces * 0.5))
    yield from (mesh(of_faces={3: labels[:, 0]}), mesh(of_faces={"\ud800": labels[:, 0]}))
    yield mesh(of_faces={"part": labels[:, 0]}, labels={"part": ["\ud800", "b"]})
    yield from (mesh(regions=regions) for regions in (
        {"background": 0}, {"labels": labels[:7]}, {"labels": labels + 2 ** 40}, {"labels": labels, "background": "none"},
        {"labels": labels, "names": {"a": "b", 1: "c"}}, {"labels": labels, "names": {1: "\ud800"}}))
    yield isoshell.Mesh(vertices, faces.ravel(), regions={"labels": labels})
    yield isoshell.Mesh(vertices, np.column_stack([faces, faces[:, 0]]), regions={"labels": labels})
    yield from (isoshell.Volume(np.zeros((3, 3, 3)), spacing) for spacing in ((1, 2), "a", 10 ** 400))
    yield isoshell.Labels(np.ones((3, 3, 3), np.int64), affine=np.zeros((3, 3)))


def test_whatever_is_wrong_with_a_source_is_an_error_in_its_place():
    sources = [*sources_that_cannot_be()]
    made = list(isoshell.remesh_many([*sources, ball_at(0)], on_error="return", **SMALL))
    assert [type(each) for each in made] == [isoshell.Error] * len(sources) + [isoshell.Result]
    kept_on = isoshell.remesh_sequence([*sources, ball_at(0)], keep_going=True, quiet=True, **SMALL)
    assert [result.frame for result in kept_on] == [len(sources) + 1] and len(kept_on.errors) == len(sources)


def test_an_object_of_another_package_that_contradicts_itself_is_an_error_in_its_place():
    meshio = pytest.importorskip("meshio")
    vertices, faces = make_ball()
    broken = meshio.Mesh(vertices, [("triangle", faces)])
    broken.cells = None
    made, = isoshell.remesh_many([broken], on_error="return", **SMALL)
    assert made.code == ErrorCode.UNREADABLE_INPUT and "Mesh of meshio, which cannot be taken" in str(made)


def test_regions_may_have_labels_of_any_whole_numbers():
    vertices, faces = make_ball()
    for kind in (np.uint8, np.int16, np.uint64):
        regions = {"labels": np.tile([1, 0], (len(faces), 1)).astype(kind), "names": None}
        made, = isoshell.remesh_many([isoshell.Mesh(vertices, faces, regions=regions)], **SMALL)
        assert {*made.regions["labels"].ravel().tolist()} == {0, 1}


def test_the_error_of_a_missed_requirement_has_the_result():
    made, = isoshell.remesh_many([ball_at(0)], on_error="return", require="genus=1", **SMALL)
    assert made.code == ErrorCode.GATE_FAILED and len(made.result.vertices) == 60


def test_what_the_iterable_raises_is_raised():
    def broken():
        yield ball_at(0)
        raise RuntimeError("no more of these")

    with pytest.raises(RuntimeError, match="no more"):
        list(isoshell.remesh_many(broken(), **SMALL))


@pytest.mark.parametrize("sources, options, words", [
    ("a.ply", {}, "sources"), (7, {}, "sources"), ([], {"workers": 0}, "workers"), ([], {"workers": 2.5}, "workers"),
    ([], {"workers": True}, "workers"), ([], {"on_error": "ignore"}, "on_error"), ([], {"vertices": 3}, "vertices"),
    ([], {"sizing": isoshell.Volume(np.ones(3))}, "sizing must have 3 dimensions"), ([], {"sizing": "a\0.vdb"}, "NUL"),
    ([], {"sizing": isoshell.Volume("fine")}, "sizing must be an array"), ([], {"attributes": ["\ud800"]}, "half a character"),
    ([], {"recenter": (1, 2, "x")}, "recenter is 'x'"), ([], {"region_edge_length": {"\ud800": 1}}, "half a character"),
    ([], {"verticse": 7}, "did you mean vertices"), ([], {"device": "tpu"}, "device"),
    ([], {"report": "a.html"}, "report"),
    ([], {"save_shell": "a.vdb"}, "save_shell"), ([], {"stats": "a.json"}, "stats"),
    ([], {"progress": lambda stage, fraction: None}, "progress"), ([], {"output": "a.ply"}, "output"),
])
def test_arguments_that_cannot_be_are_refused_by_the_call(sources, options, words):
    with pytest.raises(isoshell.Error, match=words) as caught:
        isoshell.remesh_many(sources, **options)
    assert caught.value.code == ErrorCode.USAGE


def test_warnings_of_a_run_come_with_its_result():
    vertices, faces = make_ball()
    flipped = faces.copy()
    flipped[::7] = flipped[::7, ::-1]
    made = isoshell.remesh_many([(vertices, faces), (vertices, flipped)], **SMALL)
    next(made)
    with pytest.warns(isoshell.RunWarning) as caught:
        result = next(made)
    assert [str(w.message) for w in caught] == [w.replace("--", "") for w in result.report["warnings"]]
    assert caught[0].filename == __file__


def thread_count():
    with open("/proc/self/status") as file:
        return int(next(line for line in file if line.startswith("Threads:")).split()[1])


@pytest.mark.parametrize("end", ["close", "let go of", "never begun"])
def test_an_iterator_that_ends_early_stops_its_workers(nefertiti, end):
    list(isoshell.remesh_many([ball_at(0)], workers=1, **SMALL))  # threads of the library that stay
    before = thread_count()
    made = isoshell.remesh_many((ball_at(0) if i == 0 else nefertiti for i in range(20)), workers=12, vertices=3000)
    if end != "never begun":
        next(made)
        assert thread_count() > before
    if end == "close":
        made.close()
    del made
    gc.collect()
    assert thread_count() < before + 12


def test_a_key_interrupts_and_stops_the_workers(nefertiti):
    def run(begun):
        def endless():
            while True:
                yield nefertiti
                begun()

        for _ in isoshell.remesh_many(endless(), vertices=400000):
            pass

    assert_is_interrupted(run)


def test_a_process_that_leaves_an_iterator_behind_ends_in_order(nefertiti):
    code = (f"import isoshell; made = isoshell.remesh_many([{str(nefertiti)!r}] * 9, workers=3, vertices=2000); "
            "print(len(next(made).vertices))")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=FOREVER)
    assert (done.returncode, done.stdout, done.stderr) == (0, "2000\n", "")


def test_warnings_of_files_name_them(tmp_path):
    vertices, faces = make_ball()
    flipped = faces.copy()
    flipped[::7] = flipped[::7, ::-1]
    paths = [write_obj(tmp_path / f"ball{i}.obj", vertices, flipped) for i in range(2)]
    for path in paths:
        with pytest.warns(isoshell.RunWarning) as caught:
            next(isoshell.remesh_many([path], vertices=12, resolution=24))
        assert len(caught) > 1 and all(str(w.message).startswith(str(path)) for w in caught)
