"""The independent reader and judge of the files of the commands: `python3 validation/audit SCENE FOLDER`."""

import argparse
import json
import sys
import tomllib
import traceback

try:
    import numpy  # noqa: F401  (the reader needs it everywhere)
except ImportError:
    print("the audit needs NumPy: python3 -m pip install numpy", file=sys.stderr)
    sys.exit(2)

from files import Folder
from parts import judge_folder


def main():
    parser = argparse.ArgumentParser(prog="validation/audit", description=__doc__)
    parser.add_argument("scene", help="the scene file that the command was given")
    parser.add_argument("folder", help="the folder of its --out")
    parser.add_argument("--name", help="base name of the files, if it is not that of the scene")
    parser.add_argument("--json", help="also write all checks to this file")
    options = parser.parse_args()
    try:
        folder = Folder(options.scene, options.folder, options.name)
        judge = judge_folder(folder)
    except OSError as error:
        print(f"cannot be read: {error.filename}: {error.strerror}")
        return 2
    except tomllib.TOMLDecodeError as error:
        print(f"cannot be read: {options.scene}: {error}")
        return 2
    except Exception as error:  # whatever the files hold, the audit says that it cannot read them
        traceback.print_exc()
        print(f"cannot be read: {error!r}")
        return 2
    for line in judge.lines():
        print(line)
    for line in folder.notes():
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
