"""Sweeps on a cluster: a study's numbered points in blocks that Ray or Dask spreads over its workers.

A block is a shard of ``dwell sweep``: its points follow from the study, and its rows are Parquet files that are written
under temporary names and renamed when they are complete. The block of a killed worker therefore continues without missing or repeated rows.
"""

from __future__ import annotations

import json
import os
import pathlib
import shutil
import subprocess
from dataclasses import dataclass
from typing import Any, Callable, Sequence

from ._native import DwellError
from ._progress import Progress

#: Maximum number of repetitions of a block on another worker.
RETRIES = 5


@dataclass(frozen=True)
class StoredSweep:
    """A sweep in a folder of Parquet files. ``summary`` is the summary of ``dwell sweep``: extremes, means, failed points."""

    folder: pathlib.Path
    summary: dict[str, Any]

    @property
    def rows(self) -> int:
        """Number of rows in the files."""
        return int(self.summary["results"]["rows"]["value"])

    @property
    def files(self) -> list[pathlib.Path]:
        """The files in the order of their points."""
        return sorted(self.folder.glob("part-*.parquet"))

    def to_pandas(self, columns: Sequence[str] | None = None) -> Any:
        """A pandas DataFrame of some columns, named as ``m.max [kg m2]``, or of all."""
        import pandas

        return pandas.read_parquet(self.folder, columns=list(columns) if columns is not None else None)

    def to_polars(self) -> Any:
        """A polars LazyFrame, which reads only what a query needs."""
        import polars

        return polars.scan_parquet(f"{self.folder}/part-*.parquet")


@dataclass(frozen=True)
class _Study:
    """The arguments of every worker."""

    command: str
    options: tuple[str, ...]
    folder: str

    @property
    def scene(self) -> pathlib.Path:
        """The scene file beside the results, with the same base name."""
        return pathlib.Path(self.folder) / "study.toml"

    def run(self, *shard: str, threads: int | None = None) -> None:
        arguments = [self.command, "sweep", str(self.scene), *self.options]
        arguments += ["--out", self.folder, "--pictures", "none", *shard]
        environment = {**os.environ, "NO_COLOR": "1"}
        if threads is not None:
            environment["RAYON_NUM_THREADS"] = str(threads)
        try:
            done = subprocess.run(arguments, capture_output=True, text=True, env=environment)
        except OSError as error:
            where = f"`{self.command}` cannot be run on this worker: {error}"
            raise DwellError(f"{where}; install the command there, or give its path as `command`") from None
        if done.returncode != 0:
            raise DwellError(f"\n{done.stderr.strip()}")


def _block(study: _Study, number: int, of: int) -> int:
    """Computes a block on one core of a worker."""
    study.run("--shard", f"{number}/{of}", threads=1)
    return number


def _by_ray(study: _Study, blocks: int, progress: Progress) -> None:
    import ray

    if not ray.is_initialized():
        ray.init(log_to_driver=False, include_dashboard=False)
    # A block of a crashed worker is repeated; an error of the command is not.
    task = ray.remote(max_retries=RETRIES)(_block)
    pending = [task.remote(study, k, blocks) for k in range(1, blocks + 1)]
    while pending:
        done, pending = ray.wait(pending, timeout=0.5)
        ray.get(done)
        progress(blocks - len(pending), blocks)


def _by_dask(study: _Study, blocks: int, progress: Progress) -> None:
    import distributed

    # The functions of Dask have no type annotations.
    dask: Any = distributed
    try:
        client, own = dask.get_client(), False
    except ValueError:
        try:
            client, own = dask.Client(threads_per_worker=1), True
        except RuntimeError as error:
            # Its workers import the script again, and would start workers themselves.
            needed = 'Dask cannot start its workers: put what a script runs under `if __name__ == "__main__":`'
            raise RuntimeError(needed) from error
    try:
        tasks = [client.submit(_block, study, k, blocks, pure=False) for k in range(1, blocks + 1)]
        for done, task in enumerate(dask.as_completed(tasks), 1):
            task.result()
            progress(done, blocks)
    finally:
        if own:
            client.close()


ENGINES: dict[str, Callable[[_Study, int, Progress], None]] = {"ray": _by_ray, "dask": _by_dask}


def sweep_on(
    engine: str, scene: str, options: Sequence[str], folder: str | os.PathLike[str], blocks: int, command: str
) -> StoredSweep:
    """Spreads a study over an engine's workers, then checks and summarises all rows here."""
    if engine not in ENGINES:
        raise ValueError(f"there is no engine `{engine}`: there are {' and '.join(f'`{name}`' for name in ENGINES)}")
    if blocks < 1:
        raise ValueError("blocks must be at least 1")
    place = pathlib.Path(folder).resolve()
    study = _Study(shutil.which(command) or command, tuple(options), str(place))
    place.mkdir(parents=True, exist_ok=True)
    study.scene.write_text(scene, encoding="utf-8")
    with Progress("sweep") as progress:
        ENGINES[engine](study, blocks, progress)
    # All points exist: this computes nothing, merges the files of the blocks, checks every file and finds the extremes.
    study.run()
    summary = json.loads((place / "study-sweep.json").read_text(encoding="utf-8"))
    for left in place.glob(f"study-sweep-*-of-{blocks}.json"):
        left.unlink()
    return StoredSweep(place / "study-sweep", summary)
