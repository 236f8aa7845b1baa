"""Pictures with matplotlib, if it is installed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, Sequence

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from ._results import Results

Array = npt.NDArray[np.float64]

#: Colours of the bodies, distinct for the colour-blind too (Okabe and Ito 2008).
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c564b"]
GROUND = "#555555"


class _Titled(Protocol):
    @property
    def title(self) -> str: ...


class _Placed(Protocol):
    def position(self, point: str) -> Array: ...


class Drawn(Protocol):
    """The interface of a drawn mechanism, in the plane or in space."""

    @property
    def scene(self) -> _Titled: ...
    @property
    def actuators(self) -> list[str]: ...
    @property
    def limits(self) -> tuple[float, float] | None: ...
    @property
    def points(self) -> dict[str, list[str]]: ...
    @property
    def start(self) -> Array: ...
    def at(self, q: float | Sequence[float]) -> _Placed: ...


def places(mechanism: Drawn, q: float | Sequence[float] | Array | None) -> dict[str, dict[str, Array]]:
    """The positions of the points of each body at coordinates q (default: at assembly), m."""
    state = mechanism.at(mechanism.start if q is None else q)  # type: ignore[arg-type]
    return {
        body: {point: state.position(f"{body}.{point}") for point in points} for body, points in mechanism.points.items()
    }


def hull(points: Array) -> Array:
    """The corners of the convex hull in order (Andrew 1979): one or two points are returned unchanged."""
    ordered = sorted({(float(x), float(y)) for x, y in points})
    if len(ordered) < 3:
        return np.array(ordered)

    def half(row: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
        corners: list[tuple[float, float]] = []
        for p in row:
            while len(corners) > 1:
                (ax, ay), (bx, by) = corners[-2], corners[-1]
                if (bx - ax) * (p[1] - ay) - (by - ay) * (p[0] - ax) > 0:
                    break
                corners.pop()
            corners.append(p)
        return corners[:-1]

    return np.array(half(ordered) + half(ordered[::-1]))


def pins(bodies: dict[str, dict[str, Array]]) -> list[tuple[Array, bool]]:
    """Positions at which points of two bodies coincide, and whether one of the bodies is the ground."""
    every = [(body, at) for body, points in bodies.items() for at in points.values()]
    size = np.ptp(np.array([at for _, at in every]), axis=0).max() if every else 0.0
    found: list[tuple[Array, bool]] = []
    for k, (body, at) in enumerate(every):
        meeting = [other for other, there in every[k + 1 :] if other != body and np.linalg.norm(there - at) < 1e-6 * size]
        if meeting and not any(np.linalg.norm(there - at) < 1e-6 * size for there, _ in found):
            found.append((at, "ground" in (body, *meeting)))
    return found


def _pyplot() -> Any:
    try:
        import matplotlib.pyplot as pyplot
    except ImportError:
        raise ImportError("pictures need matplotlib: pip install 'dwell[plot]'") from None
    return pyplot


def plot_mechanism(mechanism: Drawn, q: float | Sequence[float] | None, axes: Any = None, labels: bool = True) -> Any:
    """Draws the mechanism into matplotlib axes (default: new ones), and returns them. In space they are axes of three dimensions."""
    bodies = places(mechanism, q)
    moving = [(body, np.array(list(points.values()))) for body, points in bodies.items() if body != "ground" and points]
    size = next((len(at) for points in bodies.values() for at in points.values()), 2)
    if axes is None:
        _, axes = _pyplot().subplots(layout="constrained", subplot_kw={"projection": "3d"} if size == 3 else None)
    for k, (body, points) in enumerate(moving):
        colour = COLOURS[k % len(COLOURS)]
        outline = _outline(points)
        axes.plot(*outline.T, color=colour, linewidth=3, solid_capstyle="round", label=body if labels else None)
        if len(points) == 1:
            axes.plot(*outline.T, marker="s", markersize=14, color=colour, alpha=0.4)
        if len(outline) > 3 and size == 2:
            axes.fill(*outline.T, color=colour, alpha=0.15)
    for point, is_ground in pins(bodies):
        at = [[value] for value in point]
        if is_ground:
            axes.plot(*at, marker=6, markersize=16, color=GROUND, clip_on=False)
        axes.plot(*at, marker="o", markersize=6, markerfacecolor="white", markeredgecolor="#222222")
    axes.set_aspect("equal")
    axes.margins(0.1)
    axes.set_xlabel("x (m)")
    axes.set_ylabel("y (m)")
    if size == 3:
        axes.set_zlabel("z (m)")
        axes.xaxis.labelpad = axes.yaxis.labelpad = 10
        # As many numbers as fit on a short axis.
        extents = np.ptp([at for points in bodies.values() for at in points.values()], axis=0)
        for name, extent in zip("xyz", extents):
            axes.locator_params(axis=name, nbins=max(1, round(6 * extent / max(extents.max(), 1e-9))))
    axes.set_title(mechanism.scene.title)
    if labels:
        axes.legend(frameon=False, loc="center left", bbox_to_anchor=(1.15 if size == 3 else 1.0, 0.5))
    return axes


def _outline(points: Array) -> Array:
    """The outline of a body: in the plane around its points, in space from each of its points to the next."""
    corners = hull(points) if points.shape[1] == 2 else points
    return np.vstack([corners, corners[:1]])


def animate_mechanism(mechanism: Drawn, motion: Results | None, frames: int, interval: float) -> Any:
    """An animation over a motion, or over the range of the only coordinate."""
    pyplot = _pyplot()
    from matplotlib.animation import FuncAnimation

    if motion is not None:
        rows = np.linspace(0, motion.rows - 1, min(frames, motion.rows)).astype(int)
        coordinates = np.array([motion[name][rows] for name in mechanism.actuators]).T
    else:
        low, high = mechanism.limits or (mechanism.start[0], mechanism.start[0] + 2 * np.pi)
        # The mechanism is singular at the limits themselves.
        inset = 0.0 if mechanism.limits is None else 1e-3 * (high - low)
        coordinates = np.linspace(low + inset, high - inset, frames)[:, None]
    corners = [
        at
        for q in coordinates[:: max(1, len(coordinates) // 24)]
        for points in places(mechanism, q).values()
        for at in points.values()
    ]
    low_corner, high_corner = np.min(corners, axis=0), np.max(corners, axis=0)
    is_spatial = len(low_corner) == 3
    figure, axes = pyplot.subplots(layout="constrained", subplot_kw={"projection": "3d"} if is_spatial else None)
    margin = 0.08 * max(high_corner - low_corner)

    def draw(frame: int) -> list[Any]:
        axes.clear()
        plot_mechanism(mechanism, coordinates[frame], axes, labels=False)
        for set_limits, low, high in zip(
            [axes.set_xlim, axes.set_ylim, *([axes.set_zlim] if is_spatial else [])], low_corner - margin, high_corner + margin
        ):
            set_limits(low, high)
        if is_spatial:
            axes.set_aspect("equal")
        return [axes]

    return FuncAnimation(figure, draw, frames=len(coordinates), interval=interval, blit=False)


def plot_columns(results: Results, names: Sequence[str], x: str) -> Any:
    """Plots columns over another column, with one axis for each unit."""
    chosen = list(names) or [name for name in results if name != x][:1]
    units = list(dict.fromkeys(results.units[name] for name in chosen if results[name] is not None))
    figure, all_axes = _pyplot().subplots(len(units), sharex=True, squeeze=False, layout="constrained")
    for axes, unit in zip(all_axes[:, 0], units):
        for name in chosen:
            if results.units[name] == unit:
                axes.plot(results[x], results[name], label=name)
        axes.set_ylabel(f"({unit})" if unit else "")
        axes.legend(frameon=False)
    all_axes[-1, 0].set_xlabel(f"{x} ({results.units[x]})")
    return all_axes[:, 0]
