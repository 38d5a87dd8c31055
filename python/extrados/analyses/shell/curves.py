"""The curves of a push, with their progress and the states that are kept on the way."""

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from extrados.analyses.batches import Chain
from extrados.analyses.context import Context
from extrados.analyses.shell.model import ShellModel
from extrados.analyses.shell.tables import Pushover
from extrados.analyses.sla.events import Curve, run_curves


def push_curves(context: Context, model: ShellModel, options: Pushover) -> list[Curve]:
    """The curves of all senses."""
    return run_curves(model, options, context.threads, progress_of(context, model, options), None, chains_of(context, model, options))


def chains_of(context: Context, model: ShellModel, options: Pushover) -> Callable[[Any], Chain]:
    """Where the states of a curve are kept on its way."""
    made = [np.concatenate([p.connect.ravel() for p in model.mesh.parts]), model.mesh.xyz, model.constant, model.reference]
    materials = [m.model_dump_json() for m in model.mesh.materials]
    thickness = [p.thickness for p in model.mesh.parts]

    def chain(of: Any) -> Chain:
        return Chain(context, "pushover", [options, of, model.freedoms, *made, materials, *thickness])

    return chain


def progress_of(context: Context, model: ShellModel, options: Pushover) -> Callable[[float, float, str], None]:
    """Progress by base shear over the weight, and how long the events that are allowed would take."""
    begun: list[tuple[float, float]] = []  # when the first batch ended, and its events: what came before is no event

    def tell(done: float, total: float, text: str) -> None:
        now = time.perf_counter()
        if not begun or done <= begun[0][1]:
            begun[:] = [(now, done)]
            context.progress(done, total, f"{text}; {model.weight / 1e3:.4g} kN weight, {model.mesh.elements()} elements")
            return
        left = (now - begun[0][0]) / (done - begun[0][1]) * max(total - done, 0.0)
        hours = f"{left / 3600:.1f} h" if left > 5400 else f"{left / 60:.0f} min" if left > 90 else f"{left:.0f} s"
        context.progress(done, total, f"{text}; {model.weight / 1e3:.4g} kN weight; about {hours} left")

    return tell
