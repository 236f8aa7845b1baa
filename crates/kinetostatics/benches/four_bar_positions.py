"""Positions alone of 1000 four-bars at 200 poses each with NumPy, by the intersection of two circles: the time per
four-bar in microseconds, in a loop over the poses and in one operation over all. A line for each line of input."""

import sys
import time

import numpy as np

DESIGNS, POSES = 1000, 200

random = np.random.default_rng(1)
lengths = np.array([4.0, 1.0, 3.5, 3.0])[:, None] * (1 + 0.02 * random.uniform(-1, 1, (4, DESIGNS)))
angles = np.linspace(0, 2 * np.pi, POSES, endpoint=False)


def positions(frame, crank, coupler, rocker, q):
    x, y = crank * np.cos(q), crank * np.sin(q)
    dx, dy = frame - x, -y
    square = dx * dx + dy * dy
    along = 0.5 * (square + coupler * coupler - rocker * rocker) / square
    across = np.sqrt(coupler * coupler / square - along * along)
    return x, y, x + along * dx - across * dy, y + along * dy + across * dx


def pose_by_pose():
    return np.array([positions(*lengths, q) for q in angles])


def at_once():
    return np.array(positions(*lengths[:, None, :], angles[:, None]))


for line in sys.stdin:
    times = []
    for compute in (pose_by_pose, at_once):
        start = time.perf_counter()
        found = compute()
        times.append((time.perf_counter() - start) / DESIGNS * 1e6)
        x, y = found[:, 2:4].swapaxes(0, 1) if compute is pose_by_pose else found[2:4]
        assert np.allclose((x - lengths[0]) ** 2 + y * y, lengths[3] ** 2)
    print(*times, flush=True)
