"""Hooks of pytest for all folders of tests: what is skipped is said in the file of ISOSHELL_LEFT_OUT, and a run without
any test fails unless something was skipped."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Tells scripts/test.sh what is left out for want of a tool. A device is none: who has one knows."""
    if file := os.environ.get("ISOSHELL_LEFT_OUT"):
        with open(file, "a") as left_out:
            for report in terminalreporter.getreports("skipped"):
                path, _, reason = report.longrepr
                if "no device: " not in reason:
                    left_out.write(f"tests of {Path(path).name} ({reason.removeprefix('Skipped: ')})\n")


def pytest_sessionfinish(session: pytest.Session, exitstatus: int) -> None:
    """To ctest the status 5 means skipped, but it means no tests, too."""
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if exitstatus == pytest.ExitCode.NO_TESTS_COLLECTED and not reporter.getreports("skipped"):
        session.exitstatus = pytest.ExitCode.TESTS_FAILED
