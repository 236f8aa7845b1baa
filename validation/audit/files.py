"""The files of a command in a folder: tables, archives and summaries, by the ends of their names."""

import csv
import hashlib
import json
import tomllib
from pathlib import Path

import numpy as np


class Rows:
    """A table: columns of numbers and words by their names, with the unit of each."""

    def __init__(self, columns, units, words, label):
        self.columns, self.units, self.words, self.label = columns, units, words, label
        sizes = [len(values) for values in [*columns.values(), *words.values()]]
        self.count = min(sizes, default=0)

    def __contains__(self, name):
        return name in self.columns

    def get(self, name):
        """A column, or none."""
        return self.columns.get(name)

    def several(self, prefix, ends):
        """Columns side by side, shape (rows, columns); None if one is missing."""
        found = [self.columns.get(prefix + end) for end in ends]
        return None if any(column is None for column in found) else np.stack(found, axis=-1)

    def ending(self, end):
        """The columns with this ending, by their names without it."""
        return [(name.removesuffix(end), values) for name, values in self.columns.items() if name.endswith(end)]


def split_heading(heading):
    """`name [unit]`."""
    name, bracket, unit = heading.strip().rpartition(" [")
    return (name, unit.rstrip("]")) if bracket else (heading.strip(), "")


def number(text):
    return float(text) if text.strip() else np.nan


def read_csv(path, label):
    with open(path, newline="", encoding="utf-8") as file:
        lines = list(csv.reader(file))
    columns, units, words = {}, {}, {}
    for k, heading in enumerate(lines[0]):
        name, unit = split_heading(heading)
        texts = [line[k] if k < len(line) else "" for line in lines[1:]]
        try:
            columns[name] = np.array([number(text) for text in texts])
            units[name] = unit
        except ValueError:
            words[name] = texts
    return Rows(columns, units, words, label)


class Folder:
    """The files of a scene in a folder."""

    def __init__(self, scene_path, folder, name=None):
        scene_path, self.path = Path(scene_path), Path(folder)
        usual = scene_path.resolve().parent.name if scene_path.name == "scene.toml" else scene_path.stem
        self.name = name or usual
        self.tables = {}  # those that have been read
        self.scene_text = scene_path.read_text(encoding="utf-8")
        self.sha256 = hashlib.sha256(scene_path.read_bytes()).hexdigest()

    def file(self, end):
        return self.path / f"{self.name}-{end}"

    def csv(self, end):
        """A table, or none."""
        if end not in self.tables:
            path = self.file(f"{end}.csv")
            self.tables[end] = read_csv(path, end) if path.exists() else None
        return self.tables[end]

    def npz(self, end):
        """An archive by the names of its arrays, or none."""
        path = self.file(f"{end}.npz")
        if not path.exists():
            return None
        with np.load(path) as archive:
            return {name: archive[name] for name in archive.files}

    def summary(self, command):
        """The summary of a command, or none."""
        path = self.file(f"{command}.json")
        return json.loads(path.read_text(encoding="utf-8")) if path.exists() else None

    def text(self, end):
        path = self.path / f"{self.name}.table" if end == "table" else self.file(end)
        return path.read_text(encoding="utf-8") if path.exists() else None

    def study(self):
        """What a sweep is about, by the folder of its rows; empty without it."""
        parts = self.file("sweep") / "_study.toml"
        if parts.exists():
            return {key: str(value) for key, value in tomllib.loads(parts.read_text(encoding="utf-8")).items()}
        return {}

    def notes(self):
        """Notes on summaries that belong to another text of the scene than the one read."""
        for path in sorted(self.path.glob(f"{self.name}-*.json")):
            scene = json.loads(path.read_text(encoding="utf-8")).get("scene") or {}
            if scene.get("sha256") not in (None, self.sha256):
                yield f"note: {path.name} is of another text of the scene"


def result(summary, name):
    """A number of a summary's results; none where it is not there."""
    entry = (summary or {}).get("results", {}).get(name)
    if entry is None or entry.get("value") is None:
        return None
    value = entry["value"]
    return float(value) if not isinstance(value, str) else float(value.replace("NaN", "nan"))
