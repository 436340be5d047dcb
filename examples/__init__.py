"""Small programs that each show one idea, the demo game, and what they are drawn with."""
