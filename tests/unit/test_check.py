"""`check` and `run` refuse alike: the same complaint, with the line of the key that is to blame."""

import re
from pathlib import Path
from typing import Any

import pytest

import extrados
from extrados import room
from extrados.analyses.context import Context
from extrados.analyses.needs import complaints
from extrados.analyses.sequence import run_one
from extrados.decks.reader import Deck, DeckError, read_deck
from extrados.running.check import check_building
from extrados.running.run import compute

CASES = Path(__file__).resolve().parents[2] / "cases"
ARCH = '[structure]\nkind = "arch"\nradius = 10.0\nthickness = 1.5\nembrace = 157.5\nvoussoirs = 7\n'
BLOCK = '[structure]\nkind = "block"\nwidth = 1.0\nheight = 4.0\n'
STACK = '[structure]\nkind = "stack"\nlower_width = 1.0\nlower_height = 2.0\nupper_width = 0.8\nupper_height = 2.0\n'
FRAME = '[structure]\nkind = "blocks"\nblock = [{ name = "pier", points = [[0, 0], [1, 0], [1, 3], [0, 3]] }]\n'
PULSE = '[motion]\nkind = "step-pulse"\namplitude = "0.5 g"\nduration = 0.2\n'
PANEL = '[structure]\nkind = "panel"\nwidth = 1.0\nheight = 1.0\nthickness = 0.1\n[material]\ntensile_strength = "0.2 MPa"\nfracture_energy = 50.0\n'
TILT = '[[analysis]]\nkind = "tilt"\n'
ROCKING = '[[analysis]]\nkind = "rocking"\n'
DEM = '[[analysis]]\nkind = "dem"\nend_time = 0.02\n'
SLA = '[[analysis]]\nkind = "sla"\nevents = 3\n'
PUSH = '[[analysis]]\nkind = "pushover"\nevents = 3\nmesh.layers = 3\n'
HOUSE = '[structure]\nkind = "building"\nstoreys = [2.0]\nwalls = [{ name = "a", start = [0, 0], end = [1, 0], thickness = 0.3 }]\n' + PUSH
#: Four walls around a floor, two storeys; what is wrong with it is put in by its own lines
ROOMS = (
    '[structure]\nkind = "building"\nstoreys = [3.0, 3.0]\nwalls = [\n'
    '  { name = "a", start = [0, 0], end = [3, 0], thickness = 0.3 },\n  { name = "b", start = [3, 0], end = [3, 3], thickness = 0.3 },\n'
    '  { name = "c", start = [3, 3], end = [0, 3], thickness = 0.3 },\n  { name = "d", start = [0, 3], end = [0, 0], thickness = 0.3 },\n]\n'
)
WALL = '[structure]\nkind = "building"\nstoreys = [3.0]\n[[structure.walls]]\nname = "a"\nstart = [0, 0]\nend = [3, 0]\nthickness = 0.3\n'
STEEL = '[materials.steel]\nyoung = "200 GPa"\n'
TIE = "[[ties]]\nstart = [-9.5, 3.0]\nground = [0.0, 0.0]\n"
GENERATED = '[motion]\nkind = "generated"\nmmi = 8\nduration = 15\n'
FRAGILITY = '[[analysis]]\nkind = "fragility"\ncount = 4\nlevels = ["0.1 g"]\n'
FACADE = '[[analysis]]\nkind = "local-mechanism"\nmechanism = "facade"\nheight = 6\nthickness = 0.5\n'


#: What is wrong, the words of the complaint, and a deck whose wrong line ends in "# here"
WRONG = {
    "tie in no stone": ("no block is at", ARCH + "[[ties]]\nstart = [0.0, 1.0] # here\nground = [0.0, 0.0]\n" + TILT),
    "tie in no stone, rocking": (
        "no block is at",
        ARCH + PULSE + "[[ties]]\nstiffness = 1e6\nstart = [0.0, 1.0] # here\nground = [0.0, 0.0]\n" + ROCKING,
    ),
    "both ends of a tie in one stone": ("both ends of the tie", BLOCK + "[[ties]] # here\nstart = [-0.2, 1.0]\nend = [0.2, 2.0]\n" + TILT),
    "tie of an unknown stone": (
        "block 'none' does not exist",
        ARCH + '[[ties]]\nstart = [0.0, 1.0]\nstart_stone = "none" # here\nground = [0.0, 0.0]\n' + TILT,
    ),
    "rigid tie of what rocks": (
        "requires a stiffness",
        BLOCK + PULSE + "[[ties]] # here\nstart = [0.2, 2.0]\nground = [3.0, 0.0]\n" + ROCKING,
    ),
    "hinge at an unknown joint": (
        "joint 'sole' does not exist",
        ARCH + PULSE + '[[hinges]]\ndamping = 1e3\njoints = ["sole"] # here\n' + ROCKING,
    ),
    "dampers with tilt": (
        "cannot include [[dampers]]",
        BLOCK + "[[dampers]] # here\nstart = [0.2, 2.0]\nground = [3.0, 0.0]\ndamping = 1e3\n" + TILT,
    ),
    "wall with tilt": ("cannot include [supports] abutting_wall", BLOCK + '[supports]\nabutting_wall = "left" # here\n' + TILT),
    "start against a wall": (
        "cannot start with a rotation to the left",
        BLOCK + PULSE + '[supports]\nabutting_wall = "left"\n[initial]\nrotation_ratio = -0.1 # here\n' + ROCKING,
    ),
    "mesh that is not there": ("none.msh", '[structure]\nkind = "mesh"\nfile = "none.msh" # here\nthickness = 0.1\n' + SLA),
    "outline that is not there": (
        "none.dxf",
        '[structure]\nkind = "panel"\noutline = "none.dxf" # here\nthickness = 0.1\n' + SLA + 'mesh.element = "T3"\nmesh.size = 0.2\n',
    ),
    "linear form of an arch": ("applies to blocks", ARCH + PULSE + ROCKING + 'form = "linear" # here\n'),
    "block that slides off its slope": ("overturns", BLOCK.replace("[structure]\n", "[structure]\nbase_slope = 30 # here\n") + TILT),
    "typo in a variant": ("unknown key", BLOCK + '[[analysis]]\nkind = "failure-curves"\nvariants = [{ widht = 2.0 }] # here\n'),
    "missing hazard file": ("no such file", BLOCK + GENERATED + FRAGILITY + '[analysis.hazard]\nfile = "none.csv" # here\n'),
    "unit of a hazard curve": (
        "'m' is not a unit",
        BLOCK + GENERATED + FRAGILITY + '[analysis.hazard]\nintensities = ["0.1 m", "0.2 m"] # here\nannual_rates = [0.1, 0.01]\n',
    ),
    "unit of levels": ("'m' is not a unit", BLOCK + GENERATED + FRAGILITY.replace('"0.1 g"]', '"0.1 m"] # here')),
    "uncertain value of another structure": (
        "has no value of this name",
        BLOCK + GENERATED + FRAGILITY + "uncertain = { radius = 0.1 } # here\n",
    ),
    "movement of an unknown joint, rocking": (
        "joint 'none'",
        BLOCK + PULSE + '[[initial.movements]]\njoint = "none" # here\ndx = 0.1\n' + ROCKING,
    ),
    "movement of an unknown joint, dem": ("joint 'none'", BLOCK + PULSE + '[[initial.movements]]\njoint = "none" # here\ndx = 0.1\n' + DEM),
    "movement of an unknown joint, supports": (
        "joint 'none'",
        ARCH + '[[initial.movements]]\njoint = "none" # here\ndx = 0.1\n[[analysis]]\nkind = "supports"\n',
    ),
    "movement in the analysis": ("joint 'none'", BLOCK + PULSE + DEM + '[[analysis.initial.movements]]\njoint = "none" # here\ndx = 0.1\n'),
    "moving supports and fragility": (
        "supports that move",
        BLOCK + GENERATED + '[[initial.movements]] # here\njoint = "base"\ndx = 0.1\n' + FRAGILITY,
    ),
    "unknown joint of a type": ("does not exist", ARCH + '[[joints.types]]\njoints = ["none"] # here\nfriction = 0.3\n' + TILT),
    "load beside the structure": (
        "lies outside the structure",
        ARCH + TILT + "[[analysis.load]]\nx = 0.0\nforce = 1e3\n[[analysis.load]] # here\nx = 99.0\nforce = 1e3\n",
    ),
    "chain of another name": ("'nave' does not exist", ARCH + '[[analysis]]\nkind = "thrust"\nchain = "nave" # here\n'),
    "sweep of no key": ("has no key 'widht'", BLOCK + '[[analysis]]\nkind = "sweep"\nvary = "widht" # here\nstart = 1\nstop = 2\n'),
    "sweep in another unit": (
        "'kN' is not a unit of m",
        BLOCK + '[[analysis]]\nkind = "sweep"\nvary = "width"\nstart = 1\nstop = "2 kN" # here\n',
    ),
    "survey without its table": ("none.csv", ARCH + '[[analysis]]\nkind = "survey"\nfile = "none.csv" # here\n'),
    "fracture without a buttress": ("requires a buttress", ARCH + TILT + "fracture = true # here\n"),
    "train too wide": ("exceeds the depth", ARCH + '[[analysis]]\nkind = "moving-load"\nwidth = 9.0 # here\n'),
    "imperfections without a tolerance": ("give the key `deviation`", ARCH + '[[analysis]] # here\nkind = "imperfections"\n'),
    "supports at rest": ("no support moves", ARCH + '[[analysis]] # here\nkind = "supports"\nspread = 0\n'),
    "block to follow": ("no block has the name 'none'", BLOCK + DEM + 'track = ["none"] # here\n'),
    "bars of a block": ("is only for arches", BLOCK + PULSE + DEM + 'merge = "three-bars" # here\n'),
    "record that is not there": ("none.at2", BLOCK + '[motion] # here\nkind = "record"\nfile = "none.at2"\n' + ROCKING),
    "suite that is not there": (
        "none of the 1 records",
        BLOCK + '[motion] # here\nkind = "suite"\nfiles = ["none.at2"]\n' + FRAGILITY.replace("count = 4", "count = 1"),
    ),
    "record of dem": ("none.at2", BLOCK + '[motion] # here\nkind = "record"\nfile = "none.at2"\n' + DEM),
    "curve that is not there": ("none.csv", PANEL + SLA + 'measured = "none.csv" # here\n'),
    "seeds that change nothing": ("`seeds` require", PANEL + SLA + "seeds = [1, 2] # here\n"),
    "run that is not there": ("results", PANEL + SLA + 'resume_from = "results" # here\n'),
    "load beside the wall": ("no node lies", PANEL + SLA + '[[analysis.reference]] # here\nkind = "point"\nx = 7.0\nfx = 1.0\n'),
    "hold beside the wall": (
        "no node near",
        PANEL + SLA + '[[analysis.stages]]\n[[analysis.stages.reference]]\nkind = "gravity"\nax = "1 g"\nay = "0 g"\n'
        "[[analysis.stages.hold]] # here\nx = 7.0\ny = 7.0\n",
    ),
    "stage that is not there": (
        "stage 'two' does not exist",
        PANEL + SLA + 'main_stage = "two" # here\n[[analysis.stages]]\nname = "one"\n'
        '[[analysis.stages.reference]]\nkind = "gravity"\nax = "1 g"\nay = "0 g"\n',
    ),
    "no stages": ("expected at least 1", PANEL + SLA + "stages = [] # here\n"),
    "opening beside its wall": ("the length of the wall is 3 m", WALL + "openings = [{ x = [2, 4], z = [0, 2] }] # here\n" + PUSH),
    "opening above its storey": ("does not fit in a storey", WALL + "openings = [{ x = [1, 2], z = [2, 5] }] # here\n" + PUSH),
    "opening of no width": ("requires a width", WALL + "openings = [{ x = [1, 1], z = [0, 2] }] # here\n" + PUSH),
    "opening as wide as a hair": ("expected more than", WALL + "openings = [{ x = [1, 1.0000001], z = [0, 2] }] # here\n" + PUSH),
    "opening in no storey": ("has no storey 2", WALL + "openings = [{ storey = 2, x = [1, 2], z = [0, 2] }] # here\n" + PUSH),
    "opening through a whole wall": (
        "is not supported",
        WALL.replace("[[structure.walls]]", "[[structure.walls]] # here") + "openings = [{ x = [0, 3], z = [1, 2] }]\n" + PUSH,
    ),
    "lintel over the top": (
        "under 1 m of wall",
        WALL + "openings = [{ x = [1, 2], z = [0, 2], lintel = { depth = 1.5 } }] # here\n" + PUSH,
    ),
    "lintel in an opening": (
        "lies entirely within openings",
        WALL.replace("[[structure.walls]]", "[[structure.walls]] # here")
        + "openings = [{ x = [1, 2], z = [0, 1], lintel = { depth = 0.3 } }, { x = [1, 2], z = [1, 2] }]\n"
        + PUSH,
    ),
    "wall without thickness": ("greater than 0", WALL.replace("thickness = 0.3", "thickness = 0.0 # here") + PUSH),
    "wall thicker than the Earth": ("not a plausible size", WALL.replace("thickness = 0.3", "thickness = 1e308 # here") + PUSH),
    "wall that is nowhere": ("finite number", WALL.replace("start = [0, 0]", "start = [0, nan] # here") + PUSH),
    "wall of no length": (
        "the same position",
        WALL.replace("start = [0, 0]\n", "start = [0, 0] # here\n").replace("[3, 0]", "[0, 0]") + PUSH,
    ),
    "wall in the air": (
        "is not supported",
        WALL.replace("[3.0]", "[3.0, 3.0]")
        + '[[structure.walls]] # here\nname = "b"\nstart = [0, 5]\nend = [3, 5]\nthickness = 0.3\nstoreys = [2, 2]\n'
        + PUSH,
    ),
    "two walls of one name": (
        "occurs twice",
        WALL + '[[structure.walls]]\nname = "a" # here\nstart = [0, 5]\nend = [3, 5]\nthickness = 0.3\n' + PUSH,
    ),
    "floor without walls": ("do not form a simple ring", WALL + '[[structure.floors]] # here\nstorey = 1\nkind = "rigid"\n' + PUSH),
    "floor between walls that do not meet": (
        "do not form a simple ring",
        ROOMS.replace("end = [3, 0]", "end = [2.5, 0]") + '[[structure.floors]] # here\nstorey = 1\nkind = "rigid"\n' + PUSH,
    ),
    "floor around walls in no order": (
        "'a' and 'c' do not meet",
        ROOMS + '[[structure.floors]] # here\nstorey = 1\nkind = "rigid"\nwalls = ["a", "c", "b", "d"]\n' + PUSH,
    ),
    "floor that names a wall twice": (
        "occurs twice",
        ROOMS + '[[structure.floors]]\nstorey = 1\nkind = "rigid"\nwalls = ["a", "b", "a"] # here\n' + PUSH,
    ),
    "floor twice": (
        "for the same walls",
        ROOMS + '[[structure.floors]]\nstorey = 1\nkind = "rigid"\n[[structure.floors]] # here\nstorey = 1\nkind = "rigid"\n' + PUSH,
    ),
    "floor above its wall": (
        "has no masonry at the level of the floor",
        ROOMS.replace('"a", start', '"a", storeys = [1, 1], start')
        + '[[structure.floors]] # here\nstorey = 2\nkind = "rigid"\nwalls = ["a", "b", "c", "d"]\n'
        + PUSH,
    ),
    "floor above the building": ("storey 3 does not exist", ROOMS + '[[structure.floors]]\nstorey = 3 # here\nkind = "rigid"\n' + PUSH),
    "joists from a wall to itself": (
        "two different walls",
        ROOMS + '[[structure.floors]]\nstorey = 1\nkind = "joists"\nyoung = 1e10\njoist_area = 0.01\njoist_spacing = 0.5\n'
        'bears_on = ["a", "a"] # here\n' + PUSH,
    ),
    "joists along their wall": (
        "no joist spans",
        ROOMS + '[[structure.floors]] # here\nstorey = 1\nkind = "joists"\nyoung = 1e10\njoist_area = 0.01\njoist_spacing = 0.5\n'
        'bears_on = ["a", "b"]\n' + PUSH,
    ),
    "corner of walls that do not meet": ("do not meet", ROOMS + '[[structure.corners]] # here\nwalls = ["a", "c"]\nbond = "open"\n' + PUSH),
    "corner of one wall": ("occurs twice", ROOMS + '[[structure.corners]]\nwalls = ["a", "a"] # here\nbond = "open"\n' + PUSH),
    "corner twice": (
        "the same two walls",
        ROOMS
        + '[[structure.corners]]\nwalls = ["a", "b"]\nbond = "open"\n[[structure.corners]]\nwalls = ["b", "a"] # here\nbond = "weak"\n'
        + PUSH,
    ),
    "rod beside the building": (
        "from the nearest node",
        ROOMS + '[[structure.rods]] # here\nstart = [9, 9, 3]\nend = [0, 0, 3]\narea = 1e-4\nmaterial = "steel"\n' + STEEL + PUSH,
    ),
    "prestress above its wall": ("has no storey 5", ROOMS + '[[structure.prestress]]\nwall = "a"\nforce = 1e4\nlevel = 5 # here\n' + PUSH),
    "beam beside its wall": (
        "is not on wall 'a', whose length is 3 m",
        ROOMS + '[[structure.prestress]]\nwall = "a"\nforce = 1e4\nx = [2.5, 3.5] # here\n' + PUSH,
    ),
    "ring beam through a window": (
        "opening 1 at x 1 to 2 m reaches 2.9 m",
        WALL
        + 'openings = [{ x = [1, 2], z = [1, 2.9] }]\n[[structure.ring_beams]]\nstorey = 1\ndepth = 0.2 # here\nmaterial = "steel"\n'
        + STEEL
        + PUSH,
    ),
    "two ring beams of one wall": (
        "wall 'a' has ring beam 1 on storey 1 already",
        ROOMS
        + '[[structure.ring_beams]]\nstorey = 1\ndepth = 0.2\nmaterial = "steel"\n'
        + '[[structure.ring_beams]]\nstorey = 1\ndepth = 0.3\nmaterial = "steel"\nwalls = ["a"] # here\n'
        + STEEL
        + PUSH,
    ),
    "ring beam of nothing": (
        "no [materials.gold]",
        ROOMS + '[[structure.ring_beams]] # here\nstorey = 1\ndepth = 0.2\nmaterial = "gold"\n' + PUSH,
    ),
    "materials of two storeys of three": (
        "3 materials for 1 storeys",
        WALL + 'materials = ["steel", "steel", "steel"] # here\n' + STEEL + PUSH,
    ),
    "prop above its wall": ("has no storey 3", ROOMS + '[[structure.props]]\nwall = "a"\nstorey = 3 # here\n' + PUSH),
    "too many shells": ("are allowed", ROOMS + PUSH.replace("mesh.layers = 3", "mesh = { size = 1e-5, layers = 3 } # here")),
    "drive on no wall": ("wall 'b' does not exist", HOUSE + 'drives = [{ wall = "b", storey = 1 }] # here\n'),
    "ground under no foot": (
        "foot 'middle' does not exist",
        ARCH + PUSH + '[[analysis.stages]]\n[[analysis.stages.settlements]] # here\nfoot = "middle"\nout = 0.01\n',
    ),
    "piers without a strength": ("compressive_strength", HOUSE + "[analysis.frame] # here\ndiagonal_strength = 5e4\n"),
    "mesh of shells that is not there": ("none.msh", '[structure]\nkind = "mesh"\nthickness = 0.3\nfile = "none.msh" # here\n' + PUSH),
    "speed of no film": ("requires animation", ARCH + TILT + "animation_speed = 0.5 # here\n"),
    "wall without a load": (
        "give `axial_load`",
        PANEL + 'compressive_strength = "2 MPa"\n' + '[[analysis]] # here\nkind = "code-checks"\n',
    ),
    "frequencies the wrong way": ("is not above", '[[analysis]]\nkind = "shake-table"\nlowest = 30\nhighest = 20 # here\n'),
    "energy ratio of an arch": ("`energy_ratio` is only for a block", ARCH + PULSE + "[joints]\nenergy_ratio = 0.5 # here\n" + ROCKING),
    "energy ratio of spectra": ("square root", PULSE + '[joints]\nenergy_ratio = 0.5 # here\n[[analysis]]\nkind = "rocking-spectrum"\n'),
    "spectra on a soft base": (
        "rigid ground",
        PULSE + '[supports]\nstiffness = "10 MPa/m" # here\n[[analysis]]\nkind = "rocking-spectrum"\n',
    ),
    "base too soft": ("overturns under its own weight", BLOCK + PULSE + "[supports]\nstiffness = 1e3 # here\n" + ROCKING),
    "durations of one pulse": ("'generated'", BLOCK + PULSE + '[[analysis]]\nkind = "fragility"\ncount = 1\ndurations = [1, 2] # here\n'),
    "more motions than there are": ("give at most 1", BLOCK + PULSE + '[[analysis]]\nkind = "fragility"\ncount = 4 # here\n'),
    "buttress of an arch": (
        "requires a buttress",
        ARCH + '[[analysis]]\nkind = "sweep"\nvary = "thickness"\nstart = 1\nstop = 2\nbuttress_alone = true # here\n',
    ),
    "ties in space": ("each point of a tie requires [x, y, z]", ARCH + TIE.replace("3.0]", "3.0] # here") + TILT + "direction = 10\n"),
    "loads in space": ("acts at a point", ARCH + TILT + "direction = 10\n[[analysis.load]] # here\nx = 0.0\nforce = 1e3\n"),
    "crushing in space": (
        "thrust of solids",
        ARCH + '[material]\ncompressive_strength = "5 MPa" # here\n[[analysis]]\nkind = "thrust"\ndirection = 10\n',
    ),
    "mortar of a section": ("only for blocks in space", ARCH + "[joints]\ncohesion = 1e4\n" + TILT + 'mortar = "ductile" # here\n'),
    "floors of an arch": ("has no floors", ARCH + PUSH + '[[analysis.variants]]\nname = "stiff"\nfloors = 2.0 # here\n'),
    "springs under rigid contacts": (
        "cannot follow a compliant base",
        ARCH + PULSE + "[supports]\nstiffness = 1e9 # here\n" + DEM + 'solver = "nonsmooth"\n',
    ),
    "first swings of solids": (
        "dem of solids cannot include mode_II",
        BLOCK + '[[analysis]]\nkind = "dem-domain"\ndirection = 10\nmode_II = true # here\n'
        'amplitudes = ["0.5 g"]\ndurations = [0.1, 0.2]\n',
    ),
    "movements of rigid solids": (
        "dem of solids cannot include rotation of a support",
        ARCH
        + "[[initial.movements]]\njoint = 'joint 0'\nturn = 1 # here\n"
        + DEM
        + 'solver = "nonsmooth"\nquasi_static = true\ndirection = 10\n',
    ),
    "restitution of many blocks": ("only to a single block", ARCH + PULSE + '[joints]\ndamping = "restitution" # here\n' + DEM),
    "facade without its thickness": (
        "requires thickness",
        '[[analysis]] # here\nkind = "local-mechanism"\nmechanism = "facade"\nheight = 6\n',
    ),
    "mechanism of no building": ("requires a [structure]", '[[analysis]]\nkind = "local-mechanism"\nmechanism = "building" # here\n'),
    "corner that turns above its top": (
        "not below the top",
        '[[analysis]]\nkind = "local-mechanism"\nmechanism = "corner"\nheight = 6\nthickness = 0.5\ncrack_angle = 30\n'
        "hinge_height = 7 # here\n",
    ),
    "floor above the top": ("above the top", FACADE + "[[analysis.floors]]\nload = 1e3\nheight = 30 # here\n"),
    "side walls of a corner": (
        "does not use `side_walls`",
        FACADE.replace('"facade"', '"corner"') + "crack_angle = 30\nside_walls = { thickness = 0.5, crack_angle = 20 } # here\n",
    ),
    "facade without weight": ("has no weight", "[material]\ndensity = 0.0 # here\n" + FACADE),
    "block without weight": ("has no weight", BLOCK + "[material]\ndensity = 0.0 # here\n" + TILT),
    "arch without weight that rocks": ("has no weight", ARCH + PULSE + "[material]\ndensity = 0.0 # here\n" + ROCKING),
    "arch without weight, discrete elements": ("has no weight", ARCH + PULSE + "[material]\ndensity = 0.0 # here\n" + DEM),
}


def refused(deck: Deck) -> list[str]:
    """What a run says of the analyses that it refuses."""
    return [result.reason for result in compute(Context(deck)).results if result.status == "refused"]


@pytest.mark.parametrize("wrong", WRONG)
def test_check_and_run_say_the_same(tmp_path: Path, wrong: str) -> None:
    words, text = WRONG[wrong]
    path = tmp_path / "deck.toml"
    path.write_text(text)
    line = 1 + next(k for k, row in enumerate(text.splitlines()) if "# here" in row)
    try:
        deck = read_deck(path)
    except DeckError as error:
        said = error.complaints
    else:
        said = check_building(deck).complaints
        assert refused(deck) == ["; ".join(said)]
    assert len(said) == 1 and said[0].startswith(f"{path}:{line}: ") and words in said[0], said
    key = said[0].removeprefix(f"{path}:{line}: ").split(": ")
    assert key[0].rsplit(".", 1)[-1] != key[1], "the key stands once"


#: What only a run finds
WHILE_RUNNING = {
    "no line at that gamma": ("no thrust line is admissible", ARCH + '[[analysis]]\nkind = "thrust"\ngamma = 2.0 # here\n'),
    "a pier that is crushed": (
        "crushes the pier",
        PANEL + 'compressive_strength = "1 MPa"\n[[analysis]]\nkind = "code-checks"\naxial_load = "1 MN" # here\n',
    ),
    "a ratio that what cracks keep exceeds": ("1e+12 is too large", PANEL + SLA + "mechanism_ratio = 1e12 # here\n"),
}


@pytest.mark.parametrize("wrong", WHILE_RUNNING)
def test_what_a_run_refuses_has_its_line_too(tmp_path: Path, wrong: str) -> None:
    words, text = WHILE_RUNNING[wrong]
    path = tmp_path / "deck.toml"
    path.write_text(text)
    line = 1 + next(k for k, row in enumerate(text.splitlines()) if "# here" in row)
    (said,) = refused(read_deck(path))
    assert said.startswith(f"{path}:{line}: ") and words in said, said


def test_a_second_assessment_is_refused(tmp_path: Path) -> None:
    """It alone: the first goes on."""
    path = tmp_path / "deck.toml"
    path.write_text(ARCH + PULSE + 2 * '[[analysis]]\nkind = "assess"\n')
    deck = read_deck(path)
    (said,) = check_building(deck).complaints
    assert said.startswith(f"{path}:13: ") and "only one analysis of kind assess" in said
    assert run_one(Context(deck), deck.analyses[1], deck.buildings[1]).reason == said


def test_every_complaint_at_once(tmp_path: Path) -> None:
    """Two ties and two analyses: every complaint once, and what is sound goes on."""
    path = tmp_path / "deck.toml"
    path.write_text(
        ARCH
        + "[[ties]]\nstart = [0.0, 1.0]\nground = [0.0, 0.0]\n[[ties]]\nstart = [0.0, 2.0]\nground = [0.0, 0.0]\n"
        + PULSE
        + ROCKING
        + '[[analysis]]\nkind = "thrust"\nchain = "nave"\n'
        + '[[analysis]]\nkind = "motion"\n'
    )
    deck = read_deck(path)
    said = check_building(deck).complaints
    assert [line.split(":")[1] for line in said] == ["8", "11", "21"]
    assert [result.status for result in compute(Context(deck)).results] == ["refused", "refused", "ok"]


@pytest.mark.parametrize("path", [p for p in sorted(CASES.rglob("*.toml")) if not p.name.endswith(".expect.toml")], ids=lambda p: p.stem)
def test_what_runs_is_ok(path: Path) -> None:
    """Every deck of the cases runs (tests/cases), so that `check` must say nothing against it."""
    assert check_building(read_deck(path)).complaints == []


TOO_LONG = r"analysis\.output_step: a history of 1e\+08 s in steps of \S+ s is too long to store: give an `output_step` of at least \S+ s$"


@pytest.mark.parametrize(
    ("analysis", "words"),
    [
        ({"kind": "dem", "end_time": 1e8}, TOO_LONG),
        ({"kind": "rocking", "end_time": 1e8}, TOO_LONG),
        (
            {"kind": "fragility", "count": 1_000_000, "levels": [0.001 * k for k in range(1, 501)], "uncertain": {"width": 0.05}},
            r"analysis\.count: 1,000,000 motions or buildings at 500 levels, 5e\+08 runs, requires about 450 GB .*at most \d+ runs fit",
        ),
    ],
    ids=lambda one: one["kind"] if isinstance(one, dict) else "",
)
def test_what_does_not_fit_into_memory_is_refused_before_it_runs(
    analysis: dict[str, Any], words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(room, "total", lambda: 24_000_000_000)
    deck = {
        "structure": {"kind": "block", "width": 1.0, "height": 4.0},
        "motion": {"kind": "sine-pulse", "amplitude": "0.1 g", "period": 0.5},
        "analysis": [analysis],
    }
    found = extrados.run(deck)
    row = found.analyses[0]
    assert row["status"] == "refused" and re.search(words, row["reason"]), row["reason"]
    assert row["seconds"] < 60.0


def test_long_analyses_are_foretold(tmp_path: Path) -> None:
    """Runs, memory, disk and time: by `check`, and by `run` before anything else."""
    levels = ", ".join(f"{0.01 * k:.2f}" for k in range(1, 51))
    path = tmp_path / "deck.toml"
    path.write_text(
        '[structure]\nkind = "block"\nwidth = 0.1\nheight = 0.4\n[motion]\nkind = "generated"\nmmi = 8\nduration = 1.0\n'
        f'[analysis]\nkind = "fragility"\ncount = 10000\nlevels = [{levels}]\n'
    )
    words = r"fragility of 10,000 motions or buildings at 50 levels requires 5e\+05 runs: about 0\.0\d+ GB of memory, 0\.\d+ GB of disk and \S+ (s|min|h)$"
    (said,) = check_building(read_deck(path)).foretold
    assert re.match(words, said), said

    class Begun(Exception):
        pass

    def tell(text: str) -> None:
        raise Begun(text)

    with pytest.raises(Begun) as told:
        complaints(context := Context(read_deck(path), out=tmp_path / "out", tell=tell), context.deck.analyses[0], context.building)
    assert re.match(words, str(told.value))
    path.write_text(path.read_text().replace("10000", "100"))
    assert check_building(read_deck(path)).foretold == []
