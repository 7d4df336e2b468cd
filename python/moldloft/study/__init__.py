"""Studies of models: functions with exact derivatives, sweeps and optimisations with a store.

>>> import moldloft
>>> from moldloft.study import function
>>> m = moldloft.loads('''
... param float beam = 2 in [1, 3]; param float depth = 1 in [0, 2];
... AbsPoint A(0, beam, depth);
... ''')
>>> f = function(m, ["beam", "depth"], {"size": "sqrt(A.y * A.y + A.z * A.z)", "area": "A.y * A.z"})
>>> f([2.0, 1.0])
array([2.23606798, 2.        ])
>>> f.jacobian([2.0, 1.0])
array([[0.89442719, 0.4472136 ],
       [1.        , 2.        ]])
"""

from moldloft.study.autodiff import jax_function, torch_function
from moldloft.study.definition import (
    Analysis,
    Bound,
    Goal,
    Input,
    Objective,
    Pattern,
    Plan,
    Study,
    StudyError,
    read,
)
from moldloft.study.functions import Function, function
from moldloft.study.openmdao import component
from moldloft.study.optimizing import Optimum, optimize
from moldloft.study.robustness import (
    Validity,
    sobol_indices,
    spreads,
    validity,
    worst_cases,
)
from moldloft.study.running import sweep
from moldloft.study.store import Outcome, Results, Store

__all__ = [
    "Analysis",
    "Bound",
    "Function",
    "Goal",
    "Input",
    "Objective",
    "Optimum",
    "Outcome",
    "Pattern",
    "Plan",
    "Results",
    "Store",
    "Study",
    "StudyError",
    "Validity",
    "component",
    "function",
    "jax_function",
    "optimize",
    "read",
    "sobol_indices",
    "spreads",
    "sweep",
    "torch_function",
    "validity",
    "worst_cases",
]
