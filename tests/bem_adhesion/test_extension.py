"""Extension from a contact set: what it keeps, what it fills, and that its transpose is one."""

import numpy as np
import pytest

from bem_adhesion.hard_wall.preconditioner import Extension

SHAPES = [(16, 16), (13, 7), (1, 9), (5, 1), (6, 32), (2, 3)]


def random_case(shape, seed=0):
    rng = np.random.default_rng(seed)
    contact = rng.random(shape) < 0.4
    contact[0, 0] = True
    extension = Extension(contact)
    extension.update()
    field = np.where(contact, rng.standard_normal(shape), 0).astype(np.float32)
    return contact, extension, field, rng.standard_normal(shape).astype(np.float32)


@pytest.mark.parametrize("shape", SHAPES)
def test_transpose(shape):
    contact, extension, field, other = random_case(shape)
    extended = np.empty(shape, np.float32)
    extension.extend(field, extended)
    forward = np.vdot(extended.astype(float), other)
    extension.transpose(transposed := other.copy())
    backward = np.vdot(field[contact].astype(float), transposed[contact])
    # Single precision, sums of up to 256 terms.
    assert forward == pytest.approx(backward, abs=1e-6 * float(np.linalg.norm(extended) * np.linalg.norm(other)))


@pytest.mark.parametrize("shape", SHAPES)
def test_values_in_contact_are_kept_and_holes_filled_within_their_range(shape):
    contact, extension, field, _ = random_case(shape)
    field[contact] = np.abs(field[contact])
    extended = np.empty(shape, np.float32)
    extension.extend(field, extended)
    np.testing.assert_array_equal(extended[contact], field[contact])
    assert extended.min() >= 0
    assert extended.max() <= field.max() * (1 + 1e-6)  # averages, to single precision


@pytest.mark.parametrize("shape", SHAPES)
def test_axes_are_alike(shape):
    contact, extension, field, _ = random_case(shape)
    extension.extend(field, extended := np.empty(shape, np.float32))
    turned = Extension(np.ascontiguousarray(contact.T))
    turned.update()
    turned.extend(np.ascontiguousarray(field.T), other := np.empty(shape[::-1], np.float32))
    # Sums in another order, in single precision, of fields of order one.
    np.testing.assert_allclose(other.T, extended, rtol=0, atol=3e-6)


def test_hole_in_a_uniform_field_is_filled():
    contact = np.ones((32, 32), bool)
    contact[8, 21] = False
    extension = Extension(contact)
    extension.update()
    extended = np.empty((32, 32), np.float32)
    extension.extend(contact.astype(np.float32), extended)
    # One of four points of the cell is missing: its own average 3/4 shares 9/16 of the weight, the rest is whole.
    assert extended[8, 21] > 0.8
