"""The benchmark script runs and writes what it says."""

import xarray as xr

from scripts import benchmark_hard_wall


def test_benchmark_writes_a_table(tmp_path, capsys):
    output = tmp_path / "table.nc"
    arguments = ["--points", "64", "--pressures", "0.1", "--repeat", "1", "-o", str(output)]
    assert benchmark_hard_wall.main(arguments) == 0
    head, _, *lines = capsys.readouterr().out.splitlines()
    assert [len(line.split("|")) for line in lines] == [len(head.split("|"))] * 2
    with xr.open_dataset(output) as table:
        assert table.sizes == {"surface": 2, "points": 1, "relative_pressure": 1}
        assert ((table.fft_pairs > 5) & (table.fft_pairs < 40)).all()
        shares = [table[f"share_of_{part}"] for part in benchmark_hard_wall.PARTS]
        assert all((share > 0).all() for share in shares)
        assert (sum(shares) < 1).all()
