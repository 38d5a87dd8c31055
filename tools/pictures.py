"""Make the pictures of the README, docs/pictures/*.png, by running decks of `cases/`: `make pictures`.

Each is a figure of one analysis; the page is photographed in chromium. They are kept in git, so that the README shows them without a
build; `make docs` draws all others. NAME makes that one alone.
"""

import io
import sys
from pathlib import Path

import matplotlib as mpl
from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
PLACE = ROOT / "docs" / "pictures"
#: Picture: deck, analysis, figure ("" is the first), axes shown (none: all), width in pixels
FIGURES: dict[str, tuple[str, str, str, tuple[int, ...], int]] = {
    "strip-arch": ("arch/readme", "tilt", "tilt-collapse", (0,), 560),
    "strip-house": ("building/two-rooms", "pushover", "pushover-space", (1, 2), 560),
}
#: The page: the deck that it opens
PAGE = "vault/vezelay-like"


def save(picture: Image.Image, name: str, width: int) -> None:
    """As PNG of 128 colours, at most `width` pixels wide."""
    if picture.width > width:
        picture = picture.resize((width, round(picture.height * width / picture.width)), Image.Resampling.LANCZOS)
    PLACE.mkdir(exist_ok=True)
    place = PLACE / f"{name}.png"
    picture.convert("RGB").quantize(128, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE).save(place, optimize=True)
    print(f"{place.relative_to(ROOT)}: {place.stat().st_size / 1e3:.0f} kB")


def draw(name: str) -> None:
    """The figure of a row of `FIGURES`."""
    import extrados

    case, analysis, figure, axes, width = FIGURES[name]
    run = extrados.run(ROOT / "cases" / f"{case}.toml")
    drawn = run.plot(analysis)
    chosen = drawn[figure or next(iter(drawn))]
    box: object = "tight"
    if axes:
        for k, other in enumerate(chosen.axes):
            other.set_visible(k in axes)
        for legend in chosen.legends:
            legend.set_visible(False)
        chosen.canvas.draw()
        seen = [chosen.axes[k].get_tightbbox() for k in axes]
        box = mpl.transforms.Bbox.union(seen).padded(8).transformed(chosen.dpi_scale_trans.inverted())
    held = io.BytesIO()
    chosen.savefig(held, format="png", dpi=140, bbox_inches=box)
    save(Image.open(held), name, width)


def photograph() -> None:
    """The interactive page with its deck, in chromium."""
    sys.path.insert(0, str(ROOT / "tests" / "browser"))
    from playwright.sync_api import sync_playwright
    from served import Served, chromium

    served = Served(ROOT, str(ROOT / "cases" / f"{PAGE}.toml"))
    try:
        with sync_playwright() as driver:
            browser = driver.chromium.launch(executable_path=chromium(), args=["--no-sandbox"])
            page = browser.new_context(viewport={"width": 1280, "height": 720}).new_page()
            page.goto(served.address)
            page.wait_for_selector("[data-handle]", timeout=60_000)
            page.wait_for_timeout(5_000)
            held = page.screenshot()
            browser.close()
    finally:
        served.close()
    save(Image.open(io.BytesIO(held)), "page", 1000)


def main() -> None:
    """All pictures, or those that are named."""
    for name in sys.argv[1:] or [*FIGURES, "page"]:
        photograph() if name == "page" else draw(name)


if __name__ == "__main__":
    main()
