"""The run beside Blender: progress, Esc, errors. No window is there, so events are made here."""

import time
from types import SimpleNamespace

import pytest


class Watcher:
    """What a modal operator has of a window."""

    def __init__(self):
        self.shown, self.texts, self.timers = [], [], 0
        self.window = object()
        self.workspace = SimpleNamespace(status_text_set=self.texts.append)
        self.window_manager = SimpleNamespace(
            event_timer_add=self.add, event_timer_remove=self.remove, progress_begin=lambda low, high: None,
            progress_update=self.shown.append, progress_end=lambda: None, modal_handler_add=lambda operator: None)

    def add(self, _interval, window):
        self.timers += 1

    def remove(self, _timer):
        self.timers -= 1


@pytest.fixture
def operator(extension, monkeypatch):
    import isoshell
    from bl_ext.user_default.isoshell import operators

    class Operator(operators.Run):
        device = "cpu"

        def __init__(self):
            self.reports, self.made = [], None

        def work(self, _context):
            return lambda context: isoshell.remesh(self.source, context=context, vertices=self.vertices)

        def put(self, _context, made):
            self.made = made
            return ["a note"]

        def report(self, kind, text):
            self.reports.append((*kind, text))

    monkeypatch.setattr(operators, "bpy", SimpleNamespace(app=SimpleNamespace(background=False)))
    return Operator()


def box(subdivisions):
    import numpy as np

    n = subdivisions
    vertices = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)], float) * n
    quads = np.array([(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])
    return vertices, quads


def run(operator, context, event="TIMER"):
    while (state := operator.modal(context, SimpleNamespace(type=event))) == {"RUNNING_MODAL"}:
        time.sleep(0.01)
        event = "TIMER"
    return state


def test_progress_is_shown_and_the_result_is_put_back(operator):
    operator.source, operator.vertices = box(1), 2000
    context = Watcher()
    assert operator.invoke(context, None) == {"RUNNING_MODAL"}
    assert run(operator, context) == {"FINISHED"}
    assert len(operator.made.vertices) == 2000 and operator.reports == [("WARNING", "isoshell: a note")]
    assert any(text and "Esc" in text for text in context.texts) and context.texts[-1] is None
    assert len(context.shown) > 0 and context.timers == 0


def test_esc_ends_the_run_and_nothing_is_put_back(operator):
    operator.source, operator.vertices = box(1), 500_000
    context = Watcher()
    operator.invoke(context, None)
    while operator._job.stage != "prepare":
        time.sleep(0.01)
    assert run(operator, context, "ESC") == {"CANCELLED"}
    assert operator._job.stage in ("prepare", "relax")  # the whole run takes minutes, and more of them then
    assert operator.made is None and "cancelled" in operator.reports[-1][1] and context.timers == 0


def test_an_error_of_the_run_is_reported(operator):
    operator.source, operator.vertices = (box(1)[0] * float("nan"), box(1)[1]), 500
    context = Watcher()
    operator.invoke(context, None)
    assert run(operator, context) == {"CANCELLED"}
    assert operator.reports[-1][0] == "ERROR" and context.timers == 0
