"""A random generator as an array and back, to go on from."""

import numpy as np

_WORD = 2**64


def packed(generator: np.random.Generator) -> np.ndarray:
    """State of a generator of kind PCG64, shape (6,)."""
    state = generator.bit_generator.state
    words = [part for number in state["state"].values() for part in divmod(number, _WORD)]
    return np.array([*words, state["has_uint32"], state["uinteger"]], dtype=np.uint64)


def generator_of(words: np.ndarray) -> np.random.Generator:
    """The generator whose :func:`packed` state is given."""
    high, low, increment_high, increment_low, has_uint32, uinteger = map(int, words)
    bits = np.random.PCG64()
    bits.state = {
        "bit_generator": "PCG64",
        "state": {"state": high * _WORD + low, "inc": increment_high * _WORD + increment_low},
        "has_uint32": has_uint32,
        "uinteger": uinteger,
    }
    return np.random.Generator(bits)
