"""Answers of a sweep kept beside the results folder while it runs, so that an interrupted one can go on."""

import json
import os
from pathlib import Path
from typing import Any


class Checkpoint:
    """Key -> answer, for one question; answers to another question are not taken over.

    Without a path nothing is kept. `save` writes to a temporary name and renames.
    """

    def __init__(self, path: Path | None, question: str, resume: bool):
        self.path = path
        self.question = question
        self.answers: dict[str, Any] = {}
        if path is not None and resume and path.is_file():
            try:
                found = json.loads(path.read_text(encoding="utf-8"))
            except (OSError, ValueError):
                return
            if isinstance(found, dict) and found.get("question") == question and isinstance(found.get("answers"), dict):
                self.answers = found["answers"]

    def save(self) -> None:
        if self.path is None:
            return
        self.path.parent.mkdir(parents=True, exist_ok=True)
        scratch = self.path.with_suffix(".new")
        with scratch.open("w", encoding="utf-8") as file:
            json.dump({"question": self.question, "answers": self.answers}, file)
            file.flush()
            os.fsync(file.fileno())
        scratch.replace(self.path)

    def done(self) -> None:
        """The sweep is over: nothing to resume."""
        if self.path is not None:
            self.path.unlink(missing_ok=True)
