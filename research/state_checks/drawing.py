"""Random studies: law, solid, boundaries, roughness, grid, control and path, and what else a study is about."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from contact_study.inputs.errors import InputError
from contact_study.physics.laws import LAWS, LennardJones104
from contact_study.study.study import make_study

SIZE = 100e-9
MODULUS = (1e9, 100e9)  # Young's, log-uniform
SHAPES = ((32, 32), (48, 48), (33, 33), (31, 45), (24, 64), (64, 40))
SUBJECTS = ("hardness", "viscoelastic", "adaptive", "approach", "tabulated_stiffness")
# Wavenumbers that differ by less than this share are one wave's, in other roundings.
SAME = 1e-9


@dataclass(frozen=True)
class Drawn:
    """A random study, what of :data:`SUBJECTS` it is about, and it with the solid that was tabulated, if one was."""

    table: dict[str, Any]
    subjects: tuple[str, ...] = ()
    closed_form: dict[str, Any] | None = None


def drawn(number: int, extreme: bool = False) -> Drawn:
    """The study of a number, which decides all but how far solids go and which may be free."""
    table = _plain(number, extreme)
    # A stream of its own: what a study is about changes nothing else of it.
    rng = np.random.default_rng([22, number])
    subject, tabulated = _subject(table["interaction"]["law"], rng), rng.random() < 0.2
    if subject == "hardness":
        table = _hard(table, rng)
    elif subject == "viscoelastic":
        table = _relaxing(table, rng)
    elif subject == "adaptive":
        table["loading"] |= {"adaptive": True, "resolution": _between(rng, 0.005, 0.05)}
    subjects = (subject,) if subject else ()
    if subject != "viscoelastic" and tabulated and table["elasticity"]["boundary"] == "periodic":
        measured = _tabulated(table)
        if measured is not None:
            return Drawn(measured, (*subjects, "tabulated_stiffness"), table)
    elif _has_approach(table) and rng.random() < 0.4:
        table["loading"] |= {"control": "approach", "path": _approaches(table["surface"]["rms_height"], rng)}
    return Drawn(table, (*subjects, "approach") if table["loading"]["control"] == "approach" else subjects)


def _has_approach(table: dict[str, Any]) -> bool:
    """Whether boundaries are periodic and a uniform pressure moves the solid."""
    return table["elasticity"]["kind"] == "layer" and table["material"]["poissons_ratio"] < 0.5


def _approaches(height: float, rng: np.random.Generator) -> list[float]:
    """Nearer, less near, as near again, beyond; from light contact of a layer to next to full contact."""
    first, most = sorted(float(value) * height for value in rng.uniform(0.1, 5, 2))
    return [first, most, 0.3 * first, most, 1.3 * most]


def _subject(law: str, rng: np.random.Generator) -> str | None:
    shares = {"viscoelastic": 0.15}
    if law == "hard_wall":
        shares["hardness"] = 0.6
    elif law != "repulsive":
        shares["adaptive"] = 0.15
    at = rng.random()
    for name, share in shares.items():
        if at < share:
            return name
        at -= share
    return None


def _between(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _plain(number: int, extreme: bool) -> dict[str, Any]:
    """Of an elastic solid, in plain steps."""
    thinnest, least, most = (1e-10, 1e-3, 1e3) if extreme else (5e-9, 0.1, 10)
    rng = np.random.default_rng([20, number])
    names = list(LAWS)
    law = names[number % len(names)]
    shape = SHAPES[rng.integers(len(SHAPES))]
    size = [SIZE, SIZE * shape[1] / shape[0]] if rng.random() < 0.5 else [SIZE, SIZE]
    modulus, ratio = _between(rng, *MODULUS), float(rng.choice([0.0, 0.3, 0.45, 0.5]))
    contact_modulus = modulus / (1 - ratio**2)
    cutoff = int(rng.integers(3, min(shape) // 4 + 1))
    slope = _between(rng, 0.02, 0.5)
    height = slope * max(size) / (2 * np.pi * cutoff) * _between(rng, 1, 3)
    length = height * _between(rng, 0.1, 2.0)
    # Over E* × length: from hardly sticky to many states.
    work = contact_modulus * length * _between(rng, 1e-3, 0.1)
    solids = {
        "half_space": {},
        "layer": {"thickness": _between(rng, thinnest, 1e-7)},
        "layered": {
            "thickness": _between(rng, thinnest, 1e-7),
            "base_youngs_modulus": modulus * _between(rng, least, most),
            "base_poissons_ratio": 0.3,
        },
        "transversely_isotropic": {
            "axial_modulus": modulus * _between(rng, 1, 5),
            "axial_poissons_ratio": 0.2,
            "axial_shear_modulus": modulus * _between(rng, 0.2, 1),
        },
    }
    kind = str(rng.choice(list(solids)))
    if kind == "transversely_isotropic":  # constants that a solid can have
        ratio = min(ratio, 0.3)
    free = (kind == "half_space" and rng.random() < 0.5) or (extreme and kind == "transversely_isotropic")
    control = str(rng.choice(["pressure", "approach" if free else "gap"]))
    return {
        "surface": {
            "kind": "self_affine",
            "size": size,
            "shape": list(shape),
            "hurst_exponent": float(rng.uniform(0.2, 1.0)),
            "rms_height": height,
            "roll_off_mode": int(rng.integers(1, cutoff + 1)),
            "cutoff_mode": cutoff,
            "seed": number,
        },
        "material": {"youngs_modulus": modulus, "poissons_ratio": ratio},
        "elasticity": {"kind": kind, "boundary": "free" if free else "periodic", **solids[kind]},
        "interaction": {"law": law, **_keys_of_law(law, work, length, rng)},
        "loading": {
            "control": control,
            "path": _path(control, law, contact_modulus * slope, height, length, work, rng),
        },
    }


def _keys_of_law(law: str, work: float, length: float, rng: np.random.Generator) -> dict[str, Any]:
    if law == "hard_wall":
        return {}
    if law == "repulsive":
        return {"repulsion": work, "length": length}
    if law == "tabulated":
        source = LennardJones104(work, length)
        gap = length * np.concatenate([np.linspace(0.6, 2, 70), np.geomspace(2.05, 8, 40)])
        return {"gap": gap.tolist(), "traction": source.traction(gap).tolist()}
    keys: dict[str, Any] = {"work_of_adhesion": work, "length": length}
    share = float(rng.uniform(0.2, 0.6))
    if law == "morse":
        keys |= {"range": share * length}
    elif law == "exponential_core":
        keys |= {"range": share * length, "core": share * length * float(rng.uniform(0.1, 0.6))}
    elif law == "dugdale_core":
        keys |= {"range": share * length, "ramp": 0.2, "core": 0.1 * share * length}
    return keys


def _path(
    control: str, law: str, stress: float, height: float, length: float, work: float, rng: np.random.Generator
) -> list[float]:
    """There and back; in the end under a little tension, where the law has some."""
    if control == "pressure":
        up = sorted(float(value) for value in stress * np.exp(rng.uniform(np.log(3e-3), np.log(0.5), 3)))
        down = [up[0]] if law in ("hard_wall", "repulsive") else [up[0], -0.02 * work / length]
        return [*up, *down]
    if control == "gap":
        return [float(value) * height for value in (*sorted(rng.uniform(0.1, 2.5, 3))[::-1], 1.0)]
    return [float(value) * height for value in (*sorted(rng.uniform(0.2, 2.0, 3)), 0.1)]


def _hard(table: dict[str, Any], rng: np.random.Generator) -> dict[str, Any]:
    """With a hardness from far below the elastic contact's stresses to their largest; up, down, up again and beyond."""
    surface, material, loading = table["surface"], table["material"], table["loading"]
    slope = surface["rms_height"] * 2 * np.pi * surface["cutoff_mode"] / max(surface["size"])
    hardness = material["youngs_modulus"] * slope * _between(rng, 0.02, 1.0)
    first, most = sorted(_between(rng, 3e-3, 0.95) for _ in range(2))
    if loading["control"] == "approach":
        loading = {"control": "approach", "path": _approaches(surface["rms_height"], rng)}
    elif loading["control"] == "pressure":
        shares = [first, most, 0.3 * first, most, 0.5 * (1 + most)]
        loading = {"control": "pressure", "path": [hardness * share for share in shares]}
    return {**table, "material": {**material, "hardness": hardness}, "loading": loading}


def _relaxing(table: dict[str, Any], rng: np.random.Generator) -> dict[str, Any]:
    """Of a half-space that relaxes in one to three times, some far from those of the path, with a rest on the way."""
    count, modulus, loading = int(rng.integers(1, 4)), table["material"]["youngs_modulus"], dict(table["loading"])
    if loading["control"] == "approach":  # of free boundaries: of as many rms heights a gap
        loading |= {"control": "gap", "path": [*loading["path"][2::-1], loading["path"][2]]}
    path = list(loading["path"])
    at = int(rng.integers(1, len(path)))
    path.insert(at, path[at - 1])
    loading |= {
        "path": path,
        "duration": [_between(rng, 1e-2, 1e2) for _ in path],
        "time_steps": int(rng.integers(1, 5)),
    }
    elasticity = {
        "kind": "viscoelastic",
        "branch_youngs_moduli": [modulus * _between(rng, 0.1, 10) for _ in range(count)],
        "relaxation_times": [_between(rng, 1e-2, 1e2) for _ in range(count)],
    }
    return {**table, "elasticity": {**elasticity, "boundary": "periodic"}, "loading": loading}


def _tabulated(table: dict[str, Any]) -> dict[str, Any] | None:
    """With K of the solid at the waves of the grid in its place; None where there is no such solid."""
    try:
        solid = make_study(table).cases[0].solid
    except InputError:
        return None
    size, shape = table["surface"]["size"], table["surface"]["shape"]
    waves = (2 * np.pi * np.fft.fftfreq(count, length / count) for count, length in zip(shape, size, strict=True))
    q = np.unique(np.hypot(*np.meshgrid(*waves)))[1:]
    q = q[np.diff(np.log(q), prepend=-np.inf) > SAME]
    elasticity = {"kind": "tabulated", "wavenumber": q.tolist(), "stiffness": solid.stiffness(q).tolist()}
    # The modulus that is quoted, and in which errors are counted, is that of the solid.
    youngs_modulus = solid.contact_modulus * (1 - table["material"]["poissons_ratio"] ** 2)
    return {
        **table,
        "elasticity": {**elasticity, "boundary": "periodic"},
        "material": {**table["material"], "youngs_modulus": youngs_modulus},
    }
