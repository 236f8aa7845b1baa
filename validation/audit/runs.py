"""Scenes with a motion and all requests, and the commands of the program on them, for `case.py` and the self-test."""

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

from scene import Scene


AMPLITUDES = (0.25, 0.2, 0.15, 0.1)  # of a prescribed motion that the scene does not give, rad or parts of its size


def without_section(text, name):
    """A scene's text without a section and its subsections."""
    lines, kept, inside = text.splitlines(keepends=True), [], False
    for line in lines:
        header = re.match(r"\s*\[([A-Za-z_][^\]\[,=]*)\]\s*(#.*)?$", line)
        if header:
            inside = header.group(1) == name or header.group(1).startswith(f"{name}.")
        if not inside:
            kept.append(line)
    return "".join(kept)


def forced(text):
    """The scene with a prescribed motion of every actuator, if it prescribes none."""
    scene = Scene(text)
    if "prescribed" in scene.keys or "coordinate-sweep" in scene.keys:
        return text
    added = "\n[prescribed]\nduration = 1.0\n"
    for k, actuator in enumerate(scene.actuators):
        part = AMPLITUDES[k % len(AMPLITUDES)]
        amplitude = part / scene.angle if actuator.measure.is_angle else part * scene.size / scene.length
        added += f'[prescribed."{actuator.name}"]\nsinusoid = {{ amplitude = {float(amplitude)!r}, period = 1.0 }}\n'
    return text + added


def options(kind, command):
    """The number of positions: without a prescribed motion `kinematics` has those of `reduce`."""
    points = "721" if (kind, command) == ("plain", "kinematics") else "361" if command == "kinetostatics" else "181"
    known = {"cycle": ("--fluctuation", "0.02"), "reduce": ("--table-accuracy", "1e-7")}
    return ("--points", points) if command in ("kinematics", "kinetostatics", "statics") else known.get(command, ())


def toml_text(value, top=True):
    """A scene as TOML, all of it in inline tables."""
    if isinstance(value, dict):
        pairs = [f"{json.dumps(key, ensure_ascii=False)} = {toml_text(inner, False)}" for key, inner in value.items()]
        return "\n".join(pairs) + "\n" if top else "{ " + ", ".join(pairs) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(toml_text(inner, False) for inner in value) + "]"
    return json.dumps(value, ensure_ascii=False) if not isinstance(value, float) else repr(float(value))


def requested_sections(scene):
    """Requests for internal forces of two links, appended to a scene in the plane. They change no column."""
    if not scene.is_plane:
        return ""
    links = [(b.name, *list(b.points)[:2]) for b in scene.bodies if b.mass > 0.0 and len(b.points) > 1]
    lines = [f'{{ body = "{body}", from = "{start}", to = "{end}" }}' for body, start, end in links[:2]]
    return f"\n[requests]\nsections = [{', '.join(lines)}]\n" if lines else ""


def run(program, command, scene, folder, *options):
    """Runs a command; returns its status and its output."""
    pictures = [] if command == "check" else ["--pictures", "none"]
    arguments = [str(program), command, str(scene), *options, "--out", str(folder), *pictures]
    done = subprocess.run(arguments, capture_output=True, text=True, check=False, env=environment())
    return done.returncode, done.stdout, done.stderr


def environment():
    return {**os.environ, "RAYON_NUM_THREADS": "1"}


def prepare(program, scene_path, folder):
    """Writes the files of all commands on a scene to the folders `forced`, `plain` and `free`, each with its scene."""
    scene_path, folder = Path(scene_path), Path(folder)
    name = scene_path.parent.name if scene_path.name == "scene.toml" else scene_path.stem
    text = without_section(scene_path.read_text(encoding="utf-8"), "requests")
    texts = {"forced": forced(text) + requested_sections(Scene(text)), "plain": text}
    made = []
    for kind, commands in (("forced", ("kinematics", "kinetostatics")), ("plain", PLAIN)):
        here = folder / f"{name}-{kind}"
        here.mkdir(parents=True, exist_ok=True)
        (here / f"{name}.toml").write_text(texts[kind], encoding="utf-8")
        for command in commands:
            status, _, _ = run(program, command, here / f"{name}.toml", here, *options(kind, command))
            if command == "reduce" and status == 2:  # not every mechanism has a table
                status, _, _ = run(program, command, here / f"{name}.toml", here)
            made.append((kind, command, status))
    scene = Scene(text)
    vary = varied_masses(scene)
    if vary and len(scene.actuators) == 1:
        options_of_sweep = (*vary, "--samples", "12", "--seed", "7", "--result", "m", "--export", "csv")
        status, _, _ = run(program, "sweep", folder / f"{name}-plain" / f"{name}.toml", folder / f"{name}-plain", *options_of_sweep)
        made.append(("plain", "sweep", status))
    return made


def varied_masses(scene):
    """Sweep options for up to three masses: with a normal distribution, a uniform distribution and a grid."""
    masses = [(body.name, body.mass / scene.mass) for body in scene.bodies if body.mass > 0.0 and not body.is_ground]
    kinds = (lambda m: f"~normal({m!r},{0.03 * m!r})", lambda m: "±5%", lambda m: f"={0.8 * m!r}:{1.3 * m!r}:3")
    return [part for (body, mass), kind in zip(masses, kinds) for part in ("--vary", f"{body}.mass{kind(float(mass))}")]


PLAIN = ("check", "kinematics", "statics", "reduce", "runs", "simulate", "cycle", "equilibria", "linearise", "calibrate")


def remove(folder):
    shutil.rmtree(folder)
