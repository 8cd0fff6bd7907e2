"""The lattices of block and substrate that fill the cell of a study."""

from dataclasses import dataclass

from contact_study.inputs.errors import InputError

GOLDEN_MEAN = (1 + 5**0.5) / 2


@dataclass(frozen=True)
class Lattice:
    """Atoms of the block's bottom layer on the sites of a substrate that is incommensurate with it."""

    size: tuple[float, float]  # periods of the cell along y and x (m)
    constant: float  # of the block's lattice (m)
    atoms: tuple[int, int]  # of the block's bottom layer along y and x

    @property
    def substrate_sites(self) -> tuple[int, int]:
        """Sites of the substrate layer along y and x: the golden mean times the atoms, to the nearest integer."""
        rows, columns = self.atoms
        return round(GOLDEN_MEAN * rows), round(GOLDEN_MEAN * columns)

    @property
    def site_spacing(self) -> tuple[float, float]:
        """Distance of neighbouring sites of the substrate along y and x (m)."""
        return self.size[0] / self.substrate_sites[0], self.size[1] / self.substrate_sites[1]

    @property
    def densities(self) -> tuple[float, float]:
        """Atoms and substrate sites per area (1/m²)."""
        area, sites = self.size[0] * self.size[1], self.substrate_sites
        return self.atoms[0] * self.atoms[1] / area, sites[0] * sites[1] / area


def lattice_of(size: tuple[float, float] | None, constant: float | None) -> Lattice:
    """Find the lattices of a cell by its size and the block's lattice constant (m); InputError if they do not fit."""
    if constant is None:
        raise InputError("missing key material.lattice_constant: atoms and interaction.well_depth need it")
    if size is None:
        raise InputError("missing key surface.size: atoms need it")
    counts = []
    for length in size:
        number = length / constant
        # An integer up to the rounding of two decimal inputs.
        if abs(number - round(number)) > 1e-6 * number or round(number) < 4:
            raise InputError(
                f"material.lattice_constant = {constant:g} m: {length:g} m holds {number:.6g} atoms, "
                f"not a whole number of at least 4; {length / max(round(number), 4):.6g} m divides it"
            )
        counts.append(round(number))
    return Lattice(size, constant, (counts[0], counts[1]))
