"""``python -m osgode.examples.game``: in a window, or, where there is no screen, as a film that tours everything."""

from __future__ import annotations

from osgode.examples.game.play import main

if __name__ == "__main__":
    main()
