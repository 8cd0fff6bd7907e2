"""Where what takes long to find out is kept between runs."""

import os
from pathlib import Path

import platformdirs


def cache_folder() -> Path:
    """Folder of the user's own; ``BEM_ADHESION_CACHE`` names another. It need not exist, or be writable."""
    return Path(os.environ.get("BEM_ADHESION_CACHE") or platformdirs.user_cache_dir("bem-adhesion"))
