"""Parameter sweeps: many variants of one scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, Mapping, Sequence

from . import _native
from ._results import Results

if TYPE_CHECKING:
    from ._scene import Scene


class SweepResults(Results):
    """A row for each variant, NaN where a variant has no such result. ``messages``: by row, why results are missing."""

    messages: list[str | None]


def sweep(
    scene: Scene,
    vary: Mapping[str, str | Sequence[float]],
    results: Sequence[str] = (),
    *,
    samples: int | None = None,
    seed: int = 0,
) -> SweepResults:
    """Results of every combination of numbers of a scene, computed on all cores, as ``dwell sweep`` computes them.

    vary: by path of a number, in the scene's unit: a list of values, or a text: ``=FROM:TO:COUNT``, ``~normal(MEAN,SD)``,
    ``~uniform(FROM,TO)``, ``±TOLERANCE``, ``±PERCENT%``. With random numbers ``samples`` and ``seed`` say how many and which.

    results: ``m.min``, ``m.max``, ``period``, ``phi.actuator_force.max_abs``, ``guide.normal.max_abs`` …; without any, all.

    Raises SceneError where the sweep is not valid.
    """

    def text(value: str | Sequence[float]) -> str:
        return value if isinstance(value, str) else "=" + ",".join(repr(float(v)) for v in value)

    varied = [(path, text(value)) for path, value in vary.items()]
    columns, messages = _native.sweep(scene._native, varied, list(results), samples, seed)
    found = SweepResults({name: values for name, _, values in columns}, {name: unit for name, unit, _ in columns})
    found.messages = messages
    return found
