"""Write one of the example studies in the package."""

import argparse
import tomllib

from contact_study.command_line.frame import epilog, print_table
from contact_study.inputs.errors import DONE, InputError
from contact_study.study.examples import example, example_names

USAGE = "[NAME] [-o FILE] [--overwrite]"
END = epilog("bem-adhesion init", "bem-adhesion init rubber", "bem-adhesion init first -o study.toml")


def add(parser: argparse.ArgumentParser) -> None:
    name = parser.add_argument("name", nargs="?", metavar="NAME", help="example; without it all are listed")
    name.completer = lambda **_: example_names()  # type: ignore[attr-defined]
    parser.add_argument("-o", "--output", metavar="FILE", help="study file to write, default: NAME.toml; - prints it")
    parser.add_argument("--overwrite", action="store_true", help="replace an existing file")


def run(given: argparse.Namespace) -> int:
    from contact_study.campaign.store.files import named_file, writable_output, write_aside

    if given.name is None:
        if given.output not in (None, "-"):
            raise InputError(f"-o {given.output}: which example? bem-adhesion init lists them")
        titles = [tomllib.loads(example(name))["study"]["title"] for name in example_names()]
        print_table(("name", "study"), list(zip(example_names(), titles, strict=True)))
        return DONE
    text = example(given.name)
    if given.output == "-":
        print(text, end="")
        return DONE
    path = named_file(given.output or f"{given.name}.toml")
    if path.exists() and not given.overwrite:
        raise InputError(f"{path} exists; use --overwrite to replace it, or -o to write another file")
    writable_output(path)
    write_aside(path, lambda partial: partial.write_text(text, encoding="utf-8"))
    print(path)
    return DONE
