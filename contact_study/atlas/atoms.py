"""Conditions of the atlas as blocks of atoms at 0 K and at a temperature, beside the continuum on the same surfaces.

A linear elastic contact depends on θ, on the law's length over the rms height and on pressure over E* h'/2; heights and
lateral lengths scale apart. So the law's length becomes the distance of the paper's pairs, and the cell is as wide as
a chosen rms slope makes it. Lattice and modulus are those of the paper's block.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contact_study.atlas.design import MODULUS, RMS_SLOPE, SIZE, STRESS, Condition, design
from contact_study.atlas.joining import sealed
from contact_study.atlas.loops import file_of, seeds_of, study_of
from contact_study.campaign.library import run
from contact_study.inputs.errors import InputError
from contact_study.results.schema import CONVENTIONS, STANDARD_ERROR, variable_of
from contact_study.version import __version__

TWENTIETH = 12  # conditions
SLOPES = (0.2, 0.1)  # rms slope of the blocks: steeper ones have fewer atoms
FINE_CONDITIONS = (491, 519, 81, 51, 211, 577)  # of the second slope: the smallest, and one that jumps
PRESSURES = (0.05, 0.2, 0.8, 2.0)  # over E* h'/2, and back

# Lattice constant, distance of the pairs (m), Young's modulus (Pa) and Poisson's ratio of Yang, Persson, Israelachvili
# and Rosenberg, EPL 84, 46004 (2008).
LATTICE_CONSTANT, DISTANCE = 2.6e-10, 3.28e-10
YOUNGS_MODULUS, POISSONS_RATIO = 77.2e9, 0.42
CONTACT_MODULUS = YOUNGS_MODULUS / (1 - POISSONS_RATIO**2)

MODELS = ("continuum", "atoms", "warm_atoms")
WARM = 300.0  # K
WARM_PRESSURES = (0.05, 2.0)
TRAJECTORIES, EQUILIBRATION = 60, 20
_PATH = (*PRESSURES, *PRESSURES[-2::-1])
_STATES = (
    "mean_pressure",
    "mean_gap",
    f"mean_gap{STANDARD_ERROR}",
    "relative_contact_area",
    f"relative_contact_area{STANDARD_ERROR}",
    "converged",
)
_CONSTANTS = ("contact_modulus", "work_of_adhesion", "rms_height", "rms_slope", "pixel")


@dataclass(frozen=True)
class Block:
    """A condition of the 10-4 law on a half-space as atoms.

    Attributes
    ----------
    condition : Condition
        The condition.
    slope : float
        rms slope, but for the whole number of atoms.
    """

    condition: Condition
    slope: float = SLOPES[0]

    @property
    def atoms(self) -> int:
        """Atoms a side."""
        return round(RMS_SLOPE / self.slope * self.vertical * SIZE / LATTICE_CONSTANT)

    @property
    def vertical(self) -> float:
        """Scale of heights and of the law's length."""
        return DISTANCE / self.condition.length

    @property
    def lateral(self) -> float:
        """Scale of the cell."""
        return self.atoms * LATTICE_CONSTANT / SIZE

    @property
    def stress(self) -> float:
        """E* h'/2 of the block (Pa)."""
        return STRESS * CONTACT_MODULUS / MODULUS * self.vertical / self.lateral

    @property
    def work_of_adhesion(self) -> float:
        """Δγ (J/m²): as the elastic energy of full contact, it scales as E* h²/λ."""
        return self.condition.work_of_adhesion * CONTACT_MODULUS / MODULUS * self.vertical**2 / self.lateral

    def study(self, temperature: float = 0.0) -> dict[str, Any]:
        """Make the study of loading and unloading, of the first surface of the condition.

        Parameters
        ----------
        temperature : float, optional
            Of the atoms (K).

        Returns
        -------
        dict
            As for :func:`contact_study.run`.
        """
        pressures = WARM_PRESSURES if temperature else PRESSURES
        seed = seeds_of(self.condition, 1)[0]
        given = study_of(self.condition, [seed])
        cell = {"size": self.lateral * SIZE, "shape": [self.atoms, self.atoms], "seed": seed}
        height = {"rms_height": self.vertical * self.condition.spectrum.rms_height}
        law = {"work_of_adhesion": self.work_of_adhesion, "length": DISTANCE}
        found = {
            "study": {"title": f"contact atlas, condition {self.condition.number} as atoms"},
            "surface": given["surface"] | cell | height,
            "material": {
                "youngs_modulus": YOUNGS_MODULUS,
                "poissons_ratio": POISSONS_RATIO,
                "lattice_constant": LATTICE_CONSTANT,
            },
            "interaction": given["interaction"] | law,
            "loading": {"path": [share * self.stress for share in pressures], "unload": True},
            "solver": {"threads": 1},
            "output": {"restart": False},
        }
        if temperature:
            found["atomistic"] = {"method": "sampling", "temperature": temperature, "random_seed": 1}
            found["sampling"] = {"trajectories": TRAJECTORIES, "equilibration": EQUILIBRATION}
        return found


_OF_BLOCKS: dict[str, tuple[str, Callable[[Block], float]]] = {
    "condition": ("number of the condition in the design", lambda block: block.condition.number),
    "slope": ("rms slope by design", lambda block: block.slope),
    "atoms": ("atoms along a side", lambda block: block.atoms),
    "relative_adhesion": (
        "work of adhesion over elastic energy of full contact",
        lambda block: block.condition.relative_adhesion,
    ),
    "tabor_number": ("Tabor parameter of the mean asperity, by design", lambda block: block.condition.tabor_number),
}


def blocks(count: int = TWENTIETH) -> list[Block]:
    """Choose the smallest blocks of the design whose lattice is as fine as the atlas' grid, smallest first.

    Parameters
    ----------
    count : int, optional
        Number of blocks.

    Returns
    -------
    list of Block
        Of conditions with the 10-4 law on a half-space.

    Examples
    --------
    >>> from contact_study.atlas.atoms import blocks
    >>> len(blocks(3))
    3
    """
    pairs = [one for one in design()[0] if (one.law, one.solid) == ("lennard_jones_10_4", "half_space")]
    fine = [block for one in pairs if (block := Block(one)).atoms >= one.points]
    return sorted(fine, key=lambda block: block.atoms)[:count]


def tasks() -> list[tuple[Block, str]]:
    """List all runs, each a block and one of :data:`MODELS`, in their order."""
    chosen = blocks()
    fine = [Block(block.condition, SLOPES[1]) for block in chosen if block.condition.number in FINE_CONDITIONS]
    at_rest = [(block, model) for block in [*chosen, *fine] for model in MODELS[:2]]
    return [*at_rest, *((block, MODELS[2]) for block in chosen)]


def run_block(block: Block, folder: Path, model: str) -> None:
    """Run one of :data:`MODELS` on a block's surface, or read what the folder has."""
    study = block.study(WARM if model == MODELS[2] else 0.0)
    folder.mkdir(parents=True, exist_ok=True)
    run(study, "continuum" if model == MODELS[0] else "atomistic", output=_file(block, folder, model), resume=True)


def _file(block: Block, folder: Path, model: str) -> Path:
    return file_of(folder, block.condition, f"slope{block.slope:g}_{model}")


def collect_blocks(folder: Path) -> xr.Dataset:
    """Join what a folder has of all tasks; states that were not run are NaN.

    Parameters
    ----------
    folder : pathlib.Path
        Where :func:`run_block` has put its datasets.

    Returns
    -------
    xarray.Dataset
        States on ``block``, ``model`` and ``step``. Blocks without continuum or atoms at 0 K are left out.

    Raises
    ------
    InputError
        If the folder has no finished block.
    """
    every = dict.fromkeys(block for block, _ in tasks())
    there = [block for block in every if all(_file(block, folder, model).exists() for model in MODELS[:2])]
    if not there:
        raise InputError(f"{folder}: has no finished block; run some first")
    whole = xr.concat([_joined(block, folder) for block in there], "block")
    for name, (words, value) in _OF_BLOCKS.items():
        whole[name] = ("block", [value(block) for block in there], {"units": "1", "long_name": words})
    back = [int(step >= len(PRESSURES)) for step in range(len(_PATH))]
    words = "prescribed pressure over half of modulus times rms slope by design"
    whole["prescribed_pressure"] = ("step", list(_PATH), {"units": "1", "long_name": words})
    known = variable_of("branch")
    whole["branch"] = ("step", back, {"units": known.units, "long_name": known.long_name})
    whole.attrs = {
        "Conventions": CONVENTIONS,
        "title": f"Contact atlas: atoms at 0 K and at {WARM:g} K beside the continuum",
        "source": f"bem-adhesion {__version__}",
    }
    return sealed(whole)


def _joined(block: Block, folder: Path) -> xr.Dataset:
    """States of all models of one block, with the continuum's constants."""
    files = {model: path for model in MODELS if (path := _file(block, folder, model)).exists()}
    ways = {model: xr.load_dataset(path) for model, path in files.items()}
    found = {}
    for name in _STATES:
        values = np.full((len(MODELS), len(_PATH)), np.nan)
        for model, way in ways.items():
            if name in way:
                places = np.isin(_PATH, WARM_PRESSURES) if model == MODELS[2] else slice(None)
                values[MODELS.index(model), places] = way[name].values
        plain = variable_of(name.removesuffix(STANDARD_ERROR))
        words = "standard error of the mean: " if name.endswith(STANDARD_ERROR) else ""
        attributes = {"units": plain.units, "long_name": words + plain.long_name}
        found[name] = xr.Variable(("model", "step"), values, attributes)
    found |= {name: ways[MODELS[0]][name].variable for name in _CONSTANTS}
    return xr.Dataset(found, {"model": ("model", list(MODELS), {"units": "1", "long_name": "model"})})
