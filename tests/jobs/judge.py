"""Judges a run of `dwell optimise` by its files and by sweeps of the scene that it wrote."""
import csv
import json
import math
import re
import tomllib

import program as runs
from make import names_in, value_of

# Results of the sweep agree with what is reported, conditions hold, and probes are not better, each by this part.
SAME = 1e-6
# The derivative of the Lagrangian in parts of the ranges, over 1 + that of the goal, with the goal in parts of its size.
# Seen: 2.0e-7, in 64 jobs.
RESIDUAL = 2e-5
# Steps of differences, and distances of probes, in parts of the ranges.
STEP = 2e-4
PROBES = [(1e-2, 40), (1e-3, 40)]
NUMBER = r"(?<![\w.])[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?(?![\w.])"


class Fault(Exception):
    """What is wrong with a run."""


def demand(condition, text):
    if not condition:
        raise Fault(text)


class Judge:
    def __init__(self, program, job, folder):
        self.program, self.job, self.folder = program, job, folder
        self.front = [name for name, _ in job.goal] if job.is_front else []
        texts = [name for name, _ in job.goal] + [of for of, _, _ in job.conditions]
        self.results = [name for text in texts for name in names_in(text, job.vary)]

    def swept(self, vary, samples=None, seed=1):
        """Rows of designs about the written scene, of which the numbers in `vary` are others."""
        rows = runs.sweep(self.program, self.folder, self.written, self.results, vary, self.job.tied, samples, seed)
        return [None if row is None else {**self.numbers, **row} for row in rows]

    def goal(self, row):
        return sum(weight * value_of(text, row) for text, weight in self.job.goal)

    def violations(self, row):
        """By condition: by how much it is violated, in its unit."""
        found = []
        for text, sign, limit in self.job.conditions:
            over = value_of(text, row) - limit
            found.append({"<=": max(over, 0), ">=": max(-over, 0), "=": abs(over)}[sign])
        return found

    def verdict(self, status, text):
        """The kind of the outcome and what was seen."""
        demand("panicked" not in text, "panics")
        if status is None:
            return "slow", f"more than {runs.LONGEST} s"
        demand(status in (0, 1, 2), f"status {status}")
        self.written = self.folder / "out" / "machine-optimise-job.toml"
        summary = self.folder / "out" / "machine-optimise.json"
        if not summary.exists():
            demand(status != 0, "status 0 without files")
            demand("×" in text, "refused without a message")
            demand(not self.written.exists(), "a scene without a summary")
            return "refused", " ".join(re.findall(r"× (.*)", text))
        self.read(status, text, summary)
        self.check_text()
        if self.job.is_front:
            return self.check_front()
        return self.check_design(text)

    def read(self, status, text, summary):
        document = json.loads(summary.read_text(), object_pairs_hook=unique)
        demand(document["status"] == status, f"status {status}, in the file {document['status']}")
        self.reported = {name: of["value"] for name, of in document["results"].items()}
        demand(all(v is None or math.isfinite(v) for v in self.reported.values()), "a number that is none")
        if self.job.is_front:
            return
        is_certified = self.reported["certificate.is_certified"] == 1
        demand(is_certified == ("\n  certified as a local optimum" in text), "summary and file differ on the certificate")
        demand(is_certified or re.search(r"not certified: \S+ \S+", text), "not certified without a reason")
        none_converged = self.reported["starts"] == self.reported["starts.not_converged"]
        demand((status == 1) == none_converged, f"status {status}, but {self.reported['starts.not_converged']} of {self.reported['starts']} starts have not converged")
        demand(not (is_certified and none_converged), "certified, but no start converged")

    def check_text(self):
        """Only numbers of the design differ from the scene, and those that follow do follow."""
        before, after = self.job.text, self.written.read_text()
        masked = [re.sub(NUMBER, "#", re.sub(r"-?\binf\b|\bnan\b", "#", text)) for text in (before, after)]
        demand(masked[0] == masked[1], "more than numbers changed")
        comments = [[line.partition("#")[2] for line in text.splitlines()] for text in (before, after)]
        demand(comments[0] == comments[1], "a comment changed")
        leaves = [dict(leaves_of(tomllib.loads(text))) for text in (before, after)]
        changed = {path for path in leaves[0] if leaves[0][path] != leaves[1][path]}
        ties = self.job.tied_by_sweep + self.job.tied
        may_change = [*self.job.vary, *(path for path, _ in ties), *(path for path, _ in self.job.choices)]
        names = {name: full for name in may_change for full in (name, f"bodies.{name}", f"sweep.parameters.{name}") if full in leaves[0]}
        demand(changed <= set(names.values()), f"{changed - set(names.values())} changed")
        self.numbers = {name: float(leaves[1][full]) for name, full in names.items()}
        for path, bounds in self.job.vary.items():
            demand(bounds[0] <= self.numbers[path] <= bounds[1], f"{path} is beyond its bounds")
        for path, text in ties:
            right = value_of(text, self.numbers)
            demand(abs(self.numbers[path] - right) <= 1e-12 * abs(right), f"{path} does not follow")
        for path, rows in self.job.choices:
            demand(self.numbers[path] in [value for _, value in rows], f"{path} is of no part")

    def own(self):
        path = next(iter(self.job.vary))
        rows = self.swept([f"{path}={self.numbers[path]!r}"])
        demand(rows[0] is not None, "the written scene has no results")
        return rows[0]

    def check_design(self, text):
        job, reported = self.job, self.reported
        for path in job.vary:
            demand(reported[path] == self.numbers[path], f"{path} is another number in the scene")
        row = self.own()
        goal, scale = self.goal(row), max(abs(reported["goal"]), abs(reported.get("goal.before") or 0))
        is_certified = reported["certificate.is_certified"] == 1
        says_other = "the sweep has other results" in text or "the sweep does not compute it" in text
        demand(abs(goal - reported["goal"]) <= SAME * scale + 1e-12 or says_other, f"the goal is {goal}, not {reported['goal']}")
        is_feasible = True
        for k, (of, sign, limit) in enumerate(job.conditions):
            size = abs(limit) or abs(value_of(of, row))
            value = self.condition(k)
            demand(abs(value_of(of, row) - value) <= SAME * max(size, abs(value)) + 1e-12 or says_other, f"{of} is {value_of(of, row)}, not {value}")
            is_feasible &= self.violations(row)[k] <= 1.01 * SAME * max(size, 1e-9)
        if not is_certified:
            reason = re.search(r"not certified: ([^;\n]+)", text)[1]
            return "not certified", re.sub(r"[-\d.]+(e[-+]?\d+)?", "#", reason)
        demand(is_feasible, "an inadmissible design is called optimal")
        demand(job.kind != "infeasible", "a condition that no random design was near is satisfied")
        self.probe(row, goal, scale)
        if abs(goal) <= 1e-9 * scale:
            return "certified", "the goal vanishes"
        return "certified", self.check_slopes(row, goal, scale)

    def condition(self, k, part=""):
        return self.reported.get(f"condition[{k}]{part}")

    def probe(self, row, goal, scale):
        """No design nearby is better and admissible."""
        own = self.violations(row)
        slack = sum(abs(self.condition(k, ".price") or 0) * violation for k, violation in enumerate(own))
        for seed, (radius, count) in enumerate(PROBES):
            vary = []
            for path, (low, high) in self.job.vary.items():
                off = radius * (high - low)
                vary.append(f"{path}~uniform({max(low, self.numbers[path] - off)!r},{min(high, self.numbers[path] + off)!r})")
            for other in filter(None, self.swept(vary, count, seed)):
                is_admissible = all(v <= max(1e-9 * abs(limit), w) for v, w, (_, _, limit) in zip(self.violations(other), own, self.job.conditions))
                if is_admissible and self.goal(other) < goal - SAME * scale - slack:
                    raise Fault(f"a design within {radius} of the ranges is better: {self.goal(other)} < {goal}, at {other}")

    def check_slopes(self, row, goal, scale):
        """The conditions of Karush, Kuhn and Tucker by differences, unless a result has a kink there, as where extrema tie."""
        prices = [self.condition(k, ".price") or 0.0 for k in range(len(self.job.conditions))]
        for (of, sign, limit), price in zip(self.job.conditions, prices):
            demand(sign == "=" or (price <= 0) == (sign == "<=") or price == 0, f"{of} has a price of the wrong sign: {price}")
            room = abs(value_of(of, row) - limit)
            demand(abs(price) * room <= 10 * SAME * scale, f"{of} is not active, but has a price")
        parts, sizes = [], []
        for path, (low, high) in self.job.vary.items():
            step = STEP * (high - low)
            at = [self.numbers[path] + k * step for k in (-2, -1, 1, 2)]
            rows = self.swept([f"{path}={','.join(map(repr, at))}"])
            if None in rows:
                return "designs nearby have no results"
            price = self.reported.get(f"{path}.price") or 0.0
            is_low, is_high = self.numbers[path] <= low + 1e-9 * (high - low), self.numbers[path] >= high - 1e-9 * (high - low)
            demand(price == 0 or is_low and price >= 0 or is_high and price <= 0, f"{path} has a price at no bound, or of the wrong sign")
            slopes = []
            for of in [self.goal, *(lambda r, t=text: value_of(t, r) for text, _, _ in self.job.conditions)]:
                a, b, c, d = map(of, rows)
                here = of(row)
                bend, wide = b + c - 2 * here, a + d - 2 * here
                is_smooth = abs(wide) > 3 * abs(bend) or abs(bend) <= 1e-9 * abs(here) + 1e-12
                slopes.append((8 * (c - b) - (d - a)) / (12 * step))
                if not is_smooth and (of == self.goal or prices[len(slopes) - 2] != 0):
                    return "a kink"
            rest = slopes[0] - price - sum(p * s for p, s in zip(prices, slopes[1:]))
            parts.append(abs(rest) * (high - low) / scale)
            sizes.append(abs(slopes[0]) * (high - low) / scale)
        residual = max(parts) / (1 + max(sizes))
        demand(residual <= RESIDUAL, f"the residual is {residual:.1e}")
        return residual

    def check_front(self):
        with (self.folder / "out" / "machine-optimise-job.csv").open() as file:
            header, *rows = csv.reader(file)
        paths = [name.rsplit(" [", 1)[0] for name in header[4:]]
        row = self.own()
        goals = []
        for k, cells in enumerate(rows):
            goals.append([float(cells[0]), float(cells[1])])
            values = dict(zip(paths, map(float, cells[4:])))
            for path, bounds in self.job.vary.items():
                demand(bounds[0] <= values[path] <= bounds[1], f"point {k} is beyond the bounds of {path}")
            if k % 4 and any(abs(values[p] - self.numbers[p]) > 0 for p in self.job.vary):
                continue
            found = self.swept([f"{path}={values[path]!r}" for path in self.job.vary])[0]
            demand(found is not None, f"point {k} has no results")
            for (name, _), goal in zip(self.job.goal, goals[-1]):
                demand(abs(found[name] - goal) <= SAME * max(abs(goal), abs(row[name])) + 1e-12, f"{name} of point {k} is {found[name]}, not {goal}")
            for violation, (of, _, limit) in zip(self.violations(found), self.job.conditions):
                demand(violation <= 1.01 * SAME * (abs(limit) or 1), f"point {k} violates {of}")
        extent = [max(g[i] for g in goals) - min(g[i] for g in goals) for i in range(2)]
        for k, a in enumerate(goals):
            for j, b in enumerate(goals):
                is_worse = all(a[i] > b[i] + 1e-5 * extent[i] for i in range(2))
                demand(not (is_worse and rows[k][3] == "true"), f"point {k} of the front is worse than point {j}")
        return "front", f"{len(goals)} points"


def unique(pairs):
    names = [name for name, _ in pairs]
    demand(len(set(names)) == len(names), f"a name twice: {max(names, key=names.count)}")
    return dict(pairs)


def leaves_of(value, path=""):
    if isinstance(value, dict):
        for key, part in value.items():
            yield from leaves_of(part, f"{path}.{key}" if path else key)
    elif isinstance(value, list):
        for k, part in enumerate(value):
            yield from leaves_of(part, f"{path}[{k}]")
    else:
        yield path, value
