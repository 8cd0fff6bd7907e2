"""The page on a local address: loopback only, with a token of its own, until Ctrl-C."""

import secrets
import threading
import webbrowser
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import panel as pn
from bokeh.server.auth_provider import NullAuth
from tornado.ioloop import IOLoop
from tornado.web import RequestHandler

from contact_study.explore.draft import LARGEST_UPLOAD
from contact_study.explore.results import ResultsPage
from contact_study.explore.study_page import StudyPage

_HOST = "127.0.0.1"
_EVERY = 1500  # milliseconds between looks at the runs
_NIGHT = {"background": "#16191d", "background-text": "#e6e8eb", "surface": "#23272e", "surface-text": "#e6e8eb"}
_STYLE = f"""
:root {{ color-scheme: light dark; }}
@media (prefers-color-scheme: dark) {{ :root {{
  {" ".join(f"--design-{name}-color: {colour};" for name, colour in _NIGHT.items())} }} }}
body {{ background: var(--design-background-color, #fff); color: var(--design-background-text-color, #1b1e23);
  font-family: system-ui, sans-serif; max-width: 1700px; margin: 0 auto; padding: 4px 12px; }}
"""
_TAB = ".bk-tab.bk-active { color: inherit; font-weight: bold; }"  # as dark as the page in Bokeh's own style


class TokenAuth(NullAuth):
    """Lets in who has the token, once in the address, then in a cookie of this port."""

    def __init__(self, token: str):
        self.token = token
        super().__init__()

    @property
    def get_user(self) -> Any:
        def user(handler: RequestHandler) -> str | None:
            name = f"explore-{handler.request.host.rpartition(':')[2]}"
            shown = handler.get_argument("token", "") or handler.get_cookie(name) or ""
            if not secrets.compare_digest(shown.encode(), self.token.encode()):
                return None
            if handler.get_argument("token", "") and "Upgrade" not in handler.request.headers:
                handler.set_cookie(name, shown, httponly=True, samesite="Strict")
            return "owner"

        return user

    @property
    def login_url(self) -> str:
        return "/login"

    @property
    def login_handler(self) -> type[RequestHandler]:
        class Refused(RequestHandler):
            def get(self) -> None:
                self.set_status(403)
                self.finish("This page needs the address that the command printed, with its token.")

        return Refused


class Page:
    """The two halves in tabs: results, and a first study."""

    def __init__(self, paths: Sequence[Path], folder: Path):
        self.results = ResultsPage(paths, folder)
        self.study = StudyPage(folder, self._open)
        names = (("Results", self.results), ("A first study", self.study))
        self.tabs = pn.Tabs(*names, active=0 if paths else 1, sizing_mode="stretch_width")

    def _open(self, outputs: list[Path]) -> None:
        """Show the states that a run has so far."""
        if self.results.paths == outputs:
            self.results.refresh()
        else:
            self.results.open(outputs)
        self.tabs.active = 0


def page(paths: Sequence[Path], folder: Path) -> pn.viewable.Viewable:
    """The page for one tab of a browser."""
    made = Page(paths, folder)
    if pn.state.curdoc is not None:
        pn.state.add_periodic_callback(made.study.follow, _EVERY)
    return made.tabs


def serve(paths: Sequence[Path], folder: Path, port: int = 0, token: str | None = None) -> tuple[Any, str]:
    """Serve the page of some datasets and a folder; returns the running server and its address with the token.

    Parameters
    ----------
    paths : sequence of pathlib.Path
        Datasets to open at first.
    folder : pathlib.Path
        The one folder that the page reads from and writes to.
    port : int
        0 for a free one.
    token : str, optional
        Default: a random one.

    Returns
    -------
    bokeh.server.server.Server, str

    Raises
    ------
    OSError
        If the port is taken.
    """
    pn.extension(raw_css=[_STYLE], sizing_mode=None)
    pn.Tabs.stylesheets = [_TAB]
    token = token or secrets.token_urlsafe(24)
    options = {"address": _HOST, "port": port, "auth_provider": TokenAuth(token), "title": "bem-adhesion"}
    options |= {"websocket_max_message_size": 2 * LARGEST_UPLOAD, "show": False, "start": False}
    server = pn.io.server.get_server(lambda: page(paths, folder), **options)  # which takes no other origin
    server.start()
    return server, f"http://localhost:{server.port}/?token={token}"


def serve_until_interrupted(paths: Sequence[Path], folder: Path, port: int, browser: bool) -> None:
    """Serve the page, say where, open a browser if asked to, and return on Ctrl-C."""
    server, address = serve(paths, folder, port)
    print(f"{address}\nends with Ctrl-C; runs go on", flush=True)
    if browser:
        threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
    try:
        with suppress(KeyboardInterrupt):
            IOLoop.current().start()
    finally:
        server.stop()
