"""Channels of an instrument's file: which are heights, which one is meant."""

import numpy as np
import pytest

from contact_study.physics.height_maps.height_map import read_height_map
from tests.study.test_map_text import refused

pytest.importorskip("SurfaceTopography", reason="extra instruments")

SIDE, HEADER = 8, 8192
CHANNELS = {"ZSensor": "Sens. Z", "AmplitudeError": "Sens. A", "Phase": "Sens. P", "Height": "Sens. Z"}


def nanoscope(path, *names):
    """A file of a scanning probe microscope: a text header, then integers of 10 V / 2¹⁶, 100 nm/V or 3 °/V."""
    lines = ["\\*File list", "\\Version: 0x05300000", "\\Data length: 8192"]
    lines += ["\\*Scanner list", "\\@Sens. Z: V 100 nm/V", "\\@Sens. A: V 2 nm/V", "\\@Sens. P: V 3 deg/V"]
    for number, name in enumerate(names):
        lines += ["\\*Ciao image list", f"\\Data offset: {HEADER + number * 2 * SIDE**2}", "\\Bytes/pixel: 2"]
        lines += [f"\\Data length: {2 * SIDE**2}", f"\\Samps/line: {SIDE}", f"\\Number of lines: {SIDE}"]
        lines += [
            "\\Scan Size: 2000 2000 nm",
            f'\\@2:Image Data: S [{name}] "{name}"',
            f"\\@2:Z scale: V [{CHANNELS[name]}] (0.0001525879 V/LSB) 10.0 V",
        ]
    text = "\r\n".join([*lines, "\\*File list end"]).encode("latin-1")
    fields = np.random.default_rng(1).integers(-9000, 9000, (len(names), SIDE, SIDE)).astype("<i2")
    path.write_bytes(text + b"\r\n\x1a" + b"\0" * (HEADER - len(text) - 3) + fields.tobytes())
    return 10 / 2**16 * 100e-9 * fields[:, ::-1]  # rows begin at the top


def test_the_only_height_is_taken(tmp_path):
    name = "map.001"
    fields = nanoscope(tmp_path / name, "Phase", "ZSensor", "AmplitudeError")
    for channel in (None, 1, "ZSensor"):
        found = read_height_map(tmp_path / name, channel=channel)
        np.testing.assert_allclose(found.heights, fields[1], rtol=1e-6)
        assert found.size == pytest.approx((2e-6, 2e-6), abs=0, rel=1e-9)
    nanoscope(tmp_path / name, "Phase")
    assert "holds no map of heights; it has 0: Phase (not a height)" in refused(tmp_path / name)


def test_several_heights_leave_a_choice(tmp_path):
    fields = nanoscope(tmp_path / "map.di", "ZSensor", "AmplitudeError", "Phase", "Height")
    listed = "0: ZSensor (height), 1: AmplitudeError (not a height), 2: Phase (not a height), 3: Height (height)"
    assert f"holds 2 maps of heights ({listed})" in refused(tmp_path / "map.di")
    for channel in (3, "Height"):
        found = read_height_map(tmp_path / "map.di", channel=channel)
        np.testing.assert_allclose(found.heights, fields[3], rtol=1e-6)
    none = f"there is no such channel; {tmp_path / 'map.di'} has {listed}"
    for channel, words in (("Phase", "is no map of heights; "), (1, "is no map of heights; "), ("X", none), (4, none)):
        assert f"{channel!r}: {words}" in refused(tmp_path / "map.di", channel=channel)


def test_a_line_scan_of_an_instrument_is_named(tmp_path):
    rows = "".join(f"{x:.4f},{np.sin(x):.4f}\n" for x in 0.1 * np.arange(20))
    (tmp_path / "line.csv").write_text("X_(microns),y1\n" + rows)
    assert "line.csv holds a line scan (20 points)" in refused(tmp_path / "line.csv")
