"""lostbits shows where ray intersectors lose significand bits, which operation loses them, and what a safer form costs.

    import lostbits as lb

    @lb.intersector("sphere")
    def mine(o, d, centre, radius): ...          # whole batches of numpy arrays -> t, nan for a miss

    m = lb.map("rtg-fig-7-3-4100-oblique", [mine, "sphere.unified"])
    m.pixels["mine", "f32"].lost_bits            # an array of shape (height, width)
    lb.explain(mine, "rtg-fig-7-3-4100-oblique", pixel=(100, 90))

Start with help(lb.map), help(lb.intersector) or docs/python.md.
"""

from ._arrays import SHAPES
from ._forms import Function, Intersector, intersector
from ._forms import Function as function
from ._library import EnvironmentFault, Error, InputError, NothingSelected, library
from ._measure import (OpenMesh, Suspicious, ask, assert_keeps, check, choose, consistency, explain, hits, inside, judge,
                       judge_mesh, map, mend, offsets, render, study, sweep, trade, truth)
from ._results import (Checked, Choice, Explanation, Hits, Inside, Judgement, Map, Mended, MeshJudgement, Study, Sweep,
                       Trade, Truths)
from ._scene import Scene, scene
from ._tables import Table
from ._trace import Unfollowed

__version__: str = library.lostbits_version().decode()
__all__ = ["Checked", "Choice", "EnvironmentFault", "Error", "Explanation", "Function", "Hits", "InputError", "Inside",
           "Intersector", "Judgement", "Map", "Mended", "MeshJudgement", "NothingSelected", "OpenMesh", "SHAPES", "Scene",
           "Study", "Suspicious", "Sweep", "Table", "Trade", "Truths", "Unfollowed", "ask", "assert_keeps", "check",
           "choose", "consistency", "explain", "function", "hits", "inside", "intersector", "judge", "judge_mesh", "map",
           "mend", "offsets", "render", "scene", "study", "sweep", "trade", "truth"]
