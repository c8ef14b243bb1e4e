"""Where runs are done: threads, progress, interruption, memory."""

import gc
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
import warnings
from concurrent.futures import ThreadPoolExecutor

import isoshell
import numpy as np
import pytest
from conftest import FOREVER, assert_is_interrupted, make_ball
from isoshell import ErrorCode

SMALL = {"vertices": 60, "resolution": 24}


def test_a_context_gives_the_same_mesh_run_after_run(ball):
    with isoshell.Context(device="cpu", threads=1, max_memory="4G") as context:
        made = {isoshell.remesh(ball, context=context, **SMALL).digest for _ in range(3)}
    assert made == {isoshell.remesh(ball, **SMALL).digest}


def test_eight_threads_give_the_right_digests(ball):
    shapes = [(ball[0] * (1 + 0.1 * i), ball[1]) for i in range(8)]
    options = [{"vertices": 60 + 10 * i, "resolution": 24} for i in range(8)]
    alone = [isoshell.remesh(s, **o).digest for s, o in zip(shapes, options)]

    def many(i):
        with isoshell.Context(threads=1 + i % 3) as context:
            return {isoshell.remesh(shapes[i], context=context, **options[i]).digest for _ in range(3)}

    with ThreadPoolExecutor(8) as pool:
        assert list(pool.map(many, range(8))) == [{digest} for digest in alone]


def test_a_context_is_used_by_one_run_at_a_time(ball):
    refused = []

    def again(stage, fraction):
        with pytest.raises(isoshell.Error, match="at work") as caught:
            isoshell.remesh(ball, context=context, **SMALL)
        refused.append(caught.value.code)

    with isoshell.Context(progress=again) as context:
        isoshell.remesh(ball, context=context, **SMALL)
    assert refused and set(refused) == {ErrorCode.USAGE}


def test_what_a_context_says_is_not_said_twice(ball):
    with isoshell.Context() as context, pytest.raises(isoshell.Error, match="threads"):
        isoshell.remesh(ball, context=context, threads=2, **SMALL)


@pytest.mark.parametrize("keywords, word", [
    ({"device": "tpu"}, "device"), ({"threads": 0}, "threads"), ({"max_memory": "x"}, "size"),
])
def test_a_context_that_cannot_be_is_refused(keywords, word):
    with pytest.raises(isoshell.Error, match=word):
        isoshell.Context(**keywords)


def test_progress_is_called_by_the_thread_that_asked(ball):
    heard = []

    def progress(stage, fraction):
        heard.append((stage, fraction, threading.get_ident()))

    isoshell.remesh(ball, progress=progress, **SMALL)
    stages = [stage for stage, _, _ in heard]
    assert {"prepare", "relax", "triangulate", "measure"} <= set(stages)
    assert stages.index("prepare") < stages.index("relax") < stages.index("triangulate")
    assert {thread for _, _, thread in heard} == {threading.get_ident()}


def test_progress_is_of_the_whole_run_and_never_goes_back(ball):
    heard = []
    isoshell.remesh(ball, progress=lambda stage, fraction: heard.append(fraction), **SMALL)
    assert heard[0] == 0 and heard[-1] == 1
    assert heard == sorted(heard)
    assert all(isinstance(fraction, isoshell.Progress) for fraction in heard)
    assert all(0 <= fraction.stage_fraction <= 1 and fraction.seconds_left >= 0 for fraction in heard)
    assert heard[-1].seconds_left == 0
    copied = pickle.loads(pickle.dumps(heard[-1]))
    assert copied == heard[-1] and copied.stage_fraction == heard[-1].stage_fraction


def test_progress_of_stages_is_of_all_of_them(ball):
    heard = []
    stages = isoshell.Stages(ball, progress=lambda stage, fraction: heard.append(fraction), **SMALL)
    stages.prepare()
    assert 0 < heard[-1] < 1
    stages.relax()
    stages.triangulate()
    assert heard[0] == 0 and heard[-1] == 1 and heard == sorted(heard)


def test_what_progress_raises_stops_the_run(nefertiti):
    def progress(stage, fraction):
        raise RuntimeError(f"enough of {stage}")

    context = isoshell.Context(progress=progress)
    with pytest.raises(RuntimeError, match="enough of read"):
        isoshell.remesh(nefertiti, context=context)
    context.progress = None
    assert isoshell.remesh(make_ball(), context=context, **SMALL).digest


def test_a_run_is_cancelled_from_another_thread(nefertiti):
    context = isoshell.Context()
    context.progress = lambda stage, fraction: context.cancel() if stage == "prepare" else None
    with pytest.raises(isoshell.Error) as caught:
        isoshell.remesh(nefertiti, context=context, vertices=50000)
    assert caught.value.code == ErrorCode.INTERRUPTED == 130


def test_a_key_interrupts_a_run_in_the_middle(nefertiti):
    stages = set()

    def run(begun):
        def progress(stage, fraction):
            stages.add(stage)
            begun()

        isoshell.remesh(nefertiti, vertices=400000, progress=progress)

    assert_is_interrupted(run)
    assert "measure" not in stages  # it comes after what takes the time
    assert isoshell.remesh(make_ball(), **SMALL).digest


def test_an_interrupted_process_ends_in_order(nefertiti):
    code = (f"import isoshell; isoshell.remesh({str(nefertiti)!r}, vertices=400000, "
            "progress=lambda stage, fraction: print(stage, flush=True))")
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    process.stdout.readline()
    process.send_signal(signal.SIGINT)
    _, text = process.communicate(timeout=FOREVER)
    assert process.returncode in (130, -signal.SIGINT) and "KeyboardInterrupt" in text


def test_other_threads_go_on_while_a_run_works(nefertiti):
    count = [0]
    stop = threading.Event()

    def work():
        while not stop.is_set():
            count[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=work)
    thread.start()
    most = 0
    for _ in range(100):  # as often as a busy machine needs
        before = count[0]
        isoshell.remesh(nefertiti, vertices=500, resolution=96)
        most = max(most, count[0] - before)
        if most > 20:
            break
    stop.set()
    thread.join()
    assert most > 20


def test_warnings_of_a_run_are_warnings_of_python(ball):
    vertices, faces = ball
    flipped = faces.copy()
    flipped[::7] = flipped[::7, ::-1]
    with pytest.warns(isoshell.RunWarning) as caught:
        result = isoshell.remesh((vertices, flipped), **SMALL)
    assert [str(w.message) for w in caught] == [w.replace("--", "") for w in result.report["warnings"]]
    assert caught[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        isoshell.remesh((vertices, flipped), quiet=True, **SMALL)
        with pytest.raises(isoshell.RunWarning):
            isoshell.remesh((vertices, flipped), **SMALL)


def resident_kib():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE") // 1024


def test_memory_stays_flat_over_many_runs(ball):
    tiny = {"vertices": 20, "resolution": 16}
    volume = isoshell.Volume(np.linalg.norm(np.indices((12, 12, 12)) - 5.5, axis=0).astype(np.float32) - 4)

    def runs(count):
        for _ in range(count):
            isoshell.remesh(ball, **tiny).report["counts"]
            isoshell.remesh(volume, **tiny)
            with pytest.raises(isoshell.Error):
                isoshell.remesh((ball[0], ball[1] + 1000), **tiny)
        gc.collect()

    runs(20)
    before = resident_kib()
    runs(int(os.environ.get("ISOSHELL_TEST_RUNS", 100)))
    assert resident_kib() - before < 4096


def test_a_warning_reaches_a_program_that_calls_from_a_function(tmp_path):
    program = tmp_path / "program.py"
    program.write_text("from isoshell._errors import warn\ndef call():\n    warn('look')\ncall()\n")
    done = subprocess.run([sys.executable, program], capture_output=True, text=True)
    assert done.returncode == 0 and f"{program}:3: RunWarning: look" in done.stderr


@pytest.mark.parametrize("form", ["ply", "obj", "glb"])
def test_a_source_that_never_ends_is_refused_at_the_limit_of_memory(form):
    with pytest.raises(isoshell.Error, match="raise max_memory, or split the file") as refused:
        isoshell.remesh("/dev/zero", input_format=form, max_memory="64M")
    assert refused.value.code == ErrorCode.OUT_OF_MEMORY


def test_a_small_stack_of_the_process_is_enough(tmp_path):
    script = tmp_path / "small_stack.py"
    script.write_text("import isoshell, numpy as np\n"
                      "corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.]])\n"
                      "faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])\n"
                      "result, = isoshell.remesh_many([(corners, faces)], vertices=60)\n"
                      "print(len(result.vertices), len(isoshell.remesh((corners, faces), vertices=60).vertices))\n")
    run = subprocess.run(["sh", "-c", f"ulimit -s 128; exec '{sys.executable}' '{script}'"], capture_output=True,
                         text=True)
    assert run.returncode == 0, run.stderr
    assert run.stdout.split() == ["60", "60"]


def test_where_the_system_gives_no_threads_the_import_says_so(tmp_path):
    script = tmp_path / "no_threads.py"
    script.write_text("import os, resource\n"
                      "from isoshell._enough_threads import STARTED_BY_LIBRARIES, require_threads\n"
                      "if os.geteuid() == 0:  # the limit does not hold for the superuser\n"
                      "    os.setuid(65534)\n"
                      "resource.setrlimit(resource.RLIMIT_NPROC, (1, 1))\n"
                      "require_threads(STARTED_BY_LIBRARIES)\n")
    run = subprocess.run([sys.executable, script], capture_output=True, text=True)
    assert run.returncode == 1 and "ImportError: isoshell: the system gives no more threads" in run.stderr, run.stderr
