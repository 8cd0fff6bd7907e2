"""Write a dataset in a form that other programs read."""

import argparse
from pathlib import Path

from contact_study.command_line.frame import epilog
from contact_study.command_line.selection import add_selection, case_dims, one_case, opened, selected
from contact_study.inputs.errors import DONE, InputError

_FORMATS = {
    "csv": (".csv", "table: a row per case and load step, units in the header"),
    "vtk": (".pvd", "fields of one case for ParaView"),
    "xyz": (".xyz", "atoms of one case for OVITO and ASE"),
}
USAGE = "FILE.nc --csv | --vtk | --xyz [-o FILE] [--case KEY=VALUE] [--overwrite]"
END = epilog(
    "bem-adhesion export bem.nc --csv",
    "bem-adhesion export bem.nc --vtk -o contact.pvd --case well_depth_ratio=4",
    "bem-adhesion export md.nc --xyz --case well_depth_ratio=4,seed=1",
)


def add(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", type=Path, metavar="FILE.nc", help="dataset of a run")
    forms = parser.add_mutually_exclusive_group(required=True)
    for word, (_, words) in _FORMATS.items():
        forms.add_argument(f"--{word}", dest="form", action="store_const", const=word, help=words)
    parser.add_argument("-o", "--output", metavar="FILE", help="default: beside FILE.nc")
    parser.add_argument("--overwrite", action="store_true", help="replace an existing file")
    add_selection(parser)


def run(given: argparse.Namespace) -> int:
    import contact_study
    from contact_study.campaign.dataset.export import table_of
    from contact_study.campaign.store.files import named_file, writable_output, write_aside

    suffix, _ = _FORMATS[given.form]
    output = named_file(given.output or given.file.with_suffix(suffix))
    if output.suffix != suffix:
        raise InputError(f"-o {output}: expected a name that ends in {suffix}")
    if output.exists() and not given.overwrite:
        raise InputError(f"{output} exists; use --overwrite to replace it")
    with opened(given.file) as dataset:
        chosen = selected(dataset, given.case, given.step)
        if given.form == "csv":
            table = table_of(chosen, case_dims(chosen))
            writable_output(output)
            write_aside(output, lambda partial: table.to_csv(partial, index=False, float_format="%.9g"))
        else:
            write = contact_study.to_vtk if given.form == "vtk" else contact_study.to_xyz
            write(one_case(chosen, given.file)[0], output)
    print(output)
    return DONE
