"""What calls of several rooms of the core are given: a square, a force on it, and the type of a list of calls."""

from collections.abc import Callable
from typing import Any

import numpy as np

#: Functions and the keys that they are called with
Calls = list[tuple[Callable[..., Any], dict[str, Any]]]

BOX = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
PUSH = np.zeros((4, 2))
PUSH[2, 0] = 1e3
