"""The house of the page on frames as its report states it: walls out of plane on the first page, factors of the code in their table."""

from pathlib import Path

import pytest

import extrados
from extrados.show.report import write_report

pytestmark = pytest.mark.verify
DECK = Path(__file__).resolve().parents[2] / "cases" / "frame" / "farmhouse.toml"


def test_the_report_of_a_real_house(tmp_path):
    run = extrados.run(DECK, out=tmp_path)
    pushed = run.analyses[1]
    walls = pushed["results"]["out_of_plane"]
    assert walls["outcome"] == "collapses" and walls["factor"] < pushed["verdict"]["ratio"]
    # what governs is said in the verdict and in the answer, not among the numbers alone
    assert walls["statement"] in pushed["verdict"]["statement"] and walls["statement"] in pushed["answer"]
    write_report(tmp_path)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "The result includes no safety margin of a code" not in page  # the strengths are divided by 1.2
