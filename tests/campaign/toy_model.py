"""A model of a few lines, to test the campaign without physics: area grows along the path, state is carried on."""

import dataclasses
import os
import time
import warnings

import numpy as np

from contact_study.campaign.model import Model
from contact_study.command_line import program
from contact_study.inputs.errors import InputError
from contact_study.results.state import Step

TOY = Model("toy", "continuum", "tests.campaign.toy_model", "a toy", "none", ignores=("atomistic", "theory"))
MODEL = TOY
TOY_OF_WHOLE_PATHS = dataclasses.replace(TOY, whole_path=True)
TOY_ATOMS = dataclasses.replace(TOY, kind="atomistic", takes_predictor=True, ignores=("theory",))

SOLVED: list[tuple[str, int]] = []  # label and number of each step that this process has solved


def check(case):
    if case.interaction.well_depth_ratio == 13:
        raise InputError("interaction.well_depth_ratio = 13: unlucky")


def review(study, scales):
    return ["a toy is no model"] if study.cases[0].solver.max_iterations == 7 else []


def constants(case, surface):
    y, x = surface.grid.coordinates
    fields = {"y": y, "x": x, "height": surface.heights(surface.shape)} if case.output.fields else {}
    return {"contact_modulus": case.material.contact_modulus, "work_of_adhesion": case.work_of_adhesion, **fields}


def solve_path(case, surface, restart=None, start=0, predictor=None):
    state = np.zeros(3) if restart is None else restart["state"]
    for number in range(start, len(case.path)):
        if case.interaction.well_depth_ratio == 2 and number == 0:
            warnings.warn("a grid too coarse", stacklevel=1)
        time.sleep(float(os.environ.get("TOY_SECONDS", "0")))
        value, _ = case.path[number]
        SOLVED.append((case.label, number))
        if predictor is not None and predictor(number) is not None:
            state = state + predictor(number)[0, 0]
        state = np.sin(state + value / 1e9 + case.interaction.well_depth_ratio)
        yield Step(
            values={
                "mean_pressure": value,
                "relative_contact_area": float(state[0] ** 2),
                "pressure_pdf": lambda edges, density=state[1]: np.full(edges.size - 1, density),
                "gap_flow/mean_gap": float(state[0]),
                "gap_flow/loading/relative_contact_area": float(state[2] ** 2),
                "converged": not (case.interaction.well_depth_ratio == 5 and number == 1),
                "gap_flow/loading/converged": not (case.interaction.well_depth_ratio == 6 and number == 1),
                "residual": 1e-9,
                "iterations": number,
            },
            fields={"gap": np.full(surface.shape, state[0])} if case.output.fields else {},
            restart={"state": state},
        )


def main():
    return program.main(TOY.command, model=TOY)


if __name__ == "__main__":
    raise SystemExit(main())
