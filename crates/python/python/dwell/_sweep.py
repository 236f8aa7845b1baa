"""Parameter sweeps: many variants of one scene."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Literal, Mapping, Sequence, overload

from . import _native
from ._cluster import StoredSweep, sweep_on
from ._progress import Progress
from ._results import Results

if TYPE_CHECKING:
    from ._scene import Scene


class SweepResults(Results):
    """A row for each variant, NaN where a variant has no such result. ``messages``: by row, the reason if results are missing."""

    messages: list[str | None]


@overload
def sweep(
    scene: Scene,
    vary: Mapping[str, str | Sequence[float]],
    results: Sequence[str] = (),
    *,
    samples: int | None = None,
    seed: int = 0,
    engine: None = None,
    folder: None = None,
) -> SweepResults: ...


@overload
def sweep(
    scene: Scene,
    vary: Mapping[str, str | Sequence[float]],
    results: Sequence[str] = (),
    *,
    samples: int | None = None,
    seed: int = 0,
    engine: Literal["ray", "dask"],
    folder: str | os.PathLike[str],
    blocks: int = 64,
    command: str = "dwell",
) -> StoredSweep: ...


def sweep(
    scene: Scene,
    vary: Mapping[str, str | Sequence[float]],
    results: Sequence[str] = (),
    *,
    samples: int | None = None,
    seed: int = 0,
    engine: Literal["ray", "dask"] | None = None,
    folder: str | os.PathLike[str] | None = None,
    blocks: int = 64,
    command: str = "dwell",
) -> SweepResults | StoredSweep:
    """Results of every combination of numbers of a scene, computed on all cores, as by ``dwell sweep``.

    vary: by path of a number, in the scene's unit: a list of values, or a text: ``=FROM:TO:COUNT``, ``~normal(MEAN,SD)``,
    ``~uniform(FROM,TO)``, ``±TOLERANCE``, ``±PERCENT%``. For random numbers, ``samples`` and ``seed`` give their number and the seed.

    results: ``m.min``, ``m.max``, ``period``, ``phi.actuator_force.max_abs``, ``guide.normal.max_abs`` … (default: all).

    engine: ``"ray"`` or ``"dask"`` distributes the points in ``blocks`` blocks over the engine's workers: those of the connected
    cluster, or processes of this machine. Each runs the ``command`` on one core; the rows go to Parquet files in ``folder``,
    which all workers must reach. The block of a killed worker is repeated. A second call continues where the first stopped.

    Raises SceneError if the sweep is invalid, DwellError if a worker's command fails.
    """

    def text(value: str | Sequence[float]) -> str:
        return value if isinstance(value, str) else "=" + ",".join(repr(float(v)) for v in value)

    varied = [(path, text(value)) for path, value in vary.items()]
    if engine is not None:
        if folder is None:
            raise TypeError("with an engine, the results need a folder: sweep(…, engine=…, folder=…)")
        options = [word for path, value in varied for word in ("--vary", path + value)]
        options += [word for result in results for word in ("--result", result)]
        options += [] if samples is None else ["--samples", str(samples), "--seed", str(seed)]
        return sweep_on(engine, scene.text, options, folder, blocks, command)
    with Progress("sweep") as progress:
        columns, messages = _native.sweep(scene._native, varied, list(results), samples, seed, progress)
    found = SweepResults({name: values for name, _, values in columns}, {name: unit for name, unit, _ in columns})
    found.messages = messages
    return found
