from contact_study.campaign.progress import Progress
from contact_study.start import bem_adhesion


def test_a_line_says_what_became_of_a_step(capsys):
    progress = Progress("toy")
    progress.start(3, 0)
    progress.step(
        "", "1 GPa", {"relative_contact_area": 0.25, "converged": True, "detached": False, "message": ""}, 1.0
    )
    apart = {"relative_contact_area": 0.0, "converged": True, "detached": True, "message": "detached: torn off"}
    progress.step("case 2", "-1 GPa", apart, 0.1)
    lost = {"relative_contact_area": 0.5, "converged": False, "detached": False, "message": ""}
    progress.step("", "2 GPa", lost, 0.1)
    assert capsys.readouterr().err.splitlines() == [
        "toy: [1/3] 1 GPa, contact area 0.2500 (1.0 s)",
        "toy: [2/3] case 2: -1 GPa, detached: torn off (0.1 s)",
        "toy: [3/3] 2 GPa, contact area 0.5000, NOT CONVERGED (see residual) (0.1 s)",
    ]


def test_tension_on_separated_surfaces_says_so(tmp_path, capsys):
    study = tmp_path / "study.toml"
    study.write_text(
        """
        [surface]
        kind = "wavy"
        size = "10 nm"
        shape = [32, 32]
        amplitude = "1 angstrom"
        modes = [1, 1]
        [material]
        youngs_modulus = "77.2 GPa"
        poissons_ratio = 0.42
        [interaction]
        law = "lennard_jones_10_4"
        work_of_adhesion = "0.1 J/m^2"
        length = "3.28 angstrom"
        [loading]
        path = ["-1 MPa", "1 MPa"]
        """
    )
    assert bem_adhesion([str(study), "-o", str(tmp_path / "out.nc")]) == 0
    lines = capsys.readouterr().err
    words = "the surfaces are separated; start the loading path with a positive pressure"
    assert f"[1/2] -1 MPa, detached: {words}" in lines
    assert "[2/2] 1 MPa, contact area" in lines
