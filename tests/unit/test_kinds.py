"""The entries of kinds.py are complete: every part of every kind loads and is of its sort."""

import inspect
from pathlib import Path

import pytest

from extrados import kinds
from extrados.analyses.assess import strategies
from extrados.analyses.table import Analysis
from extrados.explore.handles import KindHandles
from extrados.model.structure import Structure
from extrados.results.typed import shapes
from extrados.results.validity import Validity
from extrados.results.verdict import KindResults
from extrados.schema.table import Table
from extrados.show.charts import Shown

CASES = Path(__file__).resolve().parents[2] / "cases"
#: View -> what its maker is given
GIVEN = {"blocks": 1, "piers": 1, "solids": 1, "rigid": 3, "rocker": 2, "mesh": 3, "shell": 2}


def takes(place: str, count: int) -> None:
    """The function at a place takes so many arguments."""
    inspect.signature(kinds.load(place)).bind(*range(count))


@pytest.mark.parametrize("section", kinds.TABLES)
def test_a_table_is_called_by_its_kind(section: str) -> None:
    for kind in kinds.TABLES[section]:
        made = kinds.table(section, kind)
        assert issubclass(made, Table) and made.model_fields["kind"].annotation.__args__ == (kind,)


@pytest.mark.parametrize("kind", kinds.STRUCTURES)
def test_a_structure_has_each_view_or_a_reason(kind: str) -> None:
    parts = kinds.STRUCTURES[kind]
    assert issubclass(kinds.load(parts.table), Structure)
    views = {
        "blocks": parts.blocks,
        "piers": parts.piers,
        "solids": parts.solids,
        "rigid": parts.rigid,
        "rocker": parts.rocker,
        "mesh": parts.mesh,
        "shell": parts.shell,
    }
    assert set(views) == set(GIVEN)
    for name, view in views.items():
        if isinstance(view, kinds.Lacks):
            assert len(view.reason) > 20, name
        else:
            takes(view, GIVEN[name])
    assert parts.handles is None or isinstance(kinds.load(parts.handles), KindHandles)


@pytest.mark.parametrize("kind", kinds.ANALYSES)
def test_an_analysis_has_all_its_parts(kind: str) -> None:
    parts = kinds.ANALYSES[kind]
    assert issubclass(kinds.load(parts.table), Analysis)
    takes(parts.needs, 2)
    takes(parts.driver, 2)
    assert all(issubclass(model, KindResults) for model in shapes(kind))
    assert isinstance(kinds.load(parts.validity), Validity)
    takes(parts.figures, 3)
    assert kinds.load(parts.page) is getattr(Shown, parts.page.partition(".")[2].partition(".")[2])
    assert (CASES / parts.example).exists()
    assert parts.strategies == tuple(s.name for s in strategies.ALL if s.kind == kind)
