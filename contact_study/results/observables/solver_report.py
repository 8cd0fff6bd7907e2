"""The work of the solver and its outcome."""

from dataclasses import asdict

from contact_study.results.state import FLAG, Observable, Variable, noted

SOLVER_REPORT = Observable(
    {
        "time": Variable("s", "time since the motion, or a path in time, began; of a point that of its last state"),
        "converged": Variable("1", "whether the step met the tolerance", kind="flag", attrs=FLAG),
        "detached": Variable(
            "1",
            "whether the surfaces are detached",
            kind="flag",
            attrs={
                **FLAG,
                "comment": "no contact carries the load, or no atom is in reach of a driven block; a continuum at a "
                "prescribed gap or approach does not detach",
            },
        ),
        "residual": noted(
            "1",
            "error left in the equations of the model, in units of their own scales; see comment",
            "adhesive simulations: largest unbalanced stress over contact modulus, where surfaces touch "
            "a wall only what it would have to pull; hard wall without adhesion: largest gap inside or penetration "
            "outside the contact over rms height; Persson's theory: last change of the detachment stress over "
            "contact modulus; gap-flow theory: mean traction minus pressure over contact modulus, an error of its "
            "grid; edge flow: last change of a scale's mean response; atoms at a temperature: mean pressure minus "
            "the applied one over contact modulus, NaN where sampled at a prescribed gap; atoms in motion without "
            "one: largest unbalanced stress or missing load over contact modulus; driven block, which is not in "
            "balance: largest unbalanced stress, including thermal forces",
        ),
        "complementarity_residual": noted(
            "1",
            "violation of the conditions of a wall or a hardness, over the contact modulus",
            "largest pull on the wall where surfaces touch, or pressure beyond a hardness",
        ),
        "iterations": Variable("1", "iterations of the solver", kind="count"),
        "fft_pairs": Variable("1", "pairs of Fourier transforms, in double-precision pairs of the finest grid"),
        "force_evaluations": Variable("1", "evaluations of the interface forces", kind="count"),
        "acceptance_rate": Variable("1", "accepted fraction of the proposals of thermal sampling"),
        "message": Variable("1", "message of the solver on the step", kind="text"),
    },
    lambda state, _: {name: value for name, value in asdict(state.report).items() if value is not None},
    averaged=False,
)
