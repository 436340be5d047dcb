"""Springs and dampers as ODE computes them."""

from __future__ import annotations

from osgode.fields import SMALLEST


def implicit(stiffness: float, damping: float, step_size: float) -> tuple[float, float]:
    """ERP and CFM that make ODE's constraint one implicit step of a spring and a damper.

    ``ERP = h k / (h k + d)`` and ``CFM = 1 / (h k + d)`` (the ODE manual, "How to use ERP and CFM").
    """
    hardness = max(step_size * stiffness + damping, SMALLEST)  # of less ODE would make an infinite softness
    return step_size * stiffness / hardness, max(1.0 / hardness, SMALLEST)
