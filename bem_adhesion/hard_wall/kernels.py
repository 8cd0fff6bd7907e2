"""Passes over the points of a surface and its contact set, each fused to one or two sweeps through memory.

Arrays are flat unless said, of one size; ``contact`` is the indicator of the contact set.
"""

import numpy as np
from numba import njit

_FAST = {"contract", "reassoc", "arcp", "nsz"}


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def offset(displacement, heights, contact):
    """Mean of displacement − heights over the contact set."""
    total = 0.0
    count = 0
    for i in range(contact.size):
        if contact[i]:
            total += displacement[i] - heights[i]
            count += 1
    return total / count


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def enter(displacement, heights, offset, threshold, contact):
    """Let points that penetrate by more than ``threshold`` enter the contact set; how many, and the deepest other."""
    entered = 0
    deepest = 0.0
    for i in range(contact.size):
        if not contact[i]:
            depth = heights[i] + offset - displacement[i]
            if depth > threshold:
                contact[i] = True
                entered += 1
            elif depth > deepest:
                deepest = depth
    return entered, deepest


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def residual(displacement, heights, offset, contact, residual):
    """Negative gap on the contact set, zero elsewhere; returns its largest magnitude."""
    largest = 0.0
    for i in range(contact.size):
        if contact[i]:
            depth = heights[i] + offset - displacement[i]
            residual[i] = depth
            largest = max(largest, abs(depth))
        else:
            residual[i] = 0
    # max() passes over what is not a number; the offset, a sum, does not.
    return largest + 0.0 * offset


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def products(preconditioned, residual, contact):
    """Mean of the preconditioned residual over the contact set, and its product with the residual."""
    total = 0.0
    product = 0.0
    count = 0
    for i in range(contact.size):
        if contact[i]:
            total += preconditioned[i]
            product += preconditioned[i] * residual[i]
            count += 1
    return total / count, product


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def turn(preconditioned, mean, weight, contact, direction):
    """direction = preconditioned − mean + weight direction on the contact set, copied over the first argument."""
    shift = np.float32(mean)
    factor = np.float32(weight)
    for i in range(contact.size):
        if contact[i]:
            direction[i] = preconditioned[i] - shift + factor * direction[i]
        else:
            direction[i] = 0
        preconditioned[i] = direction[i]


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def advance(pressure, residual, direction, response, contact, product):
    """One step along ``direction``, whose displacement is ``response``; returns the largest residual left."""
    curvature = 0.0
    total = 0.0
    count = 0
    for i in range(contact.size):
        if contact[i]:
            curvature += direction[i] * response[i]
            total += response[i]
            count += 1
    length = product / curvature
    factor = np.float32(length)
    mean = np.float32(total / count)
    largest = np.float32(0)
    for i in range(contact.size):
        if contact[i]:
            pressure[i] += length * direction[i]
            residual[i] -= factor * (response[i] - mean)
            largest = max(largest, abs(residual[i]))
    return largest


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def leave(pressure, contact, change):
    """Let points that pull leave the contact set, note the change; how many, and the sum of the pressures left."""
    left = 0
    total = 0.0
    for i in range(contact.size):
        if pressure[i] < 0:
            change[i] = -pressure[i]
            pressure[i] = 0
            contact[i] = False
            left += 1
        else:
            change[i] = 0
        total += pressure[i]
    return left, total


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def rescale(pressure, factor, change):
    """Multiply the pressure by a factor and add what that changes to ``change``."""
    for i in range(pressure.size):
        change[i] += (factor - 1.0) * pressure[i]
        pressure[i] *= factor


@njit(cache=True, error_model="numpy", fastmath=_FAST)
def refine(signed, refined):
    """Bilinear interpolation to a periodic grid of twice as many points along each side."""
    rows, columns = signed.shape
    for i in range(rows):
        below = (i + 1) % rows
        for j in range(columns):
            right = (j + 1) % columns
            refined[2 * i, 2 * j] = signed[i, j]
            refined[2 * i, 2 * j + 1] = 0.5 * (signed[i, j] + signed[i, right])
            refined[2 * i + 1, 2 * j] = 0.5 * (signed[i, j] + signed[below, j])
            refined[2 * i + 1, 2 * j + 1] = 0.25 * (
                signed[i, j] + signed[i, right] + signed[below, j] + signed[below, right]
            )
