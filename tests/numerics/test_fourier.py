"""Transforms and grids, exact on trigonometric polynomials, on any shape; the memory of their fields."""

import errno
import os
import subprocess
import sys
from unittest.mock import Mock

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contact_study.numerics import fourier
from contact_study.numerics.grid import Grid
from contact_study.numerics.kernel import inner_product
from contact_study.numerics.memory import ALIGNMENT, Memory, Scratch, aligned

SHAPES = [(8, 9), (9, 8), (12, 5), (1, 6), (6, 1)]


def random_field(shape, seed=0):
    return np.random.default_rng(seed).standard_normal(shape)


@pytest.mark.parametrize("shape", SHAPES)
def test_laplacian_of_a_wave_and_variances_of_all(shape):
    grid, field = Grid(shape, (3.0, 5.0)), random_field(shape) + 3.0
    variances = grid.variances(fourier.transform(field))
    assert variances[0, 0] == 0.0
    assert np.sum(variances) == pytest.approx(np.var(field), rel=1e-13)  # rounding of a sum of 100 terms
    y, x = grid.coordinates
    q_y, q_x = 2 * np.pi * ((shape[0] - 1) // 2) / 3.0, 2 * np.pi * ((shape[1] - 1) // 2) / 5.0
    plan = fourier.RealTransform(shape)
    wave = plan.field[...] = np.cos(q_y * y[:, None] + q_x * x[None, :] + 0.3)
    plan.forward()[...] *= grid.wavenumber**2 / grid.points
    scale = max(q_y**2 + q_x**2, 1.0)
    np.testing.assert_allclose(plan.backward() / scale, (q_y**2 + q_x**2) / scale * wave, atol=1e-13)
    assert plan.pairs == 1


@pytest.mark.validation
@settings(max_examples=25, deadline=None)
@given(st.tuples(*[st.integers(1, 9)] * 2), st.tuples(*[st.integers(0, 8)] * 2), st.integers(0, 99))
def test_interpolation_keeps_the_samples_and_is_undone(shape, more, seed):
    field = random_field(shape, seed)
    factors = (1 + more[0] // 4, 1 + more[1] // 4)
    fine = fourier.interpolate(field, (shape[0] * factors[0], shape[1] * factors[1]))
    np.testing.assert_allclose(fine[:: factors[0], :: factors[1]], field, atol=1e-12)
    fine = fourier.interpolate(field, (shape[0] + more[0], shape[1] + more[1]))
    np.testing.assert_allclose(fourier.interpolate(fine, shape), field, atol=1e-12)


def test_stacked_fields_are_transformed_one_by_one_in_one_memory():
    scratch, kinds = Scratch(), [((6, 5), np.float32, 1e-5), ((3, 6, 7), np.float64, 1e-13)]
    plans = [fourier.RealTransform(shape, dtype, scratch=scratch) for shape, dtype, _ in [*kinds, kinds[0]]]
    assert np.shares_memory(plans[1].spectrum, plans[2].spectrum)
    for plan, (shape, _, rounding) in zip(plans, kinds, strict=False):
        plan.field[...] = field = random_field(shape)
        np.testing.assert_allclose(plan.forward(), np.fft.rfft2(field), atol=rounding)


def wisdom_of_a_plan(folder, monkeypatch, shape=(14, 22)):
    monkeypatch.setenv("BEM_ADHESION_CACHE", str(folder))
    monkeypatch.setattr(fourier, "_planned", set())  # as in a process of its own
    plan = fourier.RealTransform(shape)
    plan.field[...] = 1.0
    assert plan.forward()[0, 0] == pytest.approx(shape[0] * shape[1])
    return folder / "fftw-wisdom.txt"


@pytest.mark.parametrize("where", [0, 300])
def test_damaged_wisdom_is_measured_anew(tmp_path, monkeypatch, where):
    imported, path = [], wisdom_of_a_plan(tmp_path, monkeypatch)
    content = bytearray(path.read_bytes())
    content[where] ^= 1
    path.write_bytes(content)
    monkeypatch.setattr(fourier._fftw(), "import_wisdom", imported.append)
    wisdom_of_a_plan(tmp_path, monkeypatch, (14, 26))
    assert not imported, "of a bit that is another"
    wisdom_of_a_plan(tmp_path, monkeypatch, (14, 30))
    assert len(imported) == 1, "what was written in its place is whole"


def test_without_locks_plans_are_not_kept(tmp_path, monkeypatch):
    monkeypatch.setattr("fcntl.flock", Mock(side_effect=OSError(errno.ENOLCK, "no locks")))
    wisdom_of_a_plan(tmp_path, monkeypatch, (14, 34))
    assert not list(tmp_path.iterdir())


def test_threads_that_wait_sleep():
    environment = {key: value for key, value in os.environ.items() if key != "OMP_WAIT_POLICY"}
    command = [sys.executable, "-c", "from contact_study.numerics import fourier; fourier.RealTransform((4, 4))"]
    environment["OMP_DISPLAY_ENV"] = "true"
    shown = subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stderr
    assert "OMP_WAIT_POLICY = 'PASSIVE'" in shown


def test_a_large_field_leaves_no_buffers_behind(monkeypatch):
    monkeypatch.setattr(fourier, "POINTS_TO_HOLD", 100)
    fourier._held.cache_clear()
    for shape, held in (((10, 10), 1), ((10, 11), 1), ((5, 4), 2)):
        field = random_field(shape)
        np.testing.assert_allclose(fourier.synthesise(fourier.transform(field), shape), field, atol=1e-14)
        assert fourier._held.cache_info().currsize == held


def test_arrays_lie_side_by_side_in_what_is_lent_and_beyond_it_anew():
    lent = aligned(1000)
    memory = Memory(lent)
    first, second = memory.array((5, 7), np.float64), memory.array((3, 5, 7), np.float32)
    beyond, fits = memory.array((5, 7), np.float64), memory.array((4,), np.float64)
    for array, inside in ((first, True), (second, True), (beyond, False), (fits, True)):
        assert np.shares_memory(array, lent) == inside
        assert array.ctypes.data % ALIGNMENT == 0
    for one, other in ((first, second), (second, fits), (first, fits)):
        assert not np.shares_memory(one, other)
    assert not np.shares_memory(Memory().array((2, 3), np.float32), Memory().array((2, 3), np.float32))
    # Scratch is one memory, as large as its largest array.
    scratch, kind = Scratch(), np.dtype(np.complex128)
    large, small, larger = (scratch.array(shape, kind) for shape in ((8, 4), (3, 2), (9, 9)))
    assert np.shares_memory(large, small)
    assert not np.shares_memory(large, larger)
    assert larger.ctypes.data % ALIGNMENT == 0


@pytest.mark.parametrize("shape", [(7,), (3, 20, 31)])
def test_inner_product_has_the_same_bits_wherever_the_fields_lie(shape):
    one, other = np.random.default_rng(0).standard_normal((2, *shape))
    # Rounding: 1e-16 of the sum of magnitudes, which is 1e4 at most.
    assert inner_product(one, other) == pytest.approx(np.sum(one * other), abs=1e-11)
    single = other.astype(np.float32)[::2]
    assert inner_product(one[::2], single) == pytest.approx(np.sum(one[::2] * single), abs=1e-11)
    moved = [np.append(np.empty(shift), one)[shift:].reshape(shape) for shift in range(8)]
    assert len({inner_product(field, other) for field in moved}) == 1
