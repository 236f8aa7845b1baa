"""The progress of long computations, on standard error."""

from __future__ import annotations

import sys
import time
import warnings
from types import TracebackType
from typing import Any

#: Delay before the progress is shown, s.
SILENT = 2.0


class Progress:
    """Called during a computation with the number of completed steps, and of all steps (0 if unknown).

    After two seconds it shows a bar by tqdm, or a line if tqdm is not installed; only in a terminal or a notebook.
    """

    def __init__(self, name: str) -> None:
        self._name, self._begin = name, time.monotonic()
        self._bar: Any = None
        self._is_seen = "ipykernel" in sys.modules or sys.stderr.isatty()

    def __call__(self, done: int, of: int) -> None:
        if not self._is_seen or time.monotonic() - self._begin < SILENT:
            return
        if self._bar is None:
            bar = self._tqdm(of)
            self._bar = _Line(self._name) if bar is None else bar
        self._bar.total, self._bar.n = of or None, done
        self._bar.refresh()

    def _tqdm(self, of: int) -> Any:
        try:
            with warnings.catch_warnings():
                # In a notebook without widgets tqdm shows text and issues a warning.
                warnings.simplefilter("ignore")
                from tqdm.auto import tqdm
        except ImportError:
            return None
        shown = "{l_bar}{bar}| {n_fmt}/{total_fmt} [{elapsed}<{remaining}]" if of else "{desc}: {elapsed}"
        bar = tqdm(total=of or None, desc=self._name, leave=False, bar_format=shown, file=sys.stderr, disable=False)
        bar.start_t -= time.monotonic() - self._begin
        return bar

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self._bar is not None:
            self._bar.close()


class _Line:
    """A line that overwrites itself."""

    def __init__(self, name: str) -> None:
        self._name, self._begin = name, time.monotonic() - SILENT
        self.n, self.total, self._width = 0, None, 0

    def refresh(self) -> None:
        part = f"{100 * self.n // self.total} %, " if self.total else ""
        text = f"{self._name}: {part}{time.monotonic() - self._begin:.0f} s"
        self._width = max(self._width, len(text))
        print(f"\r{text:<{self._width}}", end="", file=sys.stderr, flush=True)

    def close(self) -> None:
        print(f"\r{'':<{self._width}}\r", end="", file=sys.stderr, flush=True)
