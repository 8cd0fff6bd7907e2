"""Loops over the points of a hard wall: flat arrays unless stated, of one size; ``contact`` marks the contact set."""

import numpy as np

from contact_study.numerics.kernel import kernel

_MOST_SHIFTS = 100


@kernel
def offset(displacement, heights, contact):
    """Return the mean of displacement − heights over the contact set."""
    total = 0.0
    count = 0
    for i in range(contact.size):
        if contact[i]:
            total += displacement[i] - heights[i]
            count += 1
    return total / count


@kernel
def enter(displacement, heights, offset, threshold, contact):
    """Add points that penetrate by more than ``threshold`` to the contact set; return their number, the next depth."""
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


@kernel
def residual(displacement, heights, offset, contact, residual):
    """Write the negative gap on the contact set, zero elsewhere; return its largest magnitude."""
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


@kernel
def products(preconditioned, residual, contact):
    """Return the mean of the preconditioned residual over the contact set, and its product with the residual."""
    total = 0.0
    product = 0.0
    count = 0
    for i in range(contact.size):
        if contact[i]:
            total += preconditioned[i]
            product += preconditioned[i] * residual[i]
            count += 1
    return total / count, product


@kernel
def turn(preconditioned, mean, weight, contact, direction):
    """Write preconditioned − mean + weight·direction on the contact set into ``direction`` and the first argument."""
    shift = np.float32(mean)
    factor = np.float32(weight)
    for i in range(contact.size):
        if contact[i]:
            direction[i] = preconditioned[i] - shift + factor * direction[i]
        else:
            direction[i] = 0
        preconditioned[i] = direction[i]


@kernel
def advance(pressure, residual, direction, response, contact, product):
    """Take one step along ``direction``, whose displacement is ``response``; return the largest residual left."""
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


@kernel
def leave(pressure, contact, change):
    """Remove points that pull from the contact set, write the change; return their number, the sum of the pressures."""
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


@kernel
def rescale(pressure, factor, change):
    """Multiply the pressure by a factor and add the difference to ``change``."""
    for i in range(pressure.size):
        change[i] += (factor - 1.0) * pressure[i]
        pressure[i] *= factor


@kernel
def refine(signed, refined):
    """Interpolate bilinearly to a periodic grid of twice as many points along each side; arrays (y, x)."""
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


@kernel
def descended(displacement, heights, pressure, stiffness, result):
    """Write pressure − stiffness·(displacement − heights), zero without a surface; return where there is one."""
    present = np.empty(pressure.size, np.bool_)
    for i in range(pressure.size):
        present[i] = heights[i] > -np.inf
        result[i] = pressure[i] - stiffness * (displacement[i] - heights[i]) if present[i] else 0.0
    return present


@kernel
def judge(displacement, heights, offset, pressure, bound, free):
    """Mark the points that may move: between the bounds, or pushed inwards from one; return the largest violation."""
    worst = 0.0
    for i in range(pressure.size):
        clearance = displacement[i] - heights[i] - offset
        if pressure[i] <= 0:
            violation = -clearance
            free[i] = violation > 0
        elif pressure[i] >= bound:
            violation = clearance
            free[i] = violation > 0
        else:
            violation = abs(clearance)
            free[i] = True
        worst = max(worst, violation)
    # max() passes over what is not a number; the offset, a sum, does not.
    return worst + 0.0 * offset


@kernel
def balancing_shift(pressure, free, bound, total):
    """Return the shift of the free points with which all carry ``total``, what is missing, and how many are between."""
    # The zero of a piecewise linear, increasing function, by Newton's method and bisection.
    smallest, largest = np.inf, -np.inf
    saturated = 0
    for i in range(pressure.size):
        if free[i]:
            smallest = min(smallest, pressure[i])
            largest = max(largest, pressure[i])
        elif pressure[i] >= bound:
            saturated += 1
    low, high = -largest, bound - smallest
    shift, previous = 0.0, np.inf
    for _ in range(_MOST_SHIFTS):
        carried, inside, full = 0.0, 0, 0
        for i in range(pressure.size):
            if free[i]:
                p = pressure[i] + shift
                if p >= bound:
                    full += 1
                elif p > 0:
                    carried += p
                    inside += 1
        # Counted, not summed: near saturation a sum would lose the small rest.
        missing = total - (saturated + full) * bound - carried
        if abs(missing) <= 1e-15 * total:
            break
        if missing > 0:
            low = shift
        else:
            high = shift
        newton = shift + missing / max(inside, 1)
        if inside == 0 or abs(missing) > 0.5 * previous or not low < newton < high:
            newton = 0.5 * (low + high)
        if newton == shift:
            break
        shift, previous = newton, abs(missing)
    return shift, missing, inside


@kernel
def carry(pressure, free, bound, total):
    """Shift the free points and cut them off at the bounds so that all points carry ``total``."""
    shift, missing, inside = balancing_shift(pressure, free, bound, total)
    # The shift is as exact as the largest number that it is added to; points between the bounds take the rest.
    rest = missing / max(inside, 1)
    for i in range(pressure.size):
        if free[i]:
            p = pressure[i] + shift
            if 0 < p < bound:
                p += rest
            pressure[i] = min(max(p, 0.0), bound)


@kernel
def energy(displacement, heights, pressure):
    """Return Σ p (½ displacement − height), which the pressure minimises."""
    total = 0.0
    for i in range(pressure.size):
        if pressure[i] > 0:
            total += pressure[i] * (0.5 * displacement[i] - heights[i])
    return total
