"""The page of results: a question at the left, datasets and their menus; at the right the state that answers it."""

import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import panel as pn
import xarray as xr
from bokeh.events import RangesUpdate, Tap

from contact_study.campaign.dataset.export import table_of
from contact_study.explore import figure_code, pictures
from contact_study.explore.selection import (
    LoadPath,
    fields_of,
    in_words,
    load_path,
    nearest_point,
    state_of,
    sweep_menus,
)
from contact_study.inputs.errors import InputError
from contact_study.physics.force_curves.curve import read_force_curve
from contact_study.plots.maps import Colouring
from contact_study.report.read.lazy import Model, open_models

_KEPT = "kept state"
_MAPS = {"gap": "gap", "contact": "contact", "pressure": "pressure", "patches": "clusters", "heights": "height"}
_MEASURED = (".csv", ".txt", ".dat", ".ibw", ".jpk-force", ".h5")
_TABS = (pictures.CURVES, pictures.DISTRIBUTIONS)
_INK = " ".join(f"{name}: var(--design-background-text-color, #1b1e23);" for name in pictures.INKS)
_LOOK = f":host {{ {_INK} {pictures.GROUND} }}"
_STEP = 700  # milliseconds of a state while the page plays


def results_page(paths: Sequence[Path], folder: Path) -> "ResultsPage":
    """The page of some datasets, and of those that a user chooses from a folder.

    Parameters
    ----------
    paths : sequence of pathlib.Path
        Datasets, or outputs of unfinished runs, to open at first.
    folder : pathlib.Path
        Where to look for others.

    Returns
    -------
    ResultsPage
        A viewable of Panel, whose parts ``menus`` and ``answer`` may also stand apart.

    Raises
    ------
    InputError
        If a path leads to no dataset.

    Examples
    --------
    >>> from pathlib import Path
    >>> page = results_page([Path("bem.nc")], Path.cwd())  # doctest: +SKIP
    """
    return ResultsPage(paths, folder)


class ResultsPage(pn.viewable.Viewer):
    """See :func:`results_page`; :meth:`open` shows other datasets, :meth:`refresh` what a run has written since."""

    def __init__(self, paths: Sequence[Path], folder: Path):
        super().__init__()
        self.folder, self.paths, self.models = folder, list[Path](), dict[str, Model]()
        self.kept: tuple[str, xr.Dataset, int] | None = None  # words, case and step of a state to compare with
        self.ends: figure_code.Ends | None = None  # of the section
        self.held: Colouring | None = None  # colours of all states
        self._shown: dict[str, Any] = {}  # pictures by their keys
        self._views: dict[str, Callable[..., Any]] = {}  # of the maps, for a window
        self._known: tuple[Any, dict[str, xr.Dataset], dict[str, LoadPath]] | None = None
        self._drawn: Any = None  # the cases whose curves are drawn
        self._busy = False
        select = partial(pn.widgets.Select, sizing_mode="stretch_width")
        self.files = pn.widgets.MultiChoice(name="Datasets", options={}, sizing_mode="stretch_width")
        self.sweep = pn.Column(sizing_mode="stretch_width", margin=0)
        self.lead, self.field = select(name="Model of the maps"), select(name="Map")
        self.hold = pn.widgets.Checkbox(name="Same colour limits for all states")
        self.keep = pn.widgets.Button(name="Keep this state to compare", sizing_mode="stretch_width")
        self.beside = select(name="Compare with", options={"nothing": ""})
        self.how = select(name="Show", options=["side by side", "difference"])
        self.measured = select(name="Measured force curve")
        self.load = pn.widgets.IntSlider(name="State on the loading path", start=0, end=1, show_value=False)
        self.load.sizing_mode = "stretch_width"
        self.play = pn.widgets.Toggle(name="▶ Play", width=90, align="end")
        self.words, self.fault = pn.pane.HTML(margin=(0, 10)), pn.pane.HTML(styles={"color": "#d0342c"})
        self.pictures = pn.FlexBox(sizing_mode="stretch_width", gap="4px 12px")
        exports = (
            pn.widgets.FileDownload(
                callback=partial(self._exported, kind), filename=f"view.{kind}", label=words, width=105, icon=None
            )
            for kind, words in (("png", "PNG"), ("svg", "SVG"), ("csv", "Table"), ("py", "Python"))
        )
        more = pn.Column(
            self.hold, self.keep, self.beside, self.how, self.measured, margin=0, sizing_mode="stretch_width"
        )
        self.menus = pn.Column(self.files, self.sweep, self.lead, self.field, more, pn.FlexBox(*exports), width=250)
        self.answer = pn.Column(pn.Row(self.load, self.play), self.fault, self.words, self.pictures, min_width=600)
        self.answer.sizing_mode = "stretch_width"
        self._playing = pn.state.add_periodic_callback(self._advance, _STEP, start=False)
        self._offer()
        self.open(paths)
        for widget in (self.lead, self.beside, self.how, self.measured, self.field, self.load, self.hold):
            widget.param.watch(self._show, "value")
        self.files.param.watch(self._chose, "value")
        self.play.param.watch(lambda event: self._playing.start() if event.new else self._playing.stop(), "value")
        self.keep.on_click(self._keep)

    def __panel__(self) -> pn.viewable.Viewable:
        return pn.Row(self.menus, self.answer, sizing_mode="stretch_width")

    def open(self, paths: Sequence[Path]) -> None:
        """Show these datasets in place of those before."""
        models = open_models(paths)
        self.paths, self.models, self._known = list(paths), models, None
        before = self.chosen
        self.sweep.clear()
        for key, words in sweep_menus(models).items():
            value = before.get(key) if before.get(key) in words.values() else next(iter(words.values()))
            menu = pn.widgets.Select(name=key.replace("_", " "), options=words, value=value, tags=[key])
            menu.sizing_mode = "stretch_width"
            menu.param.watch(self._show, "value")
            self.sweep.append(menu)
        names = {model.entry.label: name for name, model in models.items()}
        lead = self.lead.value if self.lead.value in models else next(iter(models), None)
        self._set(self.files, options=self.files.options | {path.name: path for path in paths}, value=self.paths)
        self._set(self.lead, options=names, value=lead, visible=len(names) > 1)
        self._shown, self.held, self._drawn = {}, None, None
        if lead is not None and len(self.sweep):
            self._go_to_states(models[lead].dataset["relative_contact_area"].notnull())
        self._show()

    def _go_to_states(self, known: xr.DataArray) -> None:
        """Choose the first point of the sweep with states, where that chosen has none, as an unfinished run may not."""
        menus = {menu.tags[0]: menu for menu in self.sweep if menu.tags[0] in known.dims}
        there = known.any([dim for dim in known.dims if dim not in menus]).transpose(*menus)
        if there.any() and not there.sel({dim: menu.value for dim, menu in menus.items()}):
            first = np.unravel_index(int(there.values.argmax()), there.shape)
            for (dim, menu), number in zip(menus.items(), first, strict=True):
                self._set(menu, value=next(one for one in menu.options.values() if one == there[dim].values[number]))

    def refresh(self) -> None:
        """Read again what is shown, as a run may have written further states; the last state stays the last."""
        last = self.load.value == self.load.end
        self._offer()
        self.open(self.paths)
        if last:
            self.load.value = self.load.end

    @property
    def chosen(self) -> dict[str, Any]:
        """Values of the swept keys."""
        return {menu.tags[0]: menu.value for menu in self.sweep}

    def _offer(self) -> None:
        found = {str(path.relative_to(self.folder)): path for path in figure_code.datasets_in(self.folder)}
        self._set(self.files, options=found)
        curves = sorted(path for path in self.folder.iterdir() if path.suffix in _MEASURED)
        self._set(self.measured, options={"none": None, **{path.name: path for path in curves}}, visible=bool(curves))

    def _set(self, widget: Any, **values: Any) -> None:
        """Change a widget without drawing."""
        before, self._busy = self._busy, True
        widget.param.update(**values)
        self._busy = before

    def _show(self, event: Any = None) -> None:
        """Show the state that the widgets choose."""
        if self._busy:
            return
        if event is not None and event.obj in (self.field, self.hold, self.how):
            self.held = None
        elif event is not None and event.obj is self.measured:
            self._drawn = None
        elif event is not None and event.obj is self.lead:  # whose cell may have other proportions
            self._shown = {key: picture for key, picture in self._shown.items() if not key.startswith("map")}
        before = list(self._shown)
        try:
            self._show_state()
            self.fault.object = ""
        except (InputError, ValueError, OSError) as error:
            self._complain(error)
        if list(self._shown) != before or not before:
            self._lay_out()

    def _complain(self, error: Exception) -> None:
        self.fault.object = f'<div role="alert">{escape(str(error))}</div>'

    def _cases(self) -> tuple[dict[str, xr.Dataset], dict[str, LoadPath]]:
        """The case of each model at the chosen point of the sweep, and its path; kept until another is chosen."""
        key = tuple(self.chosen.values())
        if self._known is None or self._known[0] != key:
            cases = {name: model.case(self.chosen) for name, model in self.models.items()}
            paths = {name: load_path(case) for name, case in cases.items() if case is not None}
            paths = {name: path for name, path in paths.items() if path.steps.size}
            self._known = key, {name: case for name, case in cases.items() if case is not None and name in paths}, paths
        return self._known[1:]

    def _show_state(self) -> None:
        cases, paths = self._cases()
        lead = self.lead.value
        if lead not in cases:
            raise ValueError("no state: the model has no such point of the sweep, or its run has not come so far")
        last = paths[lead].steps.size - 1
        place = min(self.load.value, last)
        self._set(self.load, end=max(1, last), value=place, name=f"State {place + 1} of {last + 1}")
        places = {name: path.nearest(paths[lead], self.load.value) for name, path in paths.items()}
        places[lead] = self.load.value
        steps = {name: int(paths[name].steps[place]) for name, place in places.items()}
        lines = [in_words(self.models[name], cases[name], paths[name], place) for name, place in places.items()]
        self.words.object = f'<div role="status" aria-live="polite">{"<br>".join(map(escape, lines))}</div>'
        fields = {words: name for words, name in _MAPS.items() if name in fields_of(cases[lead])}
        known = self.field.value in fields.values() and {*fields.values()} == {*self.field.options.values()}
        field = self.field.value if known else next(iter(fields.values()), None)  # a run has gaps after heights
        self._set(self.field, options=fields, value=field, visible=bool(fields))
        others = {self.models[name].entry.label: name for name in cases if name != lead and fields_of(cases[name])}
        others = {"nothing": "", **others} | ({self.kept[0]: _KEPT} if self.kept else {})
        beside = self.beside.value if self.beside.value in others.values() else ""
        self._set(self.beside, options=others, value=beside, visible=len(others) > 1)
        for widget, seen in ((self.how, beside), (self.keep, fields), (self.hold, fields)):
            widget.visible = bool(seen)
        if field is not None:
            self._show_maps(cases, steps, field, beside)
        if self._drawn is not cases:  # curves are those of a case, not of a state
            self._drawn, measured = cases, [read_force_curve(self.measured.value)] if self.measured.value else []
            for kind in pictures.CURVES:
                if (view := pictures.curve_view(cases, kind, measured)) is not None:
                    self._picture(kind, view, pictures.CurvePicture)
        for kind in pictures.CURVES.keys() & self._shown.keys():
            self._shown[kind].now.data = pictures.states_now(self._shown[kind].view, places)
        for of in _TABS[1]:
            if (density := pictures.density_view(cases, steps, of)) is not None:
                self._picture(of, density, partial(pictures.CurvePicture, size=(380, 140)))

    def _show_maps(self, cases: Mapping[str, xr.Dataset], steps: Mapping[str, int], field: str, beside: str) -> None:
        lead, title = self.lead.value, next(words for words, name in _MAPS.items() if name == field).capitalize()
        state = state_of(cases[lead], steps[lead], field, "section")
        self.state, shown = state, {title: (state, None)}
        if beside == _KEPT and self.kept is not None:
            words, case, step = self.kept
        elif beside:
            words, case, step = self.models[beside].entry.label, cases[beside], steps[beside]
        if beside:
            other = state_of(case, step, field)
            if self.how.value == "difference":
                shown = {f"{title} minus that of {words}": (state, other)}
            else:
                shown[f"{title}: {words}"] = other, None
        found = {}
        for number, (one, minus) in enumerate(shown.values()):
            key = f"map{number}"
            self._views[key] = partial(pictures.map_view, one, field, minus=minus)
            found[key] = self._views[key](window=self._shown[key].window if key in self._shown else None)
        looks = [view.look for view in found.values()]
        own = replace(max(looks, key=lambda look: look.high), low=min(look.low for look in looks))
        self.held = (self.held or own) if self.hold.value else None
        for (key, view), title in zip(found.items(), shown, strict=True):
            picture = self._picture(key, view.within(self.held or own), partial(pictures.MapPicture, title=title))
            picture.figure.title.text = title
        if len(found) == 1:
            self._shown.pop("map1", None)
        if "height" in state and "gap" in state:
            self._picture("section", pictures.section_view(state, self.ends), pictures.SectionPicture)

    def _picture(self, key: str, view: Any, make: Callable[[Any], Any]) -> Any:
        """The picture of a key with this view; made, and connected, where there is none."""
        if key in self._shown:
            self._shown[key].show(view)
            return self._shown[key]
        picture = self._shown[key] = make(view)
        picture.figure.stylesheets = [_LOOK]
        picture.pane = pn.pane.Bokeh(picture.figure, margin=0)
        if key in pictures.CURVES:
            picture.figure.on_event(Tap, partial(self._tapped, key))
        elif key.startswith("map"):
            picture.figure.on_event(RangesUpdate, partial(self._zoomed, key))
            picture.line.on_change("data", lambda _, __, line: self._cut(line, picture.view.lengths.size))
        return picture

    def _lay_out(self) -> None:
        """Place the pictures: maps, curves in tabs, section, distributions in tabs."""
        panes = {key: one.pane for key, one in self._shown.items()}
        tabs = [[(words, panes[key]) for key, words in names.items() if key in panes] for names in _TABS]
        maps = [pane for key, pane in panes.items() if key.startswith("map")]
        section = [panes["section"]] if "section" in panes else []
        curves, densities = (pn.Tabs(*own, margin=0) for own in tabs)
        self.pictures[:] = [*maps, curves, *section, densities]

    def _zoomed(self, key: str, _: Any) -> None:
        """Show the part of a map in view with as many points as it has."""
        picture = self._shown[key]
        picture.show(self._views[key](window=picture.window).within(picture.view.look))

    def _cut(self, line: Mapping[str, Sequence[float]], unit: float) -> None:
        """Show the section along a line that was drawn on a map."""
        if len(line["x"]) == 2:
            (x0, x1), (y0, y1) = (tuple(float(one) * unit for one in line[axis]) for axis in "xy")
            if (x0, y0) != (x1, y1):
                self.ends = (y0, x0), (y1, x1)
                self._shown["section"].show(pictures.section_view(self.state, self.ends))

    def _tapped(self, kind: str, event: Tap) -> None:
        """Go to the state of the model of the maps that is nearest to a click on a curve."""
        states = self._shown[kind].view.sources["states"]
        own = [n for n, model in enumerate(states["model"]) if model == self.lead.value]
        x, y = (np.array(states[axis])[own] for axis in "xy")
        found = nearest_point(x, y, (event.x, event.y), (np.ptp(x) or 1.0, np.ptp(y) or 1.0)) if own else None
        if found is not None:
            self.load.value = states["place"][own[found]]

    def _chose(self, event: Any) -> None:
        if not self._busy:
            try:
                self.open(event.new)
            except InputError as error:
                self._complain(error)

    def _keep(self, _: Any) -> None:
        cases, paths = self._cases()
        path, name = paths[self.lead.value], self.lead.value
        self.kept = f"kept: {path.words[self.load.value]}", cases[name], int(path.steps[self.load.value])
        self._show()

    def _advance(self) -> None:
        self.load.value = self.load.value + 1 if self.load.value < self.load.end else 0

    def _exported(self, kind: str) -> Any:
        cases, paths = self._cases()
        name = self.lead.value
        if kind == "csv":
            frames = {name: table_of(case) for name, case in cases.items()}
            joined = pd.concat([frame.assign(model=name) for name, frame in frames.items()])
            return io.StringIO(joined.set_index("model").to_csv())
        step, field = int(paths[name].steps[self.load.value]), self.field.value if self.field.visible else None
        chosen = {key: value for key, value in self.chosen.items() if key in self.models[name].dataset.dims}
        code = figure_code.figure_code(self.models[name], chosen, step, field, self.ends)
        return io.StringIO(code) if kind == "py" else figure_code.drawn(code, self.models[name], kind)
