"""All commands on one scene, and the judgement of their files as JSON on standard output: `case.py PROGRAM SCENE`."""

import json
import sys
import tempfile
import traceback
from pathlib import Path

from files import Folder
from parts import judge_folder
from runs import prepare


def judged(program, scene):
    """The checks of all files in the folders of the commands, the files that were not judged, and those that could not be read."""
    checks, skipped, errors = [], [], []
    with tempfile.TemporaryDirectory(prefix="dwell-audit-") as folder:
        prepare(program, scene, folder)
        for made in sorted(Path(folder).iterdir()):
            text = next(made.glob("*.toml"))
            try:
                judge = judge_folder(Folder(str(text), str(made), None))
            except Exception as error:  # whatever the files hold, the audit says that it cannot read them
                traceback.print_exc()
                errors.append(f"{made.name}: cannot be read: {error!r}")
                continue
            checks += judge.data()
            skipped += judge.skipped
    return {"checks": checks, "not_judged": skipped, "errors": errors}


def main():
    program, scene = sys.argv[1:]
    print(json.dumps(judged(program, scene)))


if __name__ == "__main__":
    main()
