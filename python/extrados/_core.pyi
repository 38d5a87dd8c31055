"""The compiled core as the type checker sees it: facades that f2py wraps (fortran/api), called by extrados.core alone."""

from typing import Any

api_arch: Any
api_mechanism: Any
api_dem: Any
api_dem3: Any
api_dem_run: Any
api_limit: Any
api_motion: Any
api_rocking: Any
api_soft_base: Any
api_stack: Any
api_signal: Any
api_frame: Any
api_sla: Any
api_sla_laws: Any
api_shell: Any
api_sla_joints: Any
api_sla_model: Any
api_support: Any
