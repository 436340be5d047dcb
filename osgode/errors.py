"""The errors that osgode raises, all below one base class."""

from __future__ import annotations


def shown(value: object) -> str:
    """A value as messages show it, cut short; never raises."""
    try:
        text = repr(value)
    except Exception:  # noqa: BLE001 - Python shows no int of more than 4300 digits, and users write __repr__
        text = f"{type(value).__name__} that can't be shown"
    return text if len(text) < 120 else text[:117] + "..."


class OsgodeError(Exception):
    """Base of every error that osgode raises on purpose."""


class TreeError(OsgodeError):
    """A node can't stand where it was asked to stand; nothing was changed."""


class FieldError(OsgodeError, ValueError):
    """A value is not one that its attribute may have; nothing was changed."""


class ParameterError(FieldError, AttributeError):
    """A joint was asked for a parameter, anchor or axis that its kind hasn't got."""


class StateError(OsgodeError, RuntimeError):
    """The call is right but not now: a node is out of its World, or the World is inside a step."""


class PhysicsError(OsgodeError, RuntimeError):
    """The simulation reached a state that ODE can't go on from; the message names the node."""


class ModelError(OsgodeError, ValueError):
    """A model file can't be read, or its geometry can't be used."""


class MissingExtraError(OsgodeError, ImportError):
    """A feature needs a package of one of osgode's extras; the message says which."""
