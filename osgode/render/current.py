"""Puts back the OpenGL context that was current: moderngl leaves none behind where windows use EGL."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from ctypes.util import find_library
from functools import cache

DRAW, READ = 0x3059, 0x305A

EGL_DRIVERS = ("wayland", "offscreen", "KMSDRM")
"""Video drivers of SDL whose windows have EGL contexts, which moderngl can't make current itself."""


@cache
def _egl() -> ctypes.CDLL | None:
    name = find_library("EGL")
    if name is None:
        return None
    library = ctypes.CDLL(name)
    for function in (library.eglGetCurrentDisplay, library.eglGetCurrentContext, library.eglGetCurrentSurface):
        function.restype = ctypes.c_void_p
    library.eglMakeCurrent.argtypes = [ctypes.c_void_p] * 4
    return library


@contextmanager
def kept_current() -> Iterator[None]:
    """Whatever is made current in the block, afterwards that EGL context is current which was before, if any."""
    egl = _egl()
    if egl is None:
        yield
        return
    display, context = egl.eglGetCurrentDisplay(), egl.eglGetCurrentContext()
    draw, read = egl.eglGetCurrentSurface(DRAW), egl.eglGetCurrentSurface(READ)
    try:
        yield
    finally:
        if context:
            egl.eglMakeCurrent(display, draw, read, context)
