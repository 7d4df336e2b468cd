"""The workbench in a notebook cell, and the Python model linked to it."""

from __future__ import annotations

from functools import cache
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import Error
from moldloft.workbench.export import page_of, with_values
from moldloft.workbench.page import NO_ENGINE, engine_packed

if TYPE_CHECKING:
    from moldloft.models import Model

__all__ = ["ModelPage", "shown"]

#: What a page asks for in a frame: nothing of the notebook is in its reach.
_SANDBOX = "allow-scripts allow-downloads"

#: The script of the widget: the page comes as bytes, and is not kept with the notebook's state.
_SCRIPT = """
function render({ model, el }) {
  const frame = document.createElement('iframe')
  frame.setAttribute('sandbox', '__SANDBOX__')
  frame.setAttribute('title', model.get('title'))
  frame.style.cssText = `width: 100%; height: ${model.get('height')}px; border: 0`
  el.append(frame)
  const page = (message, buffers) => {
    if (message.kind === 'page') frame.srcdoc = new TextDecoder().decode(buffers[0])
  }
  // The text that both sides have: neither sends it back.
  let known = model.get('text')
  const tell = () => {
    if (model.get('text') === known) return
    known = model.get('text')
    frame.contentWindow.postMessage({ moldloft: 'text', text: known }, '*')
  }
  const heard = ({ source, data }) => {
    if (source !== frame.contentWindow) return
    if (data?.moldloft === 'ready') {
      known = null
      tell()
    }
    if (data?.moldloft !== 'text') return
    known = String(data.text)
    model.set('text', known)
    model.save_changes()
  }
  model.on('msg:custom', page)
  model.on('change:text', tell)
  addEventListener('message', heard)
  model.send({ kind: 'page' })
  return () => {
    model.off('msg:custom', page)
    model.off('change:text', tell)
    removeEventListener('message', heard)
  }
}
export default { render }
""".replace("__SANDBOX__", _SANDBOX)


class ModelPage:
    """The page of a model for a cell without widgets: interactive, without a link to Python.

    Parameters
    ----------
    page
        The page.
    title
        Name of the model.
    height
        Size of the cell, in pixels.
    """

    def __init__(self, page: bytes, title: str, height: int) -> None:
        self.page = page
        self._title = title
        self._height = height

    def _repr_html_(self) -> str:
        return (
            f'<iframe sandbox="{_SANDBOX}" title="{escape(self._title)}" '
            f'style="width: 100%; height: {self._height}px; border: 0" '
            f'srcdoc="{escape(self.page.decode())}"></iframe>'
        )

    def __repr__(self) -> str:
        return f"<the page of {self._title}>"


@cache
def _widget() -> Any:
    """The class of the widget, where anywidget is installed."""
    try:
        import anywidget
        import traitlets
    except ImportError:
        return None

    class ModelWidget(anywidget.AnyWidget):  # type: ignore[misc, unused-ignore]
        """The page of a model; its text is the model's."""

        _esm = _SCRIPT
        title = traitlets.Unicode("").tag(sync=True)
        height = traitlets.Int(600).tag(sync=True)
        text = traitlets.Unicode("").tag(sync=True)

        def __init__(self, model: Model, text: str, page: bytes, title: str, height: int) -> None:
            super().__init__(title=title, height=height, text=text)
            self._model = model
            self._page = page
            self.on_msg(self._asked)
            self.observe(self._followed, names="text")

        def _asked(self, _: Any, message: Any, __: Any) -> None:
            if isinstance(message, dict) and message.get("kind") == "page":
                self.send({"kind": "page"}, buffers=[self._page])

        def _followed(self, change: Any) -> None:
            _follow(self._model, change["new"])

        def refresh(self) -> None:
            """Show the current model, after a change in Python."""
            self.text = _spelled(self._model)

    return ModelWidget


def _origin(model: Model) -> tuple[str, Path | None, tuple[str, ...]]:
    """The name of a model, its folder, and further folders that it may read."""
    origin = model._origin
    if origin is None:
        return "model.sdl", None, ()
    folder = None if origin.folder is None else Path(origin.folder)
    return Path(origin.name).name, folder, origin.library


def _spelled(model: Model) -> str:
    """The text of a model with its current parameter values."""
    values = {p.name: p.value for p in model.params.values() if p.value != p.default}
    text = model.text
    if not values:
        return text
    name, folder, library = _origin(model)
    session = _core.Session(name, text, None if folder is None else str(folder), list(library))
    return with_values(session, text, values)


def _follow(model: Model, text: str) -> None:
    """Sets the text of a model and the values that it states."""
    if text == _spelled(model):
        return
    model.text = text
    model.set({p.name: p.default for p in model.params.values() if p.value != p.default})


def shown(model: Model, height: int, follow: bool) -> Any:
    """The page of a model for a cell: see :meth:`moldloft.Model.view`."""
    if engine_packed() is None:
        raise Error(f"nothing would move in the cell: {NO_ENGINE}")
    if model._origin is not None and model._origin.functions:
        names = ", ".join(sorted(model._origin.functions))
        raise Error(
            f"a page has no Python, and the model calls {names}: `model` at the end of a cell "
            "shows it as it is"
        )
    name, folder, library = _origin(model)
    text = _spelled(model)
    widget = _widget() if follow else None
    page = page_of(name, text, folder, library=library, cell=widget is not None)
    if widget is None:
        return ModelPage(page, name, height)
    return widget(model, text, page, name, height)


explain(globals())
