"""A constant tension out to a finite reach, with an exponential core in place of the wall."""

from dataclasses import dataclass

from contact_study.physics.laws.base import TractionLaw
from contact_study.physics.laws.cored import CoredInteraction, CoredLaw
from contact_study.physics.laws.dugdale import RAMP, Dugdale, ramp_key


@dataclass(frozen=True, kw_only=True)
class DugdaleCoreInteraction(CoredInteraction):
    """A core shorter than the ramp at the end of the tension, which it would outlast."""

    ramp: float = ramp_key()

    def __post_init__(self):
        super().__post_init__()
        self._check_core(self.ramp * self.range, "the ramp, interaction.ramp × interaction.range")


@dataclass(frozen=True)
class DugdaleCore(CoredLaw):
    """Constant tension over ``range`` from the equilibrium distance on, with a core."""

    title = "Dugdale with a core"
    words = "A constant tension out to a finite reach, with an exponential core"
    section = DugdaleCoreInteraction

    ramp: float = RAMP

    def _outside_wall(self, work_of_adhesion: float) -> TractionLaw:
        return Dugdale(work_of_adhesion, self.range, self.ramp)
