"""The page as a widget of notebooks: the same modules, messages through the notebook's own channel, no server."""

import re
from pathlib import Path
from typing import Any

try:
    import anywidget
    import traitlets
except ImportError:
    raise ImportError('the page in a notebook requires anywidget: pip install "extrados[notebook]"') from None

from extrados.decks.reader import Deck
from extrados.explore.document import text_of
from extrados.explore.session import Session

STATIC = Path(__file__).parent / "static"
IMPORT = re.compile(r'from "\./([\w]+\.js)"')
LOADER = r"""
async function render({ model, el }) {
  const places = {};
  for (const [name, source] of model.get("modules")) {
    const text = source.replace(/from "\.\/(\w+\.js)"/g, (_, other) => `from "${places[other]}"`);
    places[name] = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
  }
  const [{ mount }, { unpack }] = await Promise.all([import(places["app.js"]), import(places["transport.js"])]);
  const shadow = el.attachShadow({ mode: "open" }), style = document.createElement("style"), root = document.createElement("div");
  style.textContent = model.get("look");
  root.className = "extrados";
  root.style.height = `${model.get("height")}px`;
  shadow.append(style, root);
  const transport = { open: true, onstate: () => {}, onreply: () => {}, close: () => {}, send(message) { model.send(message); return true; } };
  const app = mount(root, transport, "", { embedded: true });
  const take = (_, buffers) => {
    for (const b of buffers) transport.onreply(unpack(b.buffer ? b.buffer.slice(b.byteOffset, b.byteOffset + b.byteLength) : b));
  };
  model.on("msg:custom", take);
  transport.onstate("open");
  el.extrados = app;
  return () => model.off("msg:custom", take);
}
export default { render };
"""


def modules() -> list[tuple[str, str]]:
    """Names and sources of the page's modules, each after those that it imports."""
    sources = {p.name: p.read_text("utf-8") for p in STATIC.glob("*.js") if p.name not in ("main.js", "standalone.js")}
    ordered: dict[str, str] = {}

    def put(name: str) -> None:
        if name not in ordered:
            for other in IMPORT.findall(sources[name]):
                put(other)
            ordered[name] = sources[name]

    for name in sorted(sources):
        put(name)
    return list(ordered.items())


class Page(anywidget.AnyWidget):
    """The page; `deck` is the text of its deck, `session` what answers it."""

    _esm = LOADER
    modules: traitlets.List[Any] = traitlets.List().tag(sync=True)
    look = traitlets.Unicode().tag(sync=True)
    height = traitlets.Int(680).tag(sync=True)

    @classmethod
    def of(cls, deck: Path | Deck | None, height: int) -> "Page":
        """The page with a deck, a file or one in memory, or with a new arch; its folder is that of the deck, else the present one."""
        made = cls(modules=modules(), look=(STATIC / "style.css").read_text("utf-8"), height=height)
        if isinstance(deck, Path):
            place = deck.resolve()
            made.session = Session(place.parent, place.name)
        else:
            made.session = Session(Path.cwd() if deck is None else deck.folder)
            if deck is not None:
                made.session.first_text = text_of(deck.data)
        made.on_msg(made._answer)
        return made

    @property
    def deck(self) -> str:
        """The present text of the deck on the page."""
        return self.session.document.text

    def _answer(self, _: Any, message: Any, __: Any) -> None:
        if isinstance(message, dict) and "do" in message:
            for reply in self.session.answer(message):
                self.send({"to": message["do"]}, buffers=[reply.pack()])
