"""What every test has: numbers that must stay finite, one course of random examples, and nothing left behind in ODE."""

import gc
import os

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

import osgode as oo
from tests.desktop import Desktop, missing_programs

np.seterr(all="raise", under="ignore")  # a NaN that numpy makes is an error; a product too small to matter is 0

settings.register_profile(
    "osgode", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow], print_blob=False
)
settings.load_profile("osgode")

OUTCOME = pytest.StashKey[bool]()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    report = yield
    if call.when == "call":
        item.stash[OUTCOME] = report.passed
    return report


def _left():
    counts = oo.live_natives()
    return counts._replace(bytes=0)  # ODE keeps caches of its own


@pytest.fixture(autouse=True)
def nothing_left(request):
    """No World, body, geom, space, joint, mesh or block of ODE's memory outlives a test.

    What was there before the test is not its fault: a test that failed is kept alive by its traceback.
    """
    before = _left()
    if any(before):
        gc.collect()
        before = _left()
    yield
    if not request.node.stash.get(OUTCOME, False):
        return
    after = _left()
    if any(after):
        gc.collect()
        after = _left()
    assert all(now <= then for now, then in zip(after, before, strict=True)), f"left in ODE: {after}"


@pytest.fixture(scope="session")
def desktop(tmp_path_factory):
    """A screen in memory with a window manager; each worker has its own.

    Who has no such programs goes without; where changes are judged nobody does, unless he refuses packages.
    """
    missing = missing_programs()
    if missing:
        reason = f"{', '.join(missing)} not found; `tools/setup.sh test` installs what real windows are tested with"
        if os.environ.get("CI") and not os.environ.get("NO_APT"):
            pytest.fail(reason)
        pytest.skip(reason)
    with Desktop(tmp_path_factory.mktemp("desktop")) as made:
        yield made
