"""Which copy of the program computed a result."""

import contextlib
import platform
from datetime import datetime
from pathlib import Path

from extrados._build_info import BUILD_TYPE, C_COMPILER, COMMIT, COMPILER, VERSION


def provenance() -> dict[str, str]:
    """Version, commit ("-dirty" where files differ from it) and compilers of this copy."""
    return {"version": VERSION, "commit": _commit(), "compiler": f"{COMPILER}, {C_COMPILER}", "build_type": BUILD_TYPE}


def computed() -> dict[str, str]:
    """When and on which machine: the end of the computation as ISO 8601 with the zone, the name of the host."""
    return {"at": datetime.now().astimezone().isoformat(timespec="seconds"), "host": platform.node()}


def _commit() -> str:
    """The commit of a checkout of this project, or that from which an installed copy was built; "" if unknown.

    git is used only in a checkout of this project, since it would also find an unrelated repository above.
    """
    folder = Path(__file__).resolve().parents[1]
    root = folder.parents[1]
    if not (root / ".git").exists() or (root / "python" / "extrados") != folder:
        return COMMIT
    import subprocess

    with contextlib.suppress(OSError, subprocess.TimeoutExpired):
        answer = subprocess.run(
            ["git", "-C", str(root), "describe", "--always", "--dirty", "--exclude=*"], capture_output=True, text=True, timeout=5
        )
        return answer.stdout.strip() if answer.returncode == 0 else ""
    return ""
