"""The independent reader and judge of what the commands write: `python3 validation/audit SCENE FOLDER`."""

import argparse
import json
import sys
import traceback

from files import Folder
from judge import Judge
from motion import Motion, Unplaced
from scene import Scene
import copies
import linear
import motions
import points
import poses
import reduced
import repeated
import sections
import sweeps


def whole_file(judge, scene, folder, rows, end, command, corners=()):
    """What is judged of every table: its archive, its headings, and the extrema of its summary."""
    repeated.archive(judge, rows, folder.npz(end))
    repeated.headings(judge, scene, rows)
    repeated.extrema(judge, rows, folder.summary(command), corners)


def pose_files(judge, scene, folder):
    """Files of `kinematics`, `statics` and `kinetostatics`."""
    found = False
    for command in ("kinematics", "statics", "kinetostatics"):
        rows = folder.csv(command)
        if rows is None:
            continue
        found, judge.file = True, command
        try:
            motion = Motion(scene, rows)
        except Unplaced as body:
            judge.skip("positions and forces", f"no columns say where `{body}` is")
            continue
        poses.closure(judge, motion)
        poses.laws(judge, motion, "prescribed")
        corners = [c for law, _ in scene.laws("prescribed").values() for c in law.corners]
        poses.between_rows(judge, rows, corners + poses.switch_times(motion))
        over = ((folder.summary(command) or {}).get("extrema_over") or {}).get("name", "t")
        corners = corners if over == "t" else []
        corners += poses.switch_places(motion, rows.get(over)) if over in rows else []
        whole_file(judge, scene, folder, rows, command, command, corners)
        repeated.quotients(judge, motion)
        if command == "kinematics":
            repeated.extents(judge, rows, folder.summary(command))
            repeated.dwell(judge, scene, rows, folder.summary(command))
        if command != "kinematics":
            poses.equilibrium(judge, motion, command == "statics")
            still = motion.at_rest() if command == "statics" else motion
            sections.judge_sections(judge, still, folder, folder.summary(command), command)
    return found


def motion_files(judge, scene, folder):
    """Files of `simulate`."""
    rows, events, summary = folder.csv("motion"), folder.csv("motion-events"), folder.summary("simulate")
    if rows is None:
        return
    judge.file = "motion"
    try:
        corners = motions.judge_motion(judge, Motion(scene, rows), events)
        whole_file(judge, scene, folder, rows, "motion", "simulate", corners)
    except Unplaced as body:
        judge.skip("positions and forces", f"no columns say where `{body}` is")
    motions.missing_events(judge, scene, rows, events)
    if summary is not None:
        motions.judge_summary(judge, scene, rows, events, summary)
        motions.events_are_met(judge, scene, events, summary)


def reduced_files(judge, scene, folder):
    """Files of `reduce` and `runs`."""
    rows, runs, both = folder.csv("reduced"), folder.csv("runs"), [folder.csv("run-i"), folder.csv("run-ii")]
    for run in both:
        if run is not None:
            judge.file = run.label
            try:
                motion = Motion(scene, run)
            except Unplaced as body:
                judge.skip("positions and forces", f"no columns say where `{body}` is")
                continue
            poses.closure(judge, motion)
            poses.between_rows(judge, run, poses.switch_times(motion))
            whole_file(judge, scene, folder, run, run.label, run.label)
            poses.equilibrium(judge, motion, is_loaded=False)
    if runs is not None:
        judge.file = "runs"
        reduced.judge_runs(judge, runs, *both, scene.actuators[0].name)
    if rows is not None:
        judge.file = "reduced"
        whole_file(judge, scene, folder, rows, "reduced", "reduce")
        moving = [*both, folder.csv("kinematics"), folder.csv("kinetostatics")]
        reduced.judge_reduced(judge, scene, rows, moving, folder.summary("reduce"))


def point_files(judge, scene, folder):
    """Files of `cycle`, `equilibria` and `linearise`."""
    rows = folder.csv("reduced")
    model = points.Reduced(scene, rows) if rows is not None and "m" in rows else None
    summary = folder.summary("cycle")
    for end, prefix in (("cycle", ""), ("cycle-flywheel", "flywheel.")):
        cycle, judge.file = folder.csv(end), end
        if cycle is not None:
            whole_file(judge, scene, folder, cycle, end, "")
            points.judge_cycle(judge, scene, cycle, summary, prefix, model)
    table, summary, judge.file = folder.csv("equilibria"), folder.summary("equilibria"), "equilibria"
    if table is not None:
        points.judge_equilibria(judge, scene, table, summary, model, folder.csv("statics"))
    text, judge.file = folder.text("linear.csv"), "linear"
    if text is not None:
        linear.judge_linear(judge, text, folder.npz("linear"), folder.summary("linearise"), model, folder.summary("equilibria"))


def sweep_files(judge, scene, folder):
    """Files of `sweep`."""
    rows, judge.file = folder.csv("sweep"), "sweep"
    if rows is not None:
        moving = [folder.csv(end) for end in ("run-i", "kinematics", "kinetostatics")]
        sweeps.judge_sweep(judge, scene, folder.scene_text, rows, folder.study(), folder.summary("sweep"), moving)


def copied_files(judge, scene, folder):
    """Files of `check`, `calibrate`, and the table of `reduce`."""
    tables = {end: folder.csv(end) for end in ("kinematics", "statics", "kinetostatics", "run-i", "motion", "reduced")}
    moving = [tables[end] for end in ("run-i", "kinematics", "kinetostatics")]
    summary, judge.file, name = folder.summary("check"), "check", scene.actuators[0].name if scene.actuators else ""
    if summary is not None:
        copies.judge_contents(judge, scene, summary, list(tables.values())[:5])
        if tables["reduced"] is not None:
            copies.judge_range(judge, summary, tables["reduced"], name)
    summary, judge.file = folder.summary("calibrate"), "calibrate"
    if summary is not None:
        copies.judge_calibration(judge, scene, folder.scene_text, summary, moving)
    path, judge.file = folder.path / f"{folder.name}.table", "table"
    if path.exists() and tables["reduced"] is not None:
        copies.judge_table(judge, path.read_text(encoding="utf-8"), tables["reduced"], name)


PARTS = [pose_files, motion_files, reduced_files, point_files, sweep_files, copied_files]


def audit(scene_path, folder_path, name=None):
    """Judges all files of a scene in a folder; none are found where the list of checks is empty."""
    judge, folder = Judge(), Folder(scene_path, folder_path, name)
    scene = Scene(folder.scene_text)
    for part in PARTS:
        judge.file = ""
        part(judge, scene, folder)
    return judge


def main():
    parser = argparse.ArgumentParser(prog="validation/audit", description=__doc__)
    parser.add_argument("scene", help="the scene file that the command was given")
    parser.add_argument("folder", help="the folder of its --out")
    parser.add_argument("--name", help="base name of the files, if it is not that of the scene")
    parser.add_argument("--json", help="also write all checks to this file")
    options = parser.parse_args()
    try:
        judge = audit(options.scene, options.folder, options.name)
    except Exception as error:  # whatever the files hold, the audit says that it cannot read them
        traceback.print_exc()
        print(f"cannot be read: {error!r}")
        return 2
    for line in judge.lines():
        print(line)
    if options.json:
        with open(options.json, "w", encoding="utf-8") as file:
            json.dump({"checks": judge.data(), "not_judged": judge.skipped}, file, indent=1)
    if not judge.checks:
        print("nothing to judge: the folder has no file of this scene")
        return 2
    return 1 if judge.has_failed else 0


if __name__ == "__main__":
    sys.exit(main())
