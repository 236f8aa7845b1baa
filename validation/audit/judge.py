"""Differences, their scales and tolerances, and the lines that report them."""

from dataclasses import dataclass

import numpy as np

from tolerances import CHECKS, number


@dataclass
class Worst:
    """The largest difference of a check, relative to its scale."""

    count: int = 0
    relative: float = 0.0
    difference: float = 0.0
    unit: str = ""
    place: str = ""
    reason: str = ""  # why the check fails whatever the numbers are

    @property
    def is_number(self):
        return not np.isnan(self.relative)


class Judge:
    """All checks of a folder. A check is known by its file and its key in `tolerances.CHECKS`."""

    def __init__(self):
        self.checks, self.skipped = {}, []
        self.file = ""

    def worst(self, key):
        assert key in CHECKS, key
        return self.checks.setdefault((self.file, key), Worst())

    def compare(self, key, difference, scale, unit, place):
        """Differences of successive rows, relative to a scale: one number, or one for each row."""
        difference = np.atleast_1d(np.asarray(difference, float))
        size, worst = np.abs(difference), self.worst(key)
        worst.count += size.size
        if not size.size:
            return
        with np.errstate(all="ignore"):
            relative = np.where(size == 0.0, 0.0, size / np.abs(scale))
        row = int(np.argmax(np.where(np.isnan(relative), np.inf, relative)))
        if worst.is_number and (np.isnan(relative[row]) or relative[row] > worst.relative or not worst.place):
            worst.relative, worst.difference, worst.unit = relative[row], size[row], unit
            worst.place = f"row {row}, {place}" if size.size > 1 else place

    def require(self, key, holds, reason):
        """Requires a condition that has no difference and no tolerance."""
        worst = self.worst(key)
        worst.count += 1
        if not holds and not worst.reason:
            worst.reason = reason

    def skip(self, what, reason):
        """Notes that something cannot be judged."""
        line = f"{self.file}: {what}: {reason}" if self.file else f"{what}: {reason}"
        if line not in self.skipped:
            self.skipped.append(line)

    def passes(self, key, worst):
        return not worst.reason and worst.relative <= CHECKS[key].tolerance

    @property
    def has_failed(self):
        return any(not self.passes(key, worst) for (_, key), worst in self.checks.items())

    def data(self):
        """The checks as plain data."""
        found = []
        for (file, key), worst in self.checks.items():
            check = CHECKS[key]
            found.append({
                "file": file, "check": key, "number": number(key), "comparison": check.comparison, "scale": check.scale,
                "count": worst.count, "difference": float(worst.difference), "unit": worst.unit,
                "relative_difference": float(worst.relative), "tolerance": check.tolerance,
                "tolerance_reason": check.reason, "worst_at": worst.reason or worst.place,
                "pass": bool(self.passes(key, worst)),
            })
        return found

    def lines(self):
        """A line for each check."""
        for of in self.data():
            verdict = "pass" if of["pass"] else "FAIL"
            numbers = f"{of['difference']:.1e} {of['unit']}".strip()
            yield (f"{verdict}  {of['file']}, {of['check']}: {of['comparison']}; {of['count']} comparisons, largest {numbers}, "
                   f"{of['relative_difference']:.1e} of {of['scale']} (tolerance {of['tolerance']:.0e}), at {of['worst_at']}")
        for line in self.skipped:
            yield f"not judged: {line}"


def largest(*arrays):
    """The largest absolute value, without NaN."""
    sizes = [np.nanmax(np.abs(a)) for a in map(np.asarray, arrays) if a.size and not np.all(np.isnan(a))]
    return max(sizes, default=0.0)
