"""Nodes that stand for something of ODE: World, spaces, Body, Placeable, geoms."""
