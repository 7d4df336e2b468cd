r"""Reference geometry: meshes, points and curves of other programs, compared with a model.

>>> import tempfile, pathlib, moldloft
>>> from moldloft import overlays
>>> m = moldloft.loads('''
... Line a({0, 0, 0}, {2, 0, 0}); Line b({0, 1, 0}, {2, 1, 0}); RuledSurf plate(a, b);
... ''')
>>> path = pathlib.Path(tempfile.mkdtemp()) / "probe.xyz"
>>> _ = path.write_text("0.5 0.5 0.25\n1.5 0.5 -0.5\n")
>>> probe = overlays.read(path)
>>> d = probe.deviation(m)
>>> d.distances.tolist(), d.largest
([0.25, -0.5], 0.5)
"""

from moldloft.overlays.deviation import Deviation, deviation
from moldloft.overlays.fit import Fit, fit
from moldloft.overlays.overlay import Overlay
from moldloft.overlays.reading import ENDINGS, read

__all__ = ["ENDINGS", "Deviation", "Fit", "Overlay", "deviation", "fit", "read"]
