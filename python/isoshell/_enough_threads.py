"""Refuses to be imported where the system gives no threads.

Libraries that the compiled part is linked with start threads when they are loaded, and end the process where they
cannot.
"""

import threading

STARTED_BY_LIBRARIES = 4


def require_threads(count: int) -> None:
    """That many at once."""
    end = threading.Event()
    started = []
    try:
        for _ in range(count):
            thread = threading.Thread(target=end.wait)
            thread.start()
            started.append(thread)
    except RuntimeError as error:
        raise ImportError("isoshell: the system gives no more threads; raise the limit of processes (ulimit -u)"
                          ) from error
    finally:
        end.set()
        for thread in started:
            thread.join()


require_threads(STARTED_BY_LIBRARIES)
