"""Studies from Python: run a table or a file, return the dataset."""

import re
import tempfile
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.campaign.dataset.file import unconverged
from contact_study.campaign.engines import CampaignError
from contact_study.campaign.model import MODELS
from contact_study.campaign.progress import Progress
from contact_study.campaign.run import RunOptions, run_campaign
from contact_study.campaign.store.files import check_inputs_kept, named_file
from contact_study.inputs.errors import InputError
from contact_study.numerics.arguments import field
from contact_study.study.schema.bodies import ROUGH_SECTIONS
from contact_study.study.study import Study, make_study, read_study, with_keys

_HEIGHTS = "heights.npy"


def run(
    study: Mapping[str, Any] | str | Path,
    model: str = "continuum",
    *,
    output: str | Path | None = None,
    resume: bool = False,
    overwrite: bool = False,
    predictor: str | Path | None = None,
    workers: int = 1,
    engine: str | None = None,
    scheduler: str | None = None,
    progress: bool = False,
) -> xr.Dataset:
    """Run a study by one of the models.

    Parameters
    ----------
    study : mapping or path-like
        Path of a study file, or its content as nested mappings, ``{"surface": {"kind": "self_affine", ...}, ...}``:
        numbers in SI, strings with a unit or pint quantities; paths relative to the working directory. An own surface
        is ``{"surface": {"heights": array, "size": ...}}``, heights (y, x) in m. ``interaction`` or its ``law`` may be
        a law such as :class:`bem_adhesion.LennardJones104`, ``elasticity`` or its ``kind`` a solid such as
        :class:`bem_adhesion.Layer`, or one of your module; one without Poisson's ratio takes
        ``material.poissons_ratio``.
    model : str, optional
        ``"continuum"``, ``"atomistic"`` or ``"theory"``.
    output : path-like, optional
        Dataset to write, as the model's command does; default: no file is left on disk.
    resume, overwrite : bool, optional
        Whether to continue, or to replace, a run at ``output``.
    predictor : path-like, optional
        Dataset of the continuum whose gap fields the atomistic model starts from.
    workers : int, optional
        Number of processes for the points of a sweep. Each further process imports the caller's script, so call this
        below ``if __name__ == "__main__":``.
    engine : str, optional
        ``"serial"``, ``"processes"`` or ``"dask"``; default: by ``workers``.
    scheduler : str, optional
        Address, or file, of the scheduler of a Dask cluster.
    progress : bool, optional
        Whether to show every finished step on stderr.

    Returns
    -------
    xarray.Dataset
        Root group of the dataset, loaded. Metastable branches of theories are another group, in the file only.

    Raises
    ------
    ValueError
        If a key of the study or an argument cannot be used; the message names it.

    Warns
    -----
    UserWarning
        For every warning of the command, and if steps did not converge: see the variable ``converged``.

    Examples
    --------
    >>> dataset = contact_study.run("data/yang2008_quick.toml", "theory")  # doctest: +SKIP
    >>> dataset.relative_contact_area.plot.line(x="step", hue="theory")  # doctest: +SKIP
    """
    if model not in MODELS:
        raise InputError(f"model = {model!r}: expected one of {', '.join(MODELS)}")
    chosen = MODELS[model]
    if resume and overwrite:
        raise InputError("resume and overwrite exclude each other")
    if isinstance(workers, bool) or not isinstance(workers, int) or workers < 1:
        raise InputError(f"workers = {workers!r}: must be a whole number of at least 1")
    if predictor is not None and not chosen.takes_predictor:
        raise InputError(f"predictor: the model {model!r} takes none")
    if output is None and resume:
        raise InputError("resume: needs an output to continue")
    start = None if predictor is None else Path(predictor)
    shown = Progress(chosen.command if progress else "", _in_python)
    words = f"contact_study.run(..., {model!r})"
    with tempfile.TemporaryDirectory(prefix="contact_study") as folder:
        try:
            asked = _study(study, Path(folder))
            path = Path(folder) / "dataset.nc" if output is None else named_file(output)
            given = Path(study) if isinstance(study, str | Path) else None
            maps = (one for case in asked.cases for one in case.height_maps.values())
            check_inputs_kept(path, [given, start, *maps])
            options = RunOptions(resume, overwrite, workers, engine, scheduler)
            groups = run_campaign(chosen, asked, path, shown, words, start, options)
        except (InputError, CampaignError) as error:
            raise type(error)(_in_python(str(error))) from None
        dataset = xr.load_dataset(path)
    for line in unconverged(groups):
        warnings.warn(line, UserWarning, stacklevel=2)
    return dataset


def _study(study: Mapping[str, Any] | str | Path, folder: Path) -> Study:
    """Read or make a study; a height array goes to a file in the folder."""
    if isinstance(study, str | Path):
        return read_study(study)
    if not isinstance(study, Mapping):
        raise InputError(f"study = {study!r}: expected a mapping of sections or the path of a study file")
    study = with_keys(study)
    given = {
        name: _saved(name, section, folder)
        for name in ROUGH_SECTIONS
        if isinstance(section := study.get(name), Mapping) and "heights" in section
    }
    return make_study(_plain({**study, **given}), folder) if given else make_study(_plain(study))


def _saved(name: str, section: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Save the heights of a section to a file; its keys with that file's."""
    for key in ("path", "height_unit"):
        if key in section:
            raise InputError(f"{name}.{key}: does not go with {name}.heights, an array in m")
    if section.get("kind", "file") != "file":
        raise InputError(f'{name}.kind = {section["kind"]!r}: {name}.heights are a surface of kind "file"')
    heights = section["heights"]
    try:
        heights = heights.m_as("m") if _is_quantity(heights) else heights
    except TypeError as error:  # pint's own
        raise InputError(f"{name}.heights: {error}") from None
    file = _HEIGHTS if name == "surface" else f"{name}_{_HEIGHTS}"
    np.save(folder / file, field(f"{name}.heights", heights))
    others = {key: value for key, value in section.items() if key != "heights"}
    return {**others, "kind": "file", "path": file}


def _in_python(message: str) -> str:
    """Replace the commands' options in a message by arguments of :func:`run`."""
    flags = re.sub(r"(?<![\w./-])--(resume|overwrite)\b", r"\1=True", message)
    return re.sub(r"(?<![\w./-])--(?=[a-z])", "", flags)


def _plain(value: Any) -> Any:
    """Convert a value to one that a TOML file can hold."""
    if isinstance(value, Mapping):
        return {str(name): _plain(content) for name, content in value.items()}
    if _is_quantity(value):
        return [_plain(item) for item in value] if np.ndim(value.magnitude) else _with_unit(value)
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, tuple | list):
        return [_plain(item) for item in value]
    return str(value) if isinstance(value, Path) else value


def _is_quantity(value: Any) -> bool:
    """Whether a value is a quantity of pint, of any registry."""
    return hasattr(value, "magnitude") and hasattr(value, "unit_items")


def _with_unit(quantity: Any) -> str | float:
    """Write a quantity of pint as in a study file: "1.5 joule meter^-2"."""
    unit = " ".join(name if power == 1 else f"{name}^{power:g}" for name, power in quantity.unit_items())
    number = float(quantity.magnitude)
    return f"{number!r} {unit}" if unit else number
