"""Piers, spandrels and rigid nodes of walls on a plan."""

import numpy as np
import pytest

from extrados.decks.reader import read_deck
from extrados.views.frame.options import FrameOptions
from extrados.views.frame.rules import Side, deformable

WINDOW, DOOR, FREE = Side(0.9, 2.3), Side(0.0, 2.2), Side()
