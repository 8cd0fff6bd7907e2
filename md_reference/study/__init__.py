"""The ways that atoms come along a loading path, by the word of ``atomistic.method``."""

from collections.abc import Mapping

from md_reference.study import dynamics, overdamped, quasi_static, sampling
from md_reference.study.method import Method

METHODS: Mapping[str, Method] = {
    "quasi_static": quasi_static.solve_path,
    "overdamped": overdamped.solve_path,
    "sampling": sampling.solve_path,
    "dynamics": dynamics.solve_path,
}
