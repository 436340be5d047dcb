"""Only what pyproject.toml can't say: the C core is compiled by cffi."""

from setuptools import setup

setup(cffi_modules=["build_ode.py:ffi"])
