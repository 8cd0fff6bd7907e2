"""What the report says of a study holds for every case of it."""

import tomllib

import pytest
import xarray as xr

from contact_study.report.facts.question import sample_notes, study_paragraphs
from contact_study.report.read.datasets import Inputs, read_inputs
from contact_study.study.study import make_study
from tests.report.synthetic import STUDY, write

SINGLE = STUDY[: STUDY.index("[sweep]")]


def inputs_of(*texts, names=("continuum", "atomistic", "theory")):
    """Inputs of studies alone; the datasets hold nothing but their paths."""
    studies = {name: make_study(tomllib.loads(text)) for name, text in zip(names, texts * len(names), strict=False)}
    control = next(iter(studies.values())).cases[0].loading.control
    path = next(iter(studies.values())).cases[0].loading.path
    shown = ["persson" if name == "theory" else name for name in studies]
    models = {name: xr.Dataset(coords={f"applied_{control}": ("step", list(path))}) for name in shown}
    return Inputs({}, models, {}, studies)


def described(*texts, **options):
    return dict(study_paragraphs(inputs_of(*texts, **options)))


@pytest.mark.parametrize(
    ("key", "values", "part", "words"),
    [
        ("surface.hurst_exponent", "[0.5, 0.7, 0.9]", "Surface", "Hurst exponent 0.5, 0.7 and 0.9 between"),
        ("surface.rms_height", '["1 nm", "2 angstrom"]', "Surface", "h_rms = 1 nm and 2 Å"),
        ("surface.size", '["416 angstrom", "520 angstrom"]', "Surface", "41.6 nm × 41.6 nm and 52 nm × 52 nm"),
        ("surface.low_mode", "[0.5, 1]", "Surface", "flat spectrum from 0.5 or 1 to 2"),
        ("surface.roll_off_mode", "[2, 3]", "Surface", "between 2 or 3 and 6 times"),
        ("surface.cutoff_mode", "[6, 7]", "Surface", "between 2 and 6 or 7 times"),
        ("surface.normalisation", '["realised", "spectrum"]', "Surface", "each sample exactly and in the mean"),
        ("surface.seed", "[4, 5]", "Surface", "2 realisations (seed 4, 5)"),
        ("material.youngs_modulus", '["1 GPa", "20 MPa"]', "Block", "E = 1 GPa and 20 MPa"),
        ("material.youngs_modulus", '["1 GPa", "20 MPa"]', "Block", "= 1.2142 GPa and 24.284 MPa"),
        ("material.poissons_ratio", "[0.3, 0.42]", "Block", "ν = 0.3 and 0.42"),
        ("interaction.well_depth", '["18.6 meV", "20 meV"]', "Interaction", "ε₀ = 18.6 meV and 20 meV"),
        ("interaction.length", '["3 angstrom", "3.28 angstrom"]', "Interaction", "r₀ = 3 Å and 3.28 Å"),
        ("interaction.contact_distance", '["3.5 angstrom", "4 angstrom"]', "Interaction", "below 3.5 Å and 4 Å"),
        ("loading.unload", "[false, true]", "Loading", "then back through the same values"),
    ],
)
def test_a_swept_key_is_named_with_all_its_values(key, values, part, words):
    # Written in the sweep only: a key that stands in its section, too, is the first of nothing.
    name = key.rpartition(".")[2]
    lines = [line for line in SINGLE.splitlines() if not line.startswith(f"{name} =")]
    assert words in described("\n".join([*lines, "[sweep]", f'"{key}" = {values}']))[part]


def test_many_values_are_named_by_their_ends():
    values = ", ".join(f"{0.5 + 0.01 * number:.2f}" for number in range(20))
    text = f'{SINGLE}[sweep]\n"surface.hurst_exponent" = [{values}]\n'
    assert "Hurst exponent 0.5 to 0.69 (20 values) between" in described(text)["Surface"]


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ("", "Rigid, periodic, height map map.npy less its mean, edges as they are, 1 µm × 2 µm."),
        ('detrend = "tilt"\nedges = "window"', "less its mean plane, edges faded to the mean, 1 µm × 2 µm."),
        ('edges = "mirror"', "edges joined to mirror images, its size from the file."),
    ],
)
def test_a_measured_surface_is_told_with_what_was_done_to_it(keys, words):
    # A file that is no longer there: what is known is in the study.
    surface = f'[surface]\nkind = "file"\npath = "map.npy"\nsize = ["1 um", "2 um"]\n{keys}\n'
    law = '[interaction]\nlaw = "hard_wall"\n[loading]\npath = ["1 MPa"]\n'
    text = f'{surface}[material]\nyoungs_modulus = "1 GPa"\npoissons_ratio = 0.3\n{law}'
    assert words in described(text, names=("continuum",))["Surface"]


def test_kinds_of_surfaces_side_by_side():
    text = SINGLE.replace('kind = "self_affine"', 'radius = "20 nm"\namplitude = "1 nm"\npath = "map.npy"')
    text += '[sweep]\n"surface.kind" = ["self_affine", "sphere", "wavy", "flat", "file"]\n'
    words = described(text)["Surface"]
    for part in (
        "Rigid, periodic, randomly rough",
        "a rigid sphere of radius 20 nm",
        "amplitude 1 nm",
        "rigid and flat",
    ):
        assert part in words
    assert "height map map.npy" in words
    assert words.count("Hurst") == 1


def test_laws_side_by_side():
    text = SINGLE.replace('well_depth = "18.6 meV"', 'work_of_adhesion = "0.69 J/m^2"')
    text += '[sweep]\n"interaction.law" = ["lennard_jones_10_4", "lennard_jones_9_3", "hard_wall"]\n'
    words = described(text, names=("continuum", "theory"))
    assert "smeared into the 10-4 and in the 9-3 traction-separation law for continuum" in words["Interaction"]
    assert "At law = hard wall a wall without adhesion" in words["Interaction"]
    assert "Δγ = 0.69 J/m²" in words["Interaction"], "the hard wall's zero is none of them"
    assert "adhered branch" in words["Loading"]


def test_attraction_outside_a_wall():
    text = SINGLE.replace('well_depth = "18.6 meV"', 'law = "exponential"\nwork_of_adhesion = "0.69 J/m^2"')
    text = text.replace('contact_distance = "3.68 angstrom"\n', "")
    words = described(text, names=("continuum", "theory"))["Interaction"]
    assert words.startswith(
        "Attraction (Δγ/ρ) exp(−u/ρ) outside a hard wall, of length 3.28 Å. Work of adhesion Δγ = 0.69"
    )
    assert "points that touch it count as contact" in words
    assert "Lennard-Jones" not in words
    assert "Gaps below" not in words


def test_a_hard_wall_alone():
    text = SINGLE.replace('well_depth = "18.6 meV"', 'law = "hard_wall"')
    words = described(text, names=("continuum", "theory"))
    assert words["Interaction"] == "Hard wall without adhesion; contact is where the pressure is positive."
    assert "adhered branch" not in words["Loading"]


def test_points_with_paths_of_their_own_are_named_with_units():
    text = SINGLE + '[sweep]\n"surface.cutoff_mode" = [6, 7]\n"material.youngs_modulus" = ["50 GPa", "77.2 GPa"]\n'
    text += '[[override]]\nwhen = { "material.youngs_modulus" = "50 GPa" }\n"loading.path" = ["1 GPa"]\n'
    words = described(text)["Loading"]
    assert "1 GPa (q₁ L/2π = 6, E = 50 GPa; q₁ L/2π = 7, E = 50 GPa)" in words
    assert "0.1, 0.7799, 5.8725 GPa (q₁ L/2π = 6, E = 77.2 GPa; q₁ L/2π = 7, E = 77.2 GPa)" in words


def test_realisations_are_those_of_the_datasets():
    six = SINGLE + '[sweep]\n"surface.seed" = [1, 2, 3, 4, 5, 6]\n'
    five = six.replace(", 6]", "]")
    words = described(six, five)["Surface"]
    assert "6 realisations (seed 1, 2, 3, 4, 5, 6), the atoms on seed 1, 2, 3, 4, 5 only" in words
    notes = " ".join(sample_notes(inputs_of(six, five)))
    assert "the simulations have 5 or 6 realisations of it" in notes
    assert "same surfaces" in notes
    assert "one realisation of it" in " ".join(sample_notes(inputs_of(SINGLE)))


def test_what_only_a_later_file_has_is_described_too():
    first = SINGLE + '[sweep]\n"surface.hurst_exponent" = [0.5]\n'
    second = SINGLE + '[sweep]\n"surface.hurst_exponent" = [0.5, 0.8]\n'
    assert "Hurst exponent 0.5 and 0.8" in described(first, second, names=("continuum", "theory"))["Surface"]


def test_the_block_says_what_solid_it_is():
    layered = STUDY + '[elasticity]\nkind = "layer"\nthickness = "5 nm"\n'
    swept = layered.replace("[sweep]\n", '[sweep]\n"elasticity.thickness" = ["5.2 nm", "10.4 nm"]\n')
    for text, words in (
        (STUDY, "Elastic, E = "),
        (layered, "Elastic, a layer of thickness 5 nm bonded to a rigid base, E = "),
        (swept, "Elastic, a layer of thickness 5.2 nm and 10.4 nm bonded to a rigid base, E = "),
    ):
        assert described(text)["Block"].startswith(words)


def test_predictors_of_joined_parts_are_all_named(tmp_path):
    predictor = f"bem-1.nc sha256:{'0' * 64}\nbem-2.nc sha256:{'1' * 64}"
    path = write(tmp_path / "md.nc", "atomistic", SINGLE, predictor=predictor)
    loading = dict(study_paragraphs(read_inputs([path])))["Loading"]
    assert "the continuum's gap field (bem-1.nc and bem-2.nc)" in loading
