"""The outcome of each change: whether a written number changes, and which numbered checks of `dwell validate` fail."""
import json

import contents
import exercise

# Runs of a change, of those that reach it; more of a named fault, which must show an effect.
MOST_RUNS, MOST_RUNS_NAMED = 3, 9
# No more cases are tried than take so long without a change, s of the processors, but at least so many.
MOST_SECONDS, LEAST_CASES = 25.0, 8
# Time limit of `dwell validate` on all cases, s.
WHOLE_SECONDS = 600.0
CAUGHT = "caught by two"


class Case:
    """A case of `validation`, in the plane or in space, with the changes that its validation reaches."""

    def __init__(self, scene, top, program):
        self.scene, self.folder = scene, top / "validation"
        self.name = scene.parent.name if scene.name == "scene.toml" else scene.stem
        self.base, self.reached = program.recorded(self.command())
        if self.base.status != 0:
            raise SystemExit(f"`dwell validate {self.name}` fails without a change:\n{self.base.printed}")
        if "independent reader: not run" in self.base.printed:
            raise SystemExit("checks 12 to 18 and 20 of written files need Python 3.11 with NumPy: `python3 -m pip install numpy`")

    def run(self, program, number):
        return program.run(self.command(), number, limit=limit_of(self.base))

    def command(self):
        return ["validate", self.name, "--folder", str(self.folder), "--pictures", "none"]


class Whole:
    """All cases with the extreme parameters, which belong to no case: `dwell validate` as it stands in the README."""

    name = "all"

    def __init__(self, top):
        self.top = top

    def run(self, program, number):
        return program.run(["validate", "--pictures", "none"], number, limit=WHOLE_SECONDS, directory=self.top)


class Result:
    """The outcome of a change."""

    def __init__(self, change):
        self.change, self.outcome, self.checks, self.by = change, "", {}, []
        self.size, self.place, self.only_estimates = 0.0, "", False
        self.scenes, self.kinds = set(), set()

    def as_dict(self):
        of = self.change
        return {
            "file": of.path, "line": of.line, "change": of.what, "instead": of.text, "named": of.named, "outcome": self.outcome,
            "checks": self.checks, "by": self.by, "size": min(self.size, 1e300), "place": self.place, "only_estimates": self.only_estimates,
            "kinds": sorted(self.kinds),
        }


def cases(top, program):
    scenes = [path.with_name("scene.toml") for path in top.glob("validation/*/case.toml")]
    return [Case(scene, top, program) for scene in sorted(scenes) + sorted(top.glob("validation/spatial/*.toml"))]


def limit_of(written):
    return min(exercise.LONGEST, 2.0 + 6.0 * written.seconds)


def judge(change, program, all_cases, all_exercises):
    """Tries a change on commands that reach it, then on the cases, the quickest first, until two checks fail."""
    result = Result(change)
    reaching = sorted((c for c in all_cases if change.number in c.reached), key=lambda c: c.base.cost)
    runs = exercise.for_change(all_exercises, change.number, MOST_RUNS_NAMED if change.named else MOST_RUNS)
    if not runs and not reaching:
        result.outcome = "not reached"
        return result
    refusal = effect(result, program, runs)
    if result.outcome != "number changed" and runs:
        result.outcome = refusal or "no number changed"
        return result
    if not reaching:
        tried(result, program, Whole(all_cases[0].folder.parent))
    # First the cases in whose files a number changed.
    reaching.sort(key=lambda case: case.scene not in result.scenes)
    validated(result, program, reaching)
    result.outcome = outcome(result, has_effect=bool(runs))
    return result


def judge_again(change, known, program, all_cases):
    """Tries a change whose effect is known from an earlier run on the cases alone, first on that in whose files a number changed."""
    result = Result(change)
    result.size, result.place, result.only_estimates = known["size"], known["place"], known["only_estimates"]
    result.kinds = set(known.get("kinds", ()))
    reaching = sorted((c for c in all_cases if change.number in c.reached), key=lambda c: c.base.cost)
    reaching.sort(key=lambda case: case.name != result.place.split(": ")[0])
    validated(result, program, reaching)
    result.outcome = outcome(result, has_effect=True)
    return result


def outcome(result, has_effect):
    if len(result.checks) >= 2:
        return CAUGHT
    if {"refused", "endless"} & set(result.by):
        # A validation that does not end well tells the user; a command that does not leaves the other commands' numbers wrong.
        return "refused"
    if result.checks:
        return "caught by one"
    return "not caught" if has_effect else "no number changed"


def validated(result, program, some_cases):
    """Validates cases until two checks of different number fail."""
    spent = 0.0
    for count, case in enumerate(some_cases):
        if count >= LEAST_CASES and spent + case.base.cost > MOST_SECONDS:
            return
        spent += case.base.cost
        tried(result, program, case)
        if len(result.checks) >= 2:
            return


def tried(result, program, case):
    """Validates a case with the change."""
    done = case.run(program, result.change.number)
    failed = failed_checks(done)
    for number, key in failed:
        result.checks.setdefault(number, f"{case.name}: {key}")
    if done.status is None:
        result.by.append("endless")
    elif done.status != 0 and not failed:
        result.by.append("refused")


def failed_checks(done):
    """The numbers of the checks that failed, with the key of the first finding of each."""
    summary = next((data for name, data in done.files.items() if name.endswith("validate.json")), None)
    if summary is None:
        return []
    failed = [f for f in json.loads(summary)["findings"] if not f["pass"]]
    return list({f["check"].split()[0]: (f["check"].split()[0], f["key"]) for f in reversed(failed)}.values())


def effect(result, program, runs):
    """Whether a run writes other numbers; returns how it is refused where it is."""
    refusal = None
    for run in runs:
        done = program.run(run.command(), result.change.number, limit=limit_of(run.base))
        if done.status is None:
            refusal = refusal or "endless"
            continue
        if done.has_panicked or done.status > run.base.status:
            refusal = "refused"
            continue
        found = contents.difference(run.base, done, run.effective)
        if found is None:
            continue
        if result.outcome != "number changed" or (not found.only_estimates, found.largest) > (not result.only_estimates, result.size):
            result.size, result.place, result.only_estimates = found.largest, f"{run.name()}: {found.place}", found.only_estimates
        result.outcome = "number changed"
        if not found.only_estimates:
            result.scenes.add(run.scene)
            result.kinds |= found.kinds
    return refusal
