"""Rows of numbers under named columns with units: the results of motions and sweeps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Iterator, Mapping

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from . import _native

Array = npt.NDArray[np.float64]


class Results(Mapping[str, Array]):
    """Columns by name: arrays of float64, a row for each position or instant. ``units`` has the unit of each.

    >>> results = Results({"t": np.array([0.0, 1.0])}, {"t": "s"})
    >>> float(results["t"].max()), results.units["t"]
    (1.0, 's')
    """

    def __init__(self, columns: Mapping[str, Array], units: Mapping[str, str]) -> None:
        self._columns = dict(columns)
        self.units = dict(units)

    @classmethod
    def _read(cls, rows: _native.Rows) -> tuple[dict[str, Array], dict[str, str]]:
        columns = rows.columns
        return {name: rows.column(name) for name, _ in columns}, dict(columns)

    def __getitem__(self, name: str) -> Array:
        try:
            return self._columns[name]
        except KeyError:
            import difflib

            near = difflib.get_close_matches(name, self._columns, n=3)
            hint = f"; did you mean {' or '.join(f'`{n}`' for n in near)}?" if near else ""
            raise KeyError(f"there is no column `{name}`{hint}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def rows(self) -> int:
        """Number of rows of each column."""
        return len(next(iter(self._columns.values()), ()))

    def to_pandas(self) -> Any:
        """A pandas DataFrame; ``df.attrs["units"]`` has the units."""
        import pandas

        frame = pandas.DataFrame(self._columns)
        frame.attrs["units"] = dict(self.units)
        return frame

    def to_polars(self) -> Any:
        """A polars DataFrame."""
        import polars

        return polars.DataFrame(self._columns)

    def to_xarray(self) -> Any:
        """An xarray Dataset over the first column; each variable has its unit as the attribute ``units``."""
        import xarray

        first = next(iter(self._columns))
        data = {name: (first, values, {"units": self.units[name]}) for name, values in self._columns.items()}
        return xarray.Dataset(data).set_coords(first)

    def plot(self, *names: str, x: str | None = None) -> Any:
        """Plots columns over the first one (or ``x``), with matplotlib: one axis for each unit. Returns the axes."""
        from ._drawing import plot_columns

        return plot_columns(self, names, x or next(iter(self._columns)))

    def __repr__(self) -> str:
        named = ", ".join(list(self._columns)[:6])
        more = f", … {len(self) - 6} more" if len(self) > 6 else ""
        return f"{type(self).__name__}({self.rows} rows: {named}{more})"

    def _repr_html_(self) -> str:
        from html import escape

        body = "".join(
            f"<tr><td>{escape(name)}</td><td>{escape(self.units[name])}</td>"
            f"<td>{np.min(values):.6g}</td><td>{np.max(values):.6g}</td></tr>"
            for name, values in self._columns.items()
            if len(values)
        )
        return f"<p>{self.rows} rows</p><table><tr><th>column</th><th>unit</th><th>least</th><th>largest</th></tr>{body}</table>"


class Motion(Results):
    """A motion in time: rows, events, and its estimated error.

    events: list of (time in s, name). estimated_error: if an accuracy was required. early_stop: the reason why the motion ended early or is
    less accurate than required, or None; ``check()`` raises it.

    Called with times (s), it interpolates coordinates and their velocities by polynomials of degree five through value, velocity and
    acceleration of the rows on either side:

    >>> import dwell
    >>> m = dwell.Builder("Free wheel")
    >>> m.body("ground", O=(0, 0)); m.body("wheel", O=(0, 0), mass=1.0, center="O", inertia=0.1)
    >>> _ = m.pin("O", "ground", "wheel").actuator("phi", angle=("ground", "wheel"))
    >>> _ = m.motion(duration=1.0, initial_velocity={"phi": 2.0})
    >>> motion = m.assemble().simulate(1e-9)
    >>> bool(abs(motion(0.12345)["phi"] - 0.2469) < 1e-12)
    True
    """

    def __init__(self, rows: _native.Rows) -> None:
        super().__init__(*self._read(rows))
        self.events: list[tuple[float, str]] = rows.events
        self.estimated_error: float | None = rows.estimated_error
        self.early_stop: Exception | None = rows.early_stop

    def check(self) -> Motion:
        """Raises ``early_stop`` if there is one; returns the motion."""
        if self.early_stop is not None:
            raise self.early_stop
        return self

    def __call__(self, t: npt.ArrayLike) -> dict[str, Array]:
        """Coordinates and velocities at the times t (s), by name. Raises ValueError outside the motion."""
        at = np.asarray(t, dtype=np.float64)
        time = self["t"]
        if at.size and not (np.all(at >= time[0]) and np.all(at <= time[-1])):
            raise ValueError(f"the motion lasts from {time[0]} to {time[-1]} s")
        # The rows before and after the time. Two rows may have the same time, because an event writes a row before and one after it.
        left = np.clip(np.searchsorted(time, at, side="right") - 1, 0, max(len(time) - 2, 0))
        found: dict[str, Array] = {}
        for name in self._columns:
            velocity, acceleration = f"{name}.velocity", f"{name}.acceleration"
            if velocity in self._columns and acceleration in self._columns:
                values = self[name], self[velocity], self[acceleration]
                found[name], found[velocity] = _quintic(time, values, left, at)
        return found


def _quintic(time: Array, values: tuple[Array, Array, Array], left: npt.NDArray[np.intp], at: Array) -> tuple[Array, Array]:
    """Value and velocity of the polynomial through value, velocity and acceleration at both ends."""
    right = np.minimum(left + 1, len(time) - 1)
    h = time[right] - time[left]
    step = np.where(h > 0.0, h, 1.0)
    s = (at - time[left]) / step
    (p0, v0, a0), (p1, v1, a1) = ([v[k] for v in values] for k in (left, right))
    # In units of the step: p(s) = p0 + v0 s + a0 s²/2 + c3 s³ + c4 s⁴ + c5 s⁵.
    v0, v1, a0, a1 = v0 * step, v1 * step, a0 * step**2, a1 * step**2
    d, e, f = p1 - p0 - v0 - a0 / 2, v1 - v0 - a0, a1 - a0
    c3, c4, c5 = 10 * d - 4 * e + f / 2, -15 * d + 7 * e - f, 6 * d - 3 * e + f / 2
    value = p0 + s * (v0 + s * (a0 / 2 + s * (c3 + s * (c4 + s * c5))))
    slope = v0 + s * (a0 + s * (3 * c3 + s * (4 * c4 + s * 5 * c5)))
    return value, slope / step
