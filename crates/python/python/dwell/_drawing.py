"""Pictures: a mechanism as SVG, and with matplotlib where it is installed."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any, Protocol, Sequence

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from ._results import Results

Array = npt.NDArray[np.float64]

#: Colours of the bodies, distinct for the colour-blind too (Okabe and Ito 2008).
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c564b"]
GROUND = "#555555"

# What a picture of a mechanism in space is seen along: 60° to the right of the y-axis and 30° from above, as matplotlib shows it.
_AZIMUTH, _ELEVATION = np.radians(-60.0), np.radians(30.0)
RIGHT = np.array([-np.sin(_AZIMUTH), np.cos(_AZIMUTH), 0.0])
UP = np.array([-np.sin(_ELEVATION) * np.cos(_AZIMUTH), -np.sin(_ELEVATION) * np.sin(_AZIMUTH), np.cos(_ELEVATION)])


class _Titled(Protocol):
    @property
    def title(self) -> str: ...


class _Placed(Protocol):
    def position(self, point: str) -> Array: ...


class Drawn(Protocol):
    """What a picture needs of a mechanism, in the plane or in space."""

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
    """By body, where its points are at coordinates q; absent, at assembly."""
    state = mechanism.at(mechanism.start if q is None else q)  # type: ignore[arg-type]
    return {
        body: {point: state.position(f"{body}.{point}") for point in points} for body, points in mechanism.points.items()
    }


def seen(bodies: dict[str, dict[str, Array]]) -> dict[str, dict[str, Array]]:
    """The same on paper: as they are in the plane, and in space by parallel projection."""
    projection = np.array([RIGHT, UP])
    return {
        body: {point: at if len(at) == 2 else projection @ at for point, at in points.items()}
        for body, points in bodies.items()
    }


def hull(points: Array) -> Array:
    """The corners of the convex hull in order (Andrew 1979): one or two points are their own."""
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
    """Where points of two bodies meet, and whether one of them is the ground's."""
    every = [(body, at) for body, points in bodies.items() for at in points.values()]
    size = np.ptp(np.array([at for _, at in every]), axis=0).max() if every else 0.0
    found: list[tuple[Array, bool]] = []
    for k, (body, at) in enumerate(every):
        meeting = [other for other, there in every[k + 1 :] if other != body and np.linalg.norm(there - at) < 1e-6 * size]
        if meeting and not any(np.linalg.norm(there - at) < 1e-6 * size for there, _ in found):
            found.append((at, "ground" in (body, *meeting)))
    return found


def svg(mechanism: Drawn, q: float | Sequence[float] | None = None, width: int = 420) -> str:
    """The mechanism as SVG: bodies as lines or areas, pins as circles, the ground hatched."""
    placed = places(mechanism, q)
    bodies = seen(placed)
    is_spatial = any(len(at) == 3 for points in placed.values() for at in points.values())
    all_points = np.array([at for points in bodies.values() for at in points.values()])
    low, high = all_points.min(axis=0), all_points.max(axis=0)
    extent = np.maximum(high - low, 1e-9 + 0.25 * (high - low).max())
    center, scale = (low + high) / 2, (width - 90) / extent[0]
    height = min(extent[1] * scale + 90, 1.5 * width)
    scale = min(scale, (height - 90) / extent[1])

    def at(point: Array) -> tuple[float, float]:
        x, y = (point - center) * scale
        return round(width / 2 + x, 2), round(height / 2 - y, 2)

    parts: list[str] = []
    names: list[tuple[str, str]] = []
    for k, (body, points) in enumerate((b, p) for b, p in bodies.items() if b != "ground" and p):
        corners = [at(p) for p in hull(np.array(list(points.values())))]
        colour = COLOURS[k % len(COLOURS)]
        text = " ".join(f"{x},{y}" for x, y in corners)
        fill = f' fill="{colour}" fill-opacity="0.15"' if len(corners) > 2 else ' fill="none"'
        if len(corners) == 1:
            (x, y) = corners[0]
            parts.append(
                f'<rect x="{x - 12}" y="{y - 8}" width="24" height="16" fill="{colour}" fill-opacity="0.3" stroke="{colour}"/>'
            )
        else:
            parts.append(
                f'<polygon points="{text}"{fill} stroke="{colour}" stroke-width="3" stroke-linejoin="round">'
                f"<title>{escape(body)}</title></polygon>"
            )
        names.append((body, colour))
    for point, is_ground in pins(placed):
        x, y = at(point if len(point) == 2 else np.array([RIGHT, UP]) @ point)
        if is_ground:
            hatch = " ".join(f"M{x - 10 + 5 * i},{y + 20} l-5,6" for i in range(5))
            parts.append(f'<path d="M{x},{y} l-9,20 h18 z M{x - 13},{y + 20} h26 {hatch}" fill="none" stroke="{GROUND}"/>')
        parts.append(f'<circle cx="{x}" cy="{y}" r="4.5" fill="white" stroke="#222222" stroke-width="1.5"/>')
    if is_spatial:
        parts += _axes(36.0, height - 36.0)
    labels, height = _legend(names, width, height)
    title = escape(mechanism.scene.title)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" role="img" aria-label="{title}" width="{width}" height="{height:.0f}" '
        f'viewBox="0 0 {width} {height:.0f}" font-family="sans-serif" font-size="12"><rect width="100%" height="100%" fill="white"/>'
        + "".join(parts + labels)
        + "</svg>"
    )


def _axes(x: float, y: float) -> list[str]:
    """The axes of the ground, from a corner of the picture."""
    parts = []
    for name, right, up in zip("xyz", RIGHT, UP):
        to = (x + 24 * right, y - 24 * up)
        parts.append(f'<line x1="{x}" y1="{y}" x2="{to[0]:.2f}" y2="{to[1]:.2f}" stroke="{GROUND}"/>')
        parts.append(
            f'<text x="{x + 32 * right:.2f}" y="{y - 32 * up + 4:.2f}" fill="{GROUND}" text-anchor="middle">{name}</text>'
        )
    return parts


def _legend(names: Sequence[tuple[str, str]], width: float, top: float) -> tuple[list[str], float]:
    """The names of the bodies in their colours, in rows below the picture, and where it then ends."""
    x, y = 14.0, top + 4.0
    texts: list[str] = []
    for name, colour in names:
        advance = 7.5 * len(name) + 18.0
        if x + advance > width and x > 14.0:
            x, y = 14.0, y + 18.0
        texts.append(f'<text x="{x:.1f}" y="{y:.1f}" fill="{colour}" font-weight="bold">{escape(name)}</text>')
        x += advance
    return texts, y + 12.0


def _pyplot() -> Any:
    try:
        import matplotlib.pyplot as pyplot
    except ImportError:
        raise ImportError("pictures need matplotlib: pip install 'dwell[plot]'") from None
    return pyplot


def plot_mechanism(mechanism: Drawn, q: float | Sequence[float] | None, axes: Any = None, labels: bool = True) -> Any:
    """Draws the mechanism into matplotlib axes (absent: new ones), and returns them. In space they are axes of three dimensions."""
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
        # Of an axis that is short, as many numbers as have room.
        extents = np.ptp([at for points in bodies.values() for at in points.values()], axis=0)
        for name, extent in zip("xyz", extents):
            axes.locator_params(axis=name, nbins=max(1, round(6 * extent / max(extents.max(), 1e-9))))
    axes.set_title(mechanism.scene.title)
    if labels:
        axes.legend(frameon=False, loc="center left", bbox_to_anchor=(1.15 if size == 3 else 1.0, 0.5))
    return axes


def _outline(points: Array) -> Array:
    """The line that shows a body: in the plane around its points, in space from each of its points to the next."""
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
        # The limits themselves are singular.
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
    """Columns over another one: one axis for each unit."""
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
