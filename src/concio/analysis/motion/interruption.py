"""Ctrl-C in a long computation: asked for once, it is granted between two steps, so that nothing is half kept."""

from __future__ import annotations

import signal
import threading
from types import FrameType, TracebackType


class Interruption:
    """Within it the first Ctrl-C is noted, the second one stops the program as always.

    Outside the main thread, and where somebody else listens to the signal, nothing is changed.
    """

    def __init__(self) -> None:
        self.wanted = False
        self._listens = False

    def __enter__(self) -> Interruption:
        main = threading.current_thread() is threading.main_thread()
        if main and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, self._note)
            self._listens = True
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._let_go()

    def _note(self, number: int, frame: FrameType | None) -> None:
        self.wanted = True
        self._let_go()

    def _let_go(self) -> None:
        if self._listens:
            signal.signal(signal.SIGINT, signal.default_int_handler)
            self._listens = False
