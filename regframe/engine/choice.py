"""Whether a richer map was kept, and why."""

from dataclasses import dataclass

FEWEST = 8
"""Tiles that must have been judged; with fewer, nothing is proved and the simpler map stays."""


@dataclass(frozen=True, slots=True)
class Choice:
    """Whether a stage's map was kept over the simpler one it began from, and why.

    Parameters
    ----------
    stage : int
        Counted from 0.
    kept : bool
        Whether the richer map stayed.
    gain : float
        How much lower the metric is with the richer map, in the mean of tiles that its fit did not see.
    error : float
        Standard error of that mean.
    better, tiles : int
        Tiles in which the richer map is better, and all that were judged.
    """

    stage: int
    kept: bool
    gain: float
    error: float
    better: int
    tiles: int

    @property
    def reason(self) -> str:
        """Why, in a line."""
        if self.tiles < FEWEST:
            return f"only {self.tiles} tiles of the image can be judged, fewer than {FEWEST}"
        seen = f"better in {self.better} of {self.tiles} tiles"
        return f"held-out gain {self.gain:.3g} +- {self.error:.2g}, {seen}"
