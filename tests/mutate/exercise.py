"""Runs of the program on a few scenes: the changes that each run reaches, and its output without any change."""
import json
import math
import os
import pathlib
import resource
import shlex
import shutil
import signal
import subprocess
import tempfile
import time

import contents

SCENES = [
    "validation/*/scene.toml",
    "validation/spatial/*.toml",
    "tests/mutations/scenes/*.toml",
    "tests/mutate/scenes/*.toml",
    "crates/scene/src/tests/*.toml",
    "crates/kinetostatics/tests/loads/*.toml",
    "crates/cli/src/init.toml",
    "crates/study/tests/run/*.toml",
    "docs/slider.toml",
]
# The commands are short: few positions, few rows and no pictures.
COMMANDS = [
    ["check"],
    ["reduce", "--points", "25"],
    ["reduce", "--points", "9", "--table-accuracy", "1e-8"],
    ["kinematics", "--points", "25"],
    ["statics", "--points", "13"],
    ["kinetostatics", "--points", "25"],
    ["runs", "--points", "13"],
    ["simulate", "--sample-interval", "0.05"],
    ["simulate", "--method", "dop853", "--sample-interval", "0.05"],
    ["simulate", "--method", "esdirk34", "--rtol", "1e-6", "--sample-interval", "0.05"],
    ["simulate", "--accuracy", "1e-6"],
    ["cycle", "--fluctuation", "0.02"],
    ["equilibria"],
    ["linearise"],
    ["linearise", "--about", "initial"],
    ["symbolic", "--format", "python"],
    ["calibrate"],
]
# Parts of a tolerance with which a motion is run again.
PARTS_OF_TOLERANCE = [0.35, 0.5, 0.7]
# No run takes longer, s of the clock, beside other work, too; and one that takes longer than this of the processors without a change is not among them.
LONGEST, LONGEST_BASE = 90.0, 5.0


class Written:
    """The output of one run: its status (None if it did not end), its printed text, and its files."""

    def __init__(self, status, printed, files, seconds, cost):
        self.status, self.printed, self.files = status, printed, files
        # On the clock, and of the processors: what else runs on the machine lengthens the first alone.
        self.seconds, self.cost = seconds, cost

    @property
    def has_panicked(self):
        return self.status is not None and (self.status < 0 or self.status > 2)


def processor_time():
    """The processor time of the child processes that have ended, s."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


class Exercise:
    """A scene and a command, with the changes that the run reaches and its output without a change."""

    def __init__(self, scene, arguments):
        self.scene, self.arguments = scene, arguments
        self.reached, self.base, self.effective = set(), None, {}

    def name(self):
        folder = self.scene.parent.name if self.scene.name == "scene.toml" else self.scene.stem
        return f"{folder}: {' '.join(self.arguments)}"

    def command(self):
        table = ["--export", "csv"] if self.arguments[0] == "sweep" else []
        return [self.arguments[0], str(self.scene), *self.arguments[1:], *table, "--pictures", "none", "--name", "scene"]


class Program:
    """The program that contains all changes."""

    def __init__(self, path, scratch):
        self.path, self.scratch = path, scratch
        scratch.mkdir(parents=True, exist_ok=True)

    def run(self, arguments, number=0, reached=None, limit=LONGEST, directory=None):
        """A run with one change active, or none, in a folder of its own or a directory, with its files in that folder."""
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.scratch))
        kept = ("PATH", "HOME", "TMPDIR")
        environment = {key: os.environ[key] for key in kept if key in os.environ}
        environment |= {"NO_COLOR": "1", "LC_ALL": "C.UTF-8", "DWELL_MUTANT": str(number)}
        if reached is not None:
            environment["DWELL_MUTANT_REACHED"] = str(reached)
        command = [str(self.path), *arguments, "--out", str(folder / "out")]
        begin, used = time.monotonic(), processor_time()
        # A group of its own: `validate` starts processes that would go on without it.
        pipe = subprocess.PIPE
        process = subprocess.Popen(command, env=environment, stdout=pipe, stderr=pipe, stdin=subprocess.DEVNULL, cwd=directory or folder, start_new_session=True)
        try:
            printed = b"".join(process.communicate(timeout=limit))
            status = process.returncode
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            status, printed = None, b""
        seconds = time.monotonic() - begin
        files = {}
        for path in sorted((folder / "out").rglob("*")):
            if path.is_file() and path.suffix not in contents.PICTURES:
                files[path.relative_to(folder / "out").as_posix()] = path.read_bytes()
        shutil.rmtree(folder, ignore_errors=True)
        printed = printed.decode("utf-8", errors="replace").replace(str(folder), "FOLDER")
        return Written(status, printed, files, seconds, processor_time() - used)

    def recorded(self, arguments):
        """A run without a change, and the changes that it reaches."""
        path = pathlib.Path(tempfile.mkstemp(dir=self.scratch)[1])
        written = self.run(arguments, reached=path)
        reached = {int(line) for line in path.read_text().split()}
        path.unlink()
        return written, reached


def own_commands(scene):
    """The commands that a scene names in its comments, such as `# run: sweep --vary crank.mass=1,2`."""
    lines = scene.read_text(encoding="utf-8").splitlines()
    return [shlex.split(line.removeprefix("# run: ")) for line in lines if line.startswith("# run: ")]


def exercises(top, program, say):
    """All runs that end quickly with a result, with the changes that they reach."""
    scenes = sorted(path for pattern in SCENES for path in top.glob(pattern))
    found = []
    for scene in scenes:
        for arguments in COMMANDS + own_commands(scene):
            one = Exercise(scene, arguments)
            one.base, one.reached = program.recorded(one.command())
            # Where there is no result, numbers of a message are none.
            has_result = one.base.status == 0 or any(name.endswith(".csv") for name in one.base.files)
            if one.base.status in (0, 1) and has_result and one.base.cost < LONGEST_BASE:
                one.effective = effective(one, program)
                found.append(one)
    say(f"{len(found)} runs of {len(scenes)} scenes reach {len(set().union(*(e.reached for e in found)))} changes")
    return found


def effective(one, program):
    """From which size on each label has changed: what differs between two runs of the same program is no effect of a change, nor is
    what other tolerances of an integration change, times a factor."""
    sizes = dict.fromkeys(contents.sizes(one.base, program.run(one.command())), math.inf)
    for part in PARTS_OF_TOLERANCE:
        finer = finer_command(one, part)
        for label, differs in contents.sizes(one.base, program.run(finer)).items() if finer else ():
            sizes[label] = max(sizes.get(label, contents.EFFECTIVE), contents.TIMES_TOLERANCE * differs)
    return sizes


def finer_command(one, part):
    """The command with a part of the tolerance, or of the accuracy asked for; none where it does not integrate with steps."""
    command = one.command()
    if one.arguments[0] != "simulate":
        return None
    if "--accuracy" in command:
        at = command.index("--accuracy") + 1
        return [*command[:at], str(part * float(command[at])), *command[at + 1 :]]
    summary = next((json.loads(data) for name, data in one.base.files.items() if name.endswith("simulate.json")), None)
    tolerance = (summary or {}).get("results", {}).get("tolerance")
    if tolerance is None:
        return None
    at = command.index("--rtol") if "--rtol" in command else len(command)
    return [*command[:at], *command[at + 2 :], "--rtol", str(part * tolerance["value"])]


def for_change(all_exercises, number, most):
    """The cheapest runs that reach a change, of different commands and different scenes before others."""
    reaching = sorted((e for e in all_exercises if number in e.reached), key=lambda e: e.base.cost)
    chosen, seen = [], set()
    for is_new in (lambda e: e.arguments[0] not in seen and e.scene not in seen, lambda e: e.arguments[0] not in seen, lambda e: True):
        for exercise in reaching:
            if len(chosen) < most and exercise not in chosen and is_new(exercise):
                chosen.append(exercise)
                seen |= {exercise.arguments[0], exercise.scene}
    return chosen

