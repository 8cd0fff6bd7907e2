"""The page of a study: its keys at the left; at the right what the checks and the theories say, and its runs."""

import asyncio
import base64
import io
from collections.abc import Callable
from functools import partial
from html import escape
from pathlib import Path
from typing import Any

import panel as pn
from matplotlib import rc_context
from matplotlib.figure import Figure

from contact_study.campaign.model import WORDS
from contact_study.explore import draft, runs
from contact_study.inputs.errors import InputError
from contact_study.plots.densities import draw_roughness
from contact_study.plots.maps import draw_heights
from contact_study.plots.style import STYLE, pressure_unit
from contact_study.study.examples import example, example_names
from contact_study.study.schema.dotted_keys import SECTIONS
from contact_study.study.schema.keys import Key
from contact_study.study.study import Study, make_study

# Bulk values that textbooks give for orientation; a user's own go beyond them.
_MATERIALS = {
    "rubber (PDMS)": ("2 MPa", "0.495"),
    "polystyrene": ("3.2 GPa", "0.34"),
    "glass": ("70 GPa", "0.22"),
    "gold": ("78 GPa", "0.42"),
    "silicon": ("160 GPa", "0.22"),
    "steel": ("205 GPa", "0.29"),
}
_MARKS = {"good": ("●", "#2a8a3e", "good"), "fair": ("▲", "#c27a00", "mind"), "bad": ("■", "#d0342c", "bad")}
_PLAIN = ("○", "inherit", "")
_TREATED = ("detrend", "fill", "crop", "edges", "lowpass")  # keys that change a map that was read
_PATIENCE = 0.5  # seconds without a change after which the theories are solved


class StudyPage(pn.viewable.Viewer):
    """A study of a folder and its runs; ``opened(outputs)`` shows datasets, and is called again for further states."""

    def __init__(self, folder: Path, opened: Callable[[list[Path]], None]):
        super().__init__()
        self.folder, self.opened, self.table = folder, opened, draft.parsed(example("first"))
        self.judgement = draft.Judgement(None)
        self._watched: dict[Path, int] = {}  # outputs shown in the results, and their steps
        self._rows: dict[Path, pn.Row] = {}  # of runs
        wide = {"sizing_mode": "stretch_width"}
        self.origin = pn.widgets.Select(name="Begin with", options=self._origins(), **wide)
        self.upload = pn.widgets.FileInput(name="or a height map of yours", multiple=False, **wide)
        self.section = pn.widgets.Select(name="Section", options=list(SECTIONS), value="surface", **wide)
        self.keys = pn.Column(margin=0, **wide)
        self.title = pn.widgets.TextInput(name="Name of the study", value="study", width=150)
        self.model = pn.widgets.Select(name="Model", options=WORDS, width=110)
        self.first = pn.widgets.Button(name="First look, coarse grid", align="end")
        self.go = pn.widgets.Button(name="Run", button_type="primary", align="end")
        self.lights, self.fault = pn.pane.HTML(**wide), pn.pane.HTML(styles={"color": "#d0342c"}, **wide)
        self.surface, self.theory = pn.pane.HTML(min_height=230), pn.pane.HTML(min_height=230)
        self.text = pn.widgets.TextAreaInput(name="Study file; a change counts when you leave it", rows=24, **wide)
        self.python, self.command = (pn.pane.HTML(**wide) for _ in range(2))
        self.runs = pn.Column(margin=0, **wide)
        self.menus = pn.Column(self.origin, self.upload, self.section, self.keys, width=270)
        code = pn.Tabs(
            ("Picture", pn.FlexBox(self.surface, self.theory)),
            ("Study file", self.text),
            ("Python", self.python),
            ("Command line", self.command),
            margin=0,
            **wide,
        )
        go = pn.Row(self.title, self.model, self.first, self.go)
        self.answer = pn.Column(go, self.fault, self.lights, code, self.runs, min_width=600, **wide)
        for widget, act in ((self.origin, self._begin), (self.upload, self._uploaded), (self.section, self._fill)):
            widget.param.watch(act, "filename" if widget is self.upload else "value")
        self.text.param.watch(self._edited, "value")
        self.model.param.watch(lambda _: self._show_code(), "value")
        self.title.param.watch(lambda _: self._show_code(), "value")
        self.first.on_click(lambda _: self._run(coarse=True))
        self.go.on_click(lambda _: self._run(coarse=False))
        self.change(self.table)
        self.follow()

    def __panel__(self) -> pn.viewable.Viewable:
        return pn.Row(self.menus, self.answer, sizing_mode="stretch_width")

    def change(self, table: draft.Table) -> None:
        """Take another draft, and show what the checks say of it."""
        self.table, self.judgement = table, draft.judge(table, self.folder)
        self.text.value = draft.text_of(table)
        self._fill()
        self._show_code()
        self.lights.object, self.fault.object = _lights(self.judgement), ""
        self.go.disabled = self.first.disabled = self.judgement.study is None
        if self.judgement.study is not None:
            self.surface.object = _image(partial(_draw_surface, study=self.judgement.study), "height map and spectrum")
            if pn.state.curdoc is not None:
                pn.state.execute(self._solve_theories)

    def follow(self) -> None:
        """Show how far the runs are; further states of those in the results appear there."""
        found = runs.runs_in(self.folder)
        rows = [self._row(run) for run in found]
        if rows != self.runs[1:]:
            self.runs[:] = [pn.pane.HTML("<b>Runs in this folder</b>"), *rows]
        for run in found:
            seen = run.done + run.output.exists()
            if seen > self._watched.get(run.output, seen):
                self._watched[run.output] = seen
                self.opened([run.output])

    def _origins(self) -> dict[str, tuple[str, str]]:
        own = sorted(path.name for path in self.folder.glob("*.toml"))
        names = [name for name in example_names() if "path" not in draft.parsed(example(name)).get("surface", {})]
        names.sort(key=lambda name: name != "first")
        return {f"example: {name}": ("example", name) for name in names} | {name: ("file", name) for name in own}

    def _begin(self, event: Any) -> None:
        kind, name = event.new
        try:
            text = example(name) if kind == "example" else draft.inside(self.folder, name).read_text(encoding="utf-8")
            self.change(draft.parsed(text))
            self.title.value = name.removesuffix(".toml")
        except (InputError, OSError, UnicodeDecodeError) as error:
            self._complain(error)

    def _uploaded(self, event: Any) -> None:
        """Keep a map and use it; what the study says of its own surface goes, but for the number of points."""
        if not event.new:
            return
        try:
            path = draft.keep_upload(self.folder, event.new, self.upload.value or b"")
        except (InputError, OSError) as error:
            self._complain(error)
            return
        self.section.value = "surface"
        swept = {key: one for key, one in self.table.get("sweep", {}).items() if not key.startswith("surface.")}
        others = {name: content for name, content in self.table.items() if name not in ("sweep", "override")}
        self.change({**others, **({"sweep": swept} if swept else {}), "surface": {"kind": "file", "path": path.name}})

    def _edited(self, event: Any) -> None:
        if event.new == draft.text_of(self.table):
            return
        try:
            self.change(draft.parsed(event.new))
        except InputError as error:
            self._complain(error)

    def _fill(self, _: Any = None) -> None:
        """Show the keys of the chosen section; more of them at once are slow in a browser."""
        section = self.section.value
        shown = draft.keys_shown(self.table, section)
        self.keys[:] = [self._widget(f"{section}.{name}", *one) for name, one in shown.items()]
        if section == "material":
            material = pn.widgets.Select(name="Usual values of", options=["", *_MATERIALS], sizing_mode="stretch_width")
            material.param.watch(self._take_material, "value")
            self.keys.insert(0, material)

    def _take_material(self, event: Any) -> None:
        table = self.table
        for name, value in zip(("youngs_modulus", "poissons_ratio"), _MATERIALS[event.new], strict=True):
            table = draft.with_key(table, f"material.{name}", value)
        self.change(table)

    def _widget(self, dotted: str, key: Key, default: str, value: str) -> pn.widgets.Widget:
        """A field for one key, made of its declaration."""
        words = key.kind.removesuffix(", or a list").split(" | ") if " | " in key.kind else []
        about = {"name": dotted.partition(".")[2], "description": key.description, "tags": [dotted]}
        options: dict[str, Any] = {**about, "sizing_mode": "stretch_width"}
        if words and (not value or value in words):
            widget = pn.widgets.Select(
                options={f"{default} (default)" if default else "–": ""} | {w: w for w in words}, value=value, **options
            )
        else:
            widget = pn.widgets.TextInput(value=value, placeholder=default or key.kind, **options)
        widget.param.watch(lambda event: self._typed(dotted, event.new), "value")
        return widget

    def _typed(self, dotted: str, text: str) -> None:
        try:
            self.change(draft.with_key(self.table, dotted, text))
        except (InputError, ValueError) as error:
            self._complain(error)

    def _complain(self, error: Exception) -> None:
        self.fault.object = f'<div role="alert">{escape(str(error))}</div>'

    @property
    def _word(self) -> str:
        """The model as the command names it."""
        return next(word for word, kind in WORDS.items() if kind == self.model.value)

    def _show_code(self) -> None:
        name, model = self.title.value, self.model.value
        lines = [f'found = contact_study.run("{name}.toml", "{model}", output="{name}.{model}.nc")']
        lines += [f"# or as a table\nfound = contact_study.run({self.table!r}, {model!r})"]
        self.python.object = _code("\n".join(["import contact_study\n", *lines]))
        words = f"bem-adhesion run {name}.toml -o {name}.{model}.nc --model {self._word}"
        self.command.object = _code(f"bem-adhesion check {name}.toml\n{words}")

    async def _solve_theories(self) -> None:
        """Draw the theories' curves of the draft once nobody changes it."""
        study = self.judgement.study
        await asyncio.sleep(_PATIENCE)
        if study is None or study is not self.judgement.study:
            return
        try:
            curves = await asyncio.to_thread(draft.theory_curve, study)
        except (InputError, ValueError, ArithmeticError):  # as the lights say
            curves = {}
        if study is self.judgement.study:
            title = "contact area by the theories"
            self.theory.object = _image(partial(_draw_curves, curves=curves), title) if curves else ""

    def _run(self, coarse: bool) -> None:
        try:
            table = draft.coarser(self.table, self.folder) if coarse else self.table
            study = draft.keep_study(self.folder, f"{self.title.value}{'-coarse' if coarse else ''}", table)
            output = study.with_name(f"{study.stem}.{self.model.value}.nc")
            if not output.exists():
                runs.start(study, output, self._word)
            self._watch(output)
        except (InputError, OSError) as error:
            self._complain(error)

    def _watch(self, output: Path) -> None:
        """Show a run in the results, now and after further states."""
        self._watched = {output: 0}
        self.follow()

    def _row(self, run: runs.Run) -> pn.Row:
        """A run in words, and what one can do with it; made once, as a button must stay under the pointer."""
        row = self._rows.get(run.output)
        if row is None:
            acts = {"Stop": runs.stop, "Resume": self._resume, "Show": self._watch}
            buttons = [pn.widgets.Button(name=label, width=70) for label in acts]
            for button, act in zip(buttons, acts.values(), strict=True):
                button.on_click(lambda _, act=act: act(run.output))
            row = self._rows[run.output] = pn.Row(pn.pane.HTML(width=430), *buttons)
        row[0].object = f"<b>{escape(run.output.name)}</b>: {run.state}<br><small>{escape(run.message)}</small>"
        row[1].visible, row[2].visible = run.alive, run.unfinished
        return row

    def _resume(self, output: Path) -> None:
        runs.resume(output)
        self._watch(output)


def _lights(judgement: draft.Judgement) -> str:
    """The checks as a list, for eyes and for readers of screens."""
    if judgement.error:
        return f'<div role="alert" style="color: #d0342c">■ {escape(judgement.error)}</div>'
    rows = []
    for light in judgement.lights:
        mark, colour, said = _MARKS.get(light.kind, _PLAIN)
        named = f' role="img" aria-label="{said}"' if said else ' aria-hidden="true"'
        words = f"<b>{escape(light.title)}</b> {escape(light.words)}"
        rows.append(f'<li><span{named} style="color: {colour}">{mark}</span> {words}</li>')
    lines = "<br>".join(map(escape, judgement.lines))
    return (
        f'<div role="status">{lines}</div><ul style="list-style: none; padding: 0; margin: 4px 0">{"".join(rows)}</ul>'
    )


def _code(text: str) -> str:
    return f'<pre style="white-space: pre-wrap">{escape(text)}</pre>'


def _image(draw: Callable[[Figure], None], words: str) -> str:
    """A figure as an image of the page; a line in place of one that cannot be drawn."""
    figure, file = Figure(layout="constrained"), io.BytesIO()
    try:
        with rc_context(STYLE):
            draw(figure)
            figure.savefig(file, format="png", dpi=100)
    except (InputError, OSError, ValueError) as error:
        return f'<div role="alert">{escape(str(error))}</div>'
    return f'<img alt="{escape(words)}" src="data:image/png;base64,{base64.b64encode(file.getvalue()).decode()}">'


def _draw_surface(figure: Figure, study: Study) -> None:
    """Draw the first case's heights, beside those of its file as read if it changes them, and the spectrum."""
    case = study.cases[0]
    shown = {"heights": case}
    if case.surface.kind == "file" and any(name in study.table["surface"] for name in _TREATED):
        as_read = {name: one for name, one in study.table["surface"].items() if name not in _TREATED}
        shown = {"as read": make_study({**study.table, "surface": as_read}, study.directory).cases[0], "as used": case}
    figure.set_size_inches(3.1 * (len(shown) + 1), 2.4)
    axes = figure.subplots(1, len(shown) + 1)
    for ax, (words, one) in zip(axes, shown.items(), strict=False):
        surface = one.geometry.realise(one.directory)
        draw_heights(surface, surface.grid, ax)
        ax.set_title(words)
    draw_roughness(surface.roughness.sample, axes[-1])


def _draw_curves(figure: Figure, curves: dict[str, Any]) -> None:
    figure.set_size_inches(2.8, 2.4)
    ax = figure.subplots()
    unit = pressure_unit(max(float(pressures[-1]) for pressures, _ in curves.values()))
    for theory, (pressures, areas) in curves.items():
        ax.loglog(pressures / unit.size, areas, "o-", ms=2.5, lw=1, label=theory.replace("_", " "))
    ax.set(xlabel=f"pressure ({unit.name})", ylabel="relative contact area", title="theories, first case")
    ax.legend(frameon=False)
