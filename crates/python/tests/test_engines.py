"""Sweeps that Dask and Ray distribute over processes of this machine; the tests kill some of the processes."""

import os
import pathlib
import signal
import sys
import threading
import time

import numpy as np
import pytest

import dwell

TOP = pathlib.Path(__file__).resolve().parents[3]
VARY = {"crank.inertia": "=0.5:0.7:1000", "coupler.mass": "=1:2:400"}
RESULTS = ["m.max", "period"]
BLOCKS = 7
#: The nightly run sets `DWELL_POINTS=1000000`.
POINTS = int(os.environ.get("DWELL_POINTS", 400_000))


@pytest.fixture(scope="module")
def program():
    command = pathlib.Path(os.environ.get("DWELL_COMMAND", TOP / "target/release/dwell"))
    if not command.exists():
        pytest.skip("the command is not built: cargo build --release -p dwell-cli")
    return str(command)


@pytest.fixture(scope="module")
def study():
    scene = dwell.Scene.read(str(TOP / "validation/single-dwell/scene.toml"))
    return scene, {**VARY, "coupler.mass": f"=1:2:{POINTS // 1000}"}


@pytest.fixture(scope="module")
def single(program, study, tmp_path_factory):
    """The rows of a run of the command without workers, and its time, s."""
    from dwell._cluster import _Study

    scene, vary = study
    folder = tmp_path_factory.mktemp("single")
    options = [word for path, value in vary.items() for word in ("--vary", path + value)]
    options += [word for result in RESULTS for word in ("--result", result)]
    begin = time.monotonic()
    study = _Study(program, tuple(options), str(folder))
    study.scene.write_text(scene.text, encoding="utf-8")
    study.run()
    return folder / "study-sweep", time.monotonic() - begin


def kill_after_first_part(folder, pids, killed):
    """Kills processes after the first rows are written."""
    while not list(folder.glob("study-sweep/part-*.parquet")):
        time.sleep(0.02)
    for pid in pids:
        os.kill(pid, signal.SIGKILL)
        killed.append(pid)


def run(engine, program, study, folder, pids):
    scene, vary = study
    killed = []
    killer = threading.Thread(target=kill_after_first_part, args=(folder, pids, killed), daemon=True)
    killer.start()
    begin = time.monotonic()
    stored = dwell.sweep(scene, vary, RESULTS, engine=engine, folder=folder, blocks=BLOCKS, command=program)
    seconds = time.monotonic() - begin
    assert killed == list(pids), "the processes were not killed on the way"
    return stored, seconds


def compare(stored, single):
    """Every row occurs once and equals that of the single run."""
    folder, alone = single
    found, expected = [dwell.StoredSweep(f, {}).to_pandas().sort_values("index") for f in (stored.folder, folder)]
    assert len(found) == POINTS == stored.rows
    assert np.array_equal(found["index"], np.arange(POINTS))
    for column in expected.columns:
        assert found[column].equals(expected[column].set_axis(found.index)), column
    lazy = stored.to_polars() if "polars" in sys.modules else None
    if lazy is not None:
        assert lazy.select("index").collect().height == POINTS


def test_dask_loses_and_doubles_no_row(program, study, single, tmp_path):
    distributed = pytest.importorskip("distributed")
    pytest.importorskip("pyarrow")
    with distributed.LocalCluster(n_workers=4, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            pids = list(client.run(os.getpid).values())[:2]
            stored, seconds = run("dask", program, study, tmp_path, pids)
    compare(stored, single)
    print(f"\nDask: {seconds:.1f} s with two of four workers killed; the command alone: {single[1]:.1f} s")


def test_ray_loses_and_doubles_no_row(program, study, single, tmp_path):
    ray = pytest.importorskip("ray")
    pytest.importorskip("pyarrow")
    ray.init(num_cpus=4, include_dashboard=False, log_to_driver=False)
    try:
        pid = ray.remote(num_cpus=1)(lambda: (time.sleep(0.5), os.getpid())[1])
        pids = sorted(set(ray.get([pid.remote() for _ in range(4)])))[:2]
        stored, seconds = run("ray", program, study, tmp_path, pids)
    finally:
        ray.shutdown()
    compare(stored, single)
    print(f"\nRay: {seconds:.1f} s with two of four workers killed; the command alone: {single[1]:.1f} s")


def test_what_a_worker_says_is_raised(program, study, tmp_path):
    pytest.importorskip("distributed")
    scene, _ = study
    with pytest.raises(dwell.DwellError, match="coupler.masss"):
        dwell.sweep(scene, {"coupler.masss": "=1:2:3"}, engine="dask", folder=tmp_path, blocks=2, command=program)
    with pytest.raises(dwell.DwellError, match="cannot be run"):
        dwell.sweep(scene, VARY, engine="dask", folder=tmp_path, blocks=2, command="no-such-dwell")


def test_careless_calls(study, tmp_path):
    scene, _ = study
    with pytest.raises(TypeError, match="folder"):
        dwell.sweep(scene, VARY, engine="dask")
    with pytest.raises(ValueError, match="no engine `spark`"):
        dwell.sweep(scene, VARY, engine="spark", folder=tmp_path)
    with pytest.raises(ValueError, match="blocks"):
        dwell.sweep(scene, VARY, engine="ray", folder=tmp_path, blocks=0)
