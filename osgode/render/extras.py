"""Loads the packages that drawing needs only when something is drawn."""

from __future__ import annotations

import importlib
import os
from typing import Any

from osgode.errors import MissingExtraError

# pygame greets on standard output when imported; a library has no business there.
os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")


def require(module: str, extra: str = "render") -> Any:
    """The imported module ``module``, which the extra ``extra`` of osgode installs.

    Raises:
        MissingExtraError: if it is not installed.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise MissingExtraError(
            f"this needs the package {module.partition('.')[0]!r}: pip install osgode[{extra}]"
        ) from error
