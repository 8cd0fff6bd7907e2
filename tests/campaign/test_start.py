import importlib.metadata
import sys
import types

import pytest

from contact_study import start
from contact_study.inputs.errors import INTERRUPTED
from tests.campaign.conftest import interrupt

COMMANDS = ["bem-adhesion", "md-reference", "persson-theory", "contact-compare", "contact-merge"]


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_start_and_are_interrupted_while_their_libraries_are_read(command, monkeypatch, capsys):
    (entry,) = importlib.metadata.entry_points(group="console_scripts", name=command)
    assert entry.module == "contact_study.start"
    main = getattr(start, command.replace("-", "_"))
    monkeypatch.setattr(sys, "argv", [command, "--version"])
    assert main() == 0
    assert capsys.readouterr().out.startswith(f"{command} ")
    interrupting = types.ModuleType("program")  # whose import takes so long that one presses Ctrl-C
    interrupting.__getattr__ = interrupt
    monkeypatch.setitem(sys.modules, "contact_study.command_line.program", interrupting)
    assert main() == INTERRUPTED == 130
    assert capsys.readouterr().err == f"{command}: interrupted before it began\n"
