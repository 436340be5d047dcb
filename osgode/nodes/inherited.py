"""Fields of a body that have the World's value until they are given one of their own."""

from __future__ import annotations

from typing import Any

from osgode.fields import FLAG, Check, Followed
from osgode.native import lib


class Inherited(Followed):
    """A field that follows the World's value of the same name."""

    def __init__(self, getter: str, setter: str, check: Check[Any], *, unit: str = "", doc: str = "") -> None:
        get, put = getattr(lib, getter), getattr(lib, setter)
        super().__init__(
            check,
            (lambda body: bool(get(body._id))) if check is FLAG else (lambda body: get(body._id)),
            lambda body, value: put(body._id, value),
            lambda body, name: body._realm.inherited[name],
            unit=unit,
            doc=doc,
        )


class Countdown(Inherited):
    """`Inherited`, in force at once: ODE would first count down from what it was."""

    def enter(self, node: Any) -> None:
        """Give the native its own value, or the World's, and count anew if it is awake."""
        super().enter(node)
        if lib.dBodyIsEnabled(node._id):
            lib.dBodyEnable(node._id)


class AutoDisable(Inherited):
    """`Inherited`, without what else ODE does when the flag is taken away: it wakes the body and forgets its limits."""

    def __init__(self, *, doc: str) -> None:
        super().__init__("dBodyGetAutoDisableFlag", "dBodySetAutoDisableFlag", FLAG, doc=doc)
        self.put = self._put_alone

    def _put_alone(self, body: Any, value: bool) -> None:
        if value == bool(lib.dBodyGetAutoDisableFlag(body._id)):
            return
        enabled = lib.dBodyIsEnabled(body._id)
        lib.dBodySetAutoDisableFlag(body._id, value)
        for name in ("auto_disable_steps", "auto_disable_time", "auto_disable_samples"):
            body.FIELDS[name].enter(body)
        if not enabled:
            lib.dBodyDisable(body._id)
