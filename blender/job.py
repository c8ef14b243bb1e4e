# SPDX-License-Identifier: Apache-2.0
"""A run on a thread of its own, which nothing of Blender is touched by."""

import threading
import warnings


class Job:
    """Works on a function of a context; `work(context)` gives what `result` returns."""

    def __init__(self, work, device):
        import isoshell  # takes a moment, which the start of Blender is spared

        warnings.filterwarnings("ignore", category=isoshell.RunWarning)  # the report has them, too
        self._interrupted = isoshell.ErrorCode.INTERRUPTED
        self._context = isoshell.Context(device=device, progress=self._hear)
        self._work = work
        self._thread = threading.Thread(target=self._run, name="isoshell")
        self._made = self._error = None
        self._cancelled = False
        self.stage, self.fraction = "", 0.0

    def start(self):
        self._thread.start()
        return self

    def cancel(self):
        """Asks the run to stop; it is done soon after."""
        self._cancelled = True
        self._context.cancel()

    @property
    def is_done(self):
        return not self._thread.is_alive()

    def wait(self):
        """What interrupts the wait, such as Ctrl-C, stops the run."""
        try:
            self._thread.join()
        except BaseException:
            self.cancel()
            self._thread.join()
            raise
        return self

    def result(self):
        """What the work made; None when it was cancelled. Raises what the work raised."""
        self._context.close()
        if self._error is None and not self._cancelled:
            return self._made
        if self._cancelled or getattr(self._error, "code", None) == self._interrupted:
            return None
        raise self._error

    def _hear(self, stage, fraction):
        """By the run; a cancel between two runs of the work is heard here."""
        self.stage, self.fraction = stage, fraction
        if self._cancelled:
            self._context.cancel()

    def _run(self):
        try:
            self._made = self._work(self._context)
        except BaseException as error:  # whatever it is, the thread that waits raises it
            self._error = error
