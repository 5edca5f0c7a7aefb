"""Rigid-body dynamics of robots and scenes: equations of motion, their derivatives, and motions with an estimate of their error.

``hamel.load`` reads a robot in URDF or a scene in TOML, ``hamel.Joint`` a joint type of one's own. Methods of ``Robot`` take arrays of numpy whose last dimension holds one state and whose other
dimensions are a batch. Units are SI, angles radians; twists have the angular velocity first.
"""

from ._errors import ArgumentError, CompilationError, DynamicsError, Error, FileError, IntegrationError, Mistake
from ._hamel import Joint, Robot, load, set_threads
from ._motion import Motion, simulate
from ._sweep import sweep
from ._values import BaseParameters, Claim, ForwardDerivatives, InverseDerivatives, JointInfo, Limits, Parameter, Regressor, Sizes, State

__version__ = "0.1.0"

__all__ = [
    "ArgumentError",
    "BaseParameters",
    "Claim",
    "CompilationError",
    "DynamicsError",
    "Error",
    "FileError",
    "ForwardDerivatives",
    "IntegrationError",
    "InverseDerivatives",
    "Joint",
    "JointInfo",
    "Limits",
    "Mistake",
    "Motion",
    "Parameter",
    "Regressor",
    "Robot",
    "Sizes",
    "State",
    "load",
    "set_threads",
    "simulate",
    "sweep",
]

# Messages and pickles call them by the names that users have for them.
for _own in (globals()[name] for name in __all__):
    if isinstance(_own, type) and _own.__module__ != "hamel":
        _own.__module__ = "hamel"
del _own
