"""What a user writes beside the package: a law, a solid, a surface and an observable of their own, as a plug-in."""

from dataclasses import dataclass

import numpy as np

import contact_study
from contact_study.physics.laws import TractionLaw
from contact_study.physics.solids import HalfSpace
from contact_study.physics.surfaces.surface import Surface, SurfaceScales, spectrum_of_waves
from contact_study.results.state import Observable, Variable
from contact_study.study.schema.elasticity import ElasticitySection
from contact_study.study.schema.interaction import InteractionSection, SmoothInteraction
from contact_study.study.schema.keys import TEXT, key, quantity
from contact_study.study.schema.surface import CellSection


@dataclass(frozen=True)
class OwnMorse(TractionLaw):
    title, words, diverges, own_lengths = "Morse", "Morse's", False, ("width",)

    width: float

    def potential(self, gap):
        decay = np.exp(-(gap - self.length) / self.width)
        return self.work_of_adhesion * (decay**2 - 2 * decay)


@dataclass(frozen=True, kw_only=True)
class OwnInteraction(SmoothInteraction):
    width: float = key(quantity("m", positive=True), "range of my attraction")


@dataclass(frozen=True, kw_only=True)
class StrongInteraction(InteractionSection):
    width: float = key(quantity("m", positive=True), "range of my attraction")
    strength: float = key(quantity("Pa", positive=True), "work of my attraction over its length")

    def make_law(self, work_of_adhesion):
        return StrongMorse(self.strength * self.length, self.length, self.width)


@dataclass(frozen=True)
class StrongMorse(OwnMorse):
    pass


@dataclass(frozen=True)
class Ridge(Surface):
    amplitude: float

    def heights(self, shape):
        return np.tile(self.amplitude * np.cos(2 * np.pi * np.arange(shape[1]) / shape[1]), (shape[0], 1))


@dataclass(frozen=True, kw_only=True)
class RidgeSection(CellSection):
    words = "ridges of height {ridge_height}, {size}"
    height_key = "surface.ridge_height"

    ridge_height: float = key(quantity("m", positive=True), "amplitude of my ridges")
    path: str = key(TEXT, "height map, relative to the study file", "ridges.txt")

    def realise(self, directory):
        return Ridge(self.size, self.shape, None, self.ridge_height)

    def scales(self, directory):
        q, height = 2 * np.pi / self.size[1], self.ridge_height / 2**0.5
        waves = spectrum_of_waves(np.array([q]), np.array([height**2]))
        return SurfaceScales(self.size, self.shape, height, q * height, 2 * self.ridge_height, self.size[1], waves)


@dataclass(frozen=True, kw_only=True)
class StiffSection(ElasticitySection):
    words = "stiffened {stiffening}-fold, "

    stiffening: float = key(quantity("1", positive=True), "factor of my modulus", 1.0)

    def solid(self, material):
        return HalfSpace(self.stiffening * material.contact_modulus)


LARGEST_GAP = Observable(
    {"largest_gap": Variable("m", "largest local gap")}, lambda state, bins: {"largest_gap": float(state.gap.max())}
)

contact_study.register_law("own_morse", OwnMorse, OwnInteraction)
contact_study.register_law("strong_morse", StrongMorse, StrongInteraction)
contact_study.register_solid("stiff", StiffSection)
contact_study.register_surface("ridge", RidgeSection)
contact_study.register_observable(LARGEST_GAP)
