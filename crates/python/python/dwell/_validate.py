"""The verification of an installation."""

from __future__ import annotations

import os
import shutil
import subprocess

from ._native import DwellError
from ._progress import Progress


def validate(
    *cases: str, repository: str | os.PathLike[str] = ".", folder: str | os.PathLike[str] = "reports", command: str = "dwell"
) -> str:
    """Runs ``dwell validate`` on the cases of a repository of Dwell, or on the named ones, against independent references; reports and the
    verification manual are written to ``folder``. Returns the printed summary. Raises DwellError with it if a finding fails.

    ``command`` is the installed command or its path: cases, references and pictures are not in this package.
    """
    arguments = [shutil.which(command) or command, "validate", *cases, "--out", os.path.abspath(folder)]
    environment = {**os.environ, "NO_COLOR": "1"}
    try:
        child = subprocess.Popen(
            arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment, cwd=repository
        )
    except OSError as error:
        raise DwellError(f"`{command}` cannot be run: {error}; install the command, or give its path as `command`") from None
    with Progress("validate") as progress, child:
        try:
            while True:
                try:
                    out, errors = child.communicate(timeout=0.2)
                    break
                except subprocess.TimeoutExpired:
                    progress(0, 0)
        except BaseException:
            child.terminate()
            raise
    if child.returncode != 0:
        raise DwellError(f"\n{out}{errors.strip()}")
    return out
