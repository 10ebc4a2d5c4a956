"""How far a fleet is, on standard error."""

from __future__ import annotations

import sys
import time

#: From line to line off a terminal [s].
_LINES = 10.0
#: From one look to the next on a terminal [s].
_LOOK = 0.2


class Lines:
    """On a terminal one line that is written over itself, else a line now and every ten seconds."""

    def __init__(self, shown: bool) -> None:
        self.shown = shown
        self.since = time.monotonic()
        self.next = 0.0
        if shown and not sys.stderr.isatty():
            print("looking for logs", file=sys.stderr, flush=True)

    def __call__(self, done: int, all_: int) -> None:
        elapsed = time.monotonic() - self.since
        if done == 0:
            self.since, elapsed, self.next = time.monotonic(), 0.0, 0.0
        if not self.shown or (elapsed < self.next and done < all_):
            return
        terminal = sys.stderr.isatty()
        self.next = elapsed + (_LOOK if terminal else _LINES)
        text = f"{done} of {all_} logs"
        if 0 < done < all_:
            text += f", {_duration((all_ - done) * elapsed / done)} left"
        end = "\n" if done == all_ or not terminal else ""
        start = "\r\x1b[K" if terminal else ""
        print(f"{start}{text}", end=end, file=sys.stderr, flush=True)


def _duration(seconds: float) -> str:
    if seconds < 100:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 6000 else f"{seconds / 3600:.1f} h"
