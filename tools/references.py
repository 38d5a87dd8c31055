"""Write the references of decks and results, and the facts that `extrados explain` reads, from their models."""

from pathlib import Path

from extrados.decks import explain as of_decks
from extrados.decks import manual as decks
from extrados.results import explain as of_results
from extrados.results import manual as results

DOCS = Path(__file__).resolve().parents[1] / "docs"


def main() -> None:
    """Four files."""
    tables, shapes = of_decks.facts(), of_results.everything()
    decks.STORED.write_text(decks.written(tables), encoding="utf-8")
    results.STORED.write_text(results.written(shapes), encoding="utf-8")
    (DOCS / "decks.md").write_text(decks.manual(tables) + "\n", encoding="utf-8")
    (DOCS / "results.md").write_text(results.manual(shapes) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
