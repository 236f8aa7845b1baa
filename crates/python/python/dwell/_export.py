"""Machines as code."""

from __future__ import annotations

import os
import pathlib

from . import _native

#: The targets of ``Scene.export``.
EXPORT_TARGETS = ("c", "exact-c", "rust", "matlab", "fmu", "exact-fmu", "fmu2", "exact-fmu2")


def write_export(
    scene: _native.Scene, target: str, folder: str | os.PathLike[str], accuracy: float
) -> list[pathlib.Path]:
    """Writes the files of a target, and returns them."""
    if target not in EXPORT_TARGETS:
        raise ValueError(f"there is no target {target!r}: there are {', '.join(map(repr, EXPORT_TARGETS))}")
    written = []
    for name, content in scene.export(target, accuracy):
        path = pathlib.Path(folder) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
        written.append(path)
    return written
