"""What the gallery gives the examples for arguments."""

import tempfile
from pathlib import Path


class _IntoScratch:
    """Figures into a scratch folder: the gallery takes its own copies."""

    def __repr__(self) -> str:
        return "figures into a scratch folder"  # the same in every build: nothing is drawn anew for it

    def __call__(self, gallery: dict, script: dict) -> list[str]:
        return ["-o", str(Path(tempfile.gettempdir()) / f"{Path(script['src_file']).stem}.png")]


into_scratch = _IntoScratch()
