"""Assigns the checks to the files."""

import copies
import kinematics
import linear
import motions
import points
import poses
import reduced
import repeated
import sections
import sweeps
import wanted
from judge import Judge
from motion import Motion, Unplaced
from scene import Scene


def whole_file(judge, scene, folder, rows, end, command, corners=(), of_positions=None):
    """The checks of every table: its archive, its headings, and the extrema of its summary, away from corners."""
    repeated.archive(judge, rows, folder.npz(end))
    abscissa = "t" if "t" in rows else scene.actuators[0].name if scene.actuators else ""
    repeated.ascends(judge, rows, abscissa)
    if summary := folder.summary(command):
        repeated.summary_of_table(judge, rows, summary)
    repeated.headings(judge, scene, rows)
    repeated.extrema(judge, rows, folder.summary(command), corners, corners if of_positions is None else of_positions)


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
        kinematics.closure(judge, motion)
        kinematics.laws(judge, motion, "prescribed")
        corners = [c for law, _ in scene.laws("prescribed").values() for c in law.corners]
        kinematics.between_rows(judge, rows, corners + kinematics.switch_times(motion))
        over = ((folder.summary(command) or {}).get("extrema_over") or {}).get("name", "t")
        corners = corners if over == "t" else []
        places = [kinematics.switch_places(motion, rows.get(over), of_forces) if over in rows else [] for of_forces in (True, False)]
        whole_file(judge, scene, folder, rows, command, command, *(corners + p for p in places))
        wanted.positions(judge, scene, rows, folder.summary(command), command == "statics")
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
    wanted.motion(judge, scene, rows, events, summary)
    if summary is not None:
        motions.judge_summary(judge, scene, rows, events, summary)
        motions.events_are_met(judge, scene, rows, events, summary)


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
            kinematics.closure(judge, motion)
            kinematics.between_rows(judge, run, kinematics.switch_times(motion))
            whole_file(judge, scene, folder, run, run.label, run.label)
            repeated.quotients(judge, motion)
            reduced.uniform(judge, run, scene.actuators[0].name)
            poses.equilibrium(judge, motion, is_loaded=False)
    if runs is not None:
        judge.file = "runs"
        whole_file(judge, scene, folder, runs, "runs", "runs")
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
        elif prefix:
            points.without_flywheel(judge, summary)
    table, summary, judge.file = folder.csv("equilibria"), folder.summary("equilibria"), "equilibria"
    if table is not None:
        repeated.archive(judge, table, folder.npz("equilibria"))
        points.judge_equilibria(judge, scene, table, summary, model, folder.csv("statics"))
    text, judge.file = folder.text("linear.csv"), "linear"
    if text is not None:
        linear.judge_linear(judge, scene, text, folder.npz("linear"), folder.summary("linearise"), model, folder.summary("equilibria"))


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
    text, judge.file = folder.text("table"), "table"
    if text is not None and tables["reduced"] is not None:
        copies.judge_table(judge, text, tables["reduced"], name)


PARTS = [pose_files, motion_files, reduced_files, point_files, sweep_files, copied_files]


def judge_folder(folder):
    """Judges all files of a scene in a folder. The list of checks is empty if there are no files."""
    judge, scene = Judge(), Scene(folder.scene_text)
    for part in PARTS:
        judge.file = ""
        part(judge, scene, folder)
    return judge
