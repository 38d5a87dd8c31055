"""Figures of a stored analysis as objects, to view in a notebook, to change, or to save."""

import base64
import html
import io
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from extrados import kinds
from extrados.results.store import Stored
from extrados.results.verdict import SelfWeight
from extrados.show import style
from extrados.show.limit.self_weight import draw_self_weight


@dataclass(frozen=True)
class Drawn:
    """Figures of matplotlib by name, with their captions: `drawn["tilt-collapse"].savefig("a.pdf")`."""

    figures: dict[str, Figure]
    captions: dict[str, str]

    def __repr__(self) -> str:
        return f"<Drawn: {', '.join(self.figures) or 'nothing'}>"

    def __len__(self) -> int:
        return len(self.figures)

    def __iter__(self) -> Iterator[str]:
        return iter(self.figures)

    def __getitem__(self, name: str) -> Figure:
        if name not in self.figures:
            raise KeyError(f"the analysis has no figure '{name}'; its figures are {', '.join(self.figures) or 'none'}")
        return self.figures[name]

    def save(self, folder: str | Path, suffix: str = "png") -> list[Path]:
        """Write every figure into `folder` as NAME.SUFFIX; `suffix` is any format of matplotlib. Returns the files."""
        place = Path(folder)
        place.mkdir(parents=True, exist_ok=True)
        paths = [place / f"{name}.{suffix}" for name in self.figures]
        for path, figure in zip(paths, self.figures.values(), strict=True):
            figure.savefig(path)
        return paths

    def html(self, most: int | None = None) -> str:
        """The first `most` figures (default: all) with their captions as HTML; "" without figures."""
        return "".join(self._one(name) for name in list(self.figures)[:most])

    def _one(self, name: str) -> str:
        image = io.BytesIO()
        self.figures[name].savefig(image, format="png")
        data, told = base64.b64encode(image.getvalue()).decode(), html.escape(self.captions[name])
        return (
            f'<figure style="margin:6px 0"><img style="max-width:720px;width:100%" alt="{told}" '
            f'src="data:image/png;base64,{data}"><figcaption>{told}</figcaption></figure>'
        )

    def _repr_html_(self) -> str:
        return self.html()


def figures_of(run: Stored, name: str) -> Callable[[Stored, str, Path], list[tuple[str, str]]]:
    """What draws an analysis of a run by its name: the figures of its kind, or those of collapse under self-weight."""
    if isinstance(run[name], SelfWeight):
        return draw_self_weight
    return kinds.load(kinds.ANALYSES[run.analysis(name)["kind"]].figures)


def draw(run: Stored, name: str) -> Drawn:
    """The figures of an analysis of a run, empty for an analysis without arrays; KeyError if there is no such analysis."""
    row = run.analysis(name)
    if row["status"] not in ("ok", "interrupted") or row["kind"] not in kinds.ANALYSES or not run.arrays.get(name):
        return Drawn({}, {})
    with tempfile.TemporaryDirectory(prefix="extrados-") as scratch, style.kept() as figures:
        (Path(scratch) / "figures").mkdir()
        told = figures_of(run, name)(run, name, Path(scratch))
    return Drawn(figures, {figure: caption for figure, caption in told if figure in figures})
