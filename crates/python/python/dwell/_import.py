"""Models of other programs."""

from __future__ import annotations

import os
import pathlib
import warnings
from typing import Mapping, Sequence

from . import _native
from ._native import DwellError
from ._scene import Scene


def import_model(
    path: str | os.PathLike[str],
    *,
    drives: Sequence[str] = (),
    key: str | None = None,
    start: Mapping[str, float] | None = None,
    close: Sequence[str] = (),
    loops: str | os.PathLike[str] | None = None,
    fix: str | None = None,
    plane: bool = True,
    tolerance: float | None = None,
    format: str | None = None,
    allow: bool = False,
) -> Scene:
    """The scene of a model of another program: MJCF, URDF, SDF, ASMT, or a file with a link of PMKS+.

    The options are those of ``dwell import``: the joints that drive, the keyframe that is drawn, coordinates of joints as drawn (rad, m),
    joints that close loops (``"FRAME=FRAME:spherical"``), the YAML file of an extended URDF, a floating body that is held, whether a
    mechanism that moves in a plane becomes a planar scene, and how far, in m, its points may be from that plane.

    Comments at the head of ``scene.text`` say what became of each part of the file. If parts are left out on which a motion or a force may
    depend, DwellError names them; with ``allow=True`` they are warnings.
    """
    text, findings = _native.import_model(
        os.fspath(path),
        list(drives),
        list((start or {}).items()),
        list(close),
        format=format,
        key=key,
        loops=None if loops is None else pathlib.Path(loops).read_text(encoding="utf-8"),
        fix=fix,
        plane=plane,
        tolerance=tolerance,
    )
    lost = [finding for finding, is_lost in findings if is_lost]
    if lost and not allow:
        raise DwellError("parts are left out on which a motion or a force may depend; allow=True imports the rest:\n" + "\n".join(lost))
    for finding in lost:
        warnings.warn(finding, stacklevel=2)
    return Scene(text)
