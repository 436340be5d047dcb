"""Drawers for the tests, made once: a context takes longer than a picture."""

import pytest

from osgode.errors import OsgodeError
from osgode.render import OffscreenDrawer, Quality


def _open(size, quality):
    try:
        return OffscreenDrawer(size, quality)
    except OsgodeError as error:
        pytest.skip(str(error))


@pytest.fixture(scope="session")
def drawer():
    """Small pictures with one sample a pixel, so that colours are exact."""
    with _open((160, 100), Quality(samples=0, shadow_size=512)) as result:
        yield result


@pytest.fixture(scope="session")
def fine_drawer():
    """Small pictures of full quality."""
    with _open((160, 100), Quality(samples=4, shadow_size=1024)) as result:
        yield result
