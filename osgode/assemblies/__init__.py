"""Builders of what is often needed: wheels, chains, ragdolls. Compositions of nodes and joints, nothing more."""
