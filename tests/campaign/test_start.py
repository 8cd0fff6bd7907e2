import importlib.metadata
import sys
import types

import pytest

from contact_study import start
from contact_study.inputs.errors import INTERRUPTED

COMMANDS = ["bem-adhesion", "md-reference", "persson-theory", "contact-compare", "contact-merge"]


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_start(command, monkeypatch, capsys):
    (entry,) = importlib.metadata.entry_points(group="console_scripts", name=command)
    assert entry.module == "contact_study.start"
    monkeypatch.setattr(sys, "argv", [command, "--version"])
    assert getattr(start, command.replace("-", "_"))() == 0
    assert capsys.readouterr().out.startswith(f"{command} ")


class Interrupting(types.ModuleType):
    """A module whose import takes so long that one presses Ctrl-C."""

    def __getattr__(self, name):
        raise KeyboardInterrupt


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_is_interrupted_while_its_libraries_are_read(command, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "contact_study.command_line.program", Interrupting("program"))
    assert getattr(start, command.replace("-", "_"))() == INTERRUPTED == 130
    assert capsys.readouterr().err == f"{command}: interrupted before it began\n"
