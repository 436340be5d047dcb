"""The scene graph without any renderer and without any physics."""
