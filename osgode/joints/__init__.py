"""Joints: what holds two bodies, or a body and the static world, together."""
