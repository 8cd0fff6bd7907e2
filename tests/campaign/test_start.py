import importlib.metadata
import sys

import pytest

from contact_study import start
from contact_study.inputs.errors import INTERRUPTED

COMMANDS = ["bem-adhesion", "md-reference", "persson-theory", "contact-compare", "contact-merge"]


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_begin_their_own_module(command, monkeypatch, capsys):
    (entry,) = importlib.metadata.entry_points(group="console_scripts", name=command)
    assert entry.module == "contact_study.start"
    monkeypatch.setattr(sys, "argv", [command, "--version"])
    with pytest.raises(SystemExit) as ended:
        getattr(start, command.replace("-", "_"))()
    assert ended.value.code == 0
    assert capsys.readouterr().out.startswith(f"{command} ")


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_is_interrupted_while_its_libraries_are_read(command, monkeypatch, capsys):
    def read(module):
        raise KeyboardInterrupt

    monkeypatch.setattr(start.importlib, "import_module", read)
    assert getattr(start, command.replace("-", "_"))() == INTERRUPTED == 130
    assert capsys.readouterr().err == f"{command}: interrupted before it began\n"
