"""How the solver fared, and the work it did, in counts that do not depend on the machine."""

from dataclasses import asdict

import numpy as np

from contact_study.numerics.distributions import Bins
from contact_study.results.state import InterfaceState, Observable, Value, Variable

FLAG = {"flag_values": np.array([-1, 0, 1], np.int8), "flag_meanings": "absent no yes"}


def _read(state: InterfaceState, _: Bins) -> dict[str, Value]:
    return {name: value for name, value in asdict(state.report).items() if value is not None}


SOLVER_REPORT = Observable(
    {
        "converged": Variable("1", "whether the step met the tolerance", kind="flag", attrs=FLAG),
        "detached": Variable(
            "1",
            "whether the surfaces have come apart: no contact carries the load, or no atom is in reach of a driven "
            "block; a continuum held at a gap or an approach does not",
            kind="flag",
            attrs=FLAG,
        ),
        "residual": Variable(
            "1",
            "error left in the equations of the model, in units of their own scales; see comment",
            attrs={
                "comment": "adhesive simulations: largest unbalanced stress over contact modulus, where surfaces touch "
                "a wall only what it would have to pull; hard wall without adhesion: largest gap inside or penetration "
                "outside the contact over rms height; Persson's theory: last change of the detachment stress over "
                "contact modulus; gap-flow theory: mean traction less pressure over contact modulus, an error of its "
                "grid; edge flow: last change of a scale's mean response; atoms at a temperature: mean pressure less "
                "the applied one over contact modulus, NaN where sampled at a prescribed gap; atoms in motion without "
                "one: largest unbalanced stress or load missing over contact modulus; of a driven block, which is not "
                "in balance, the largest unbalanced stress, thermal forces in it"
            },
        ),
        "complementarity_residual": Variable(
            "1",
            "largest pull on the wall where surfaces touch, or pressure beyond a hardness, over the contact modulus; "
            "gaps without reaction",
        ),
        "iterations": Variable("1", "iterations of the solver", kind="count"),
        "fft_pairs": Variable(
            "1", "pairs of Fourier transforms, in equivalents of the finest grid in double precision"
        ),
        "force_evaluations": Variable("1", "evaluations of the interface forces", kind="count"),
        "acceptance_rate": Variable("1", "share of the proposals that thermal sampling took"),
        "message": Variable("1", "what the solver has to say of the step", kind="text"),
    },
    _read,
    averaged=False,
)
