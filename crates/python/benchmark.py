"""Computing times of calls on this machine, and their ratio to NumPy code with the same result where it exists. Nothing is asserted.

    python crates/python/benchmark.py
"""

import pathlib
import subprocess
import sys
import time

import dwell
import numpy as np

TOP = pathlib.Path(__file__).resolve().parents[2]
SCENE = str(TOP / "validation/single-dwell/scene.toml")


def least(call, rounds=15):
    times = []
    for _ in range(rounds):
        begin = time.perf_counter()
        call()
        times.append(time.perf_counter() - begin)
    return min(times)


def numpy_positions(q):
    """Positions of the four-bar A B C O of the case single-dwell, by array operations of NumPy."""
    b = 0.1 * np.exp(1j * q)
    d = 0.2 - b
    along = np.abs(d) / 2
    return b + d / np.abs(d) * (along + 1j * np.sqrt(0.25**2 - along**2))


def main():
    mechanism = dwell.read(SCENE)
    reduced = mechanism.reduced(["slide.normal"])
    q = np.linspace(0, 2 * np.pi, 100_000)
    one, two = least(lambda: reduced(q, threads=1)), least(lambda: reduced(q))
    positions = least(lambda: numpy_positions(q))
    print(f"reduce, 100 000 positions, m, half dm and one pair: {one * 1e3:.2f} ms on one thread, {two * 1e3:.2f} ms on all")
    print(f"  NumPy, positions of its four-bar alone: {positions * 1e3:.2f} ms; ratio {one / positions:.2f}")
    print(f"one position: {least(lambda: reduced(0.5), 2000) * 1e6:.1f} us")
    print(f"Scene.read, assemble and reduced: {least(lambda: dwell.read(SCENE).reduced(['slide.normal'])) * 1e3:.2f} ms")
    print(f"simulate to 1e-9, all columns: {least(lambda: mechanism.simulate(1e-9), 5) * 1e3:.1f} ms")

    def started(code):
        return least(lambda: subprocess.run([sys.executable, "-c", code], check=True), 7)

    print(f"import beyond NumPy's own: {(started('import numpy, dwell') - started('import numpy')) * 1e3:.0f} ms")
    library = next(pathlib.Path(dwell.__file__).parent.glob("_native*.so"), None)
    if library:
        print(f"the library: {library.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
