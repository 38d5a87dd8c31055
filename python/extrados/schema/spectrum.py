"""The elastic spectrum of a code as a deck table: the target of motions, and the demand of code checks."""

from typing import Literal

from pydantic import model_validator

from extrados.schema.quantities import Acceleration, Time
from extrados.schema.table import Table, key


class CodeSpectrum(Table):
    """The elastic spectrum of a code, with its own values, or a table."""

    code: Literal["EN1998-1", "EN1998-2", "NTC", "ASCE7", "NZS1170", "table"] = key(
        about="spectrum of EN 1998-1:2004 (type 1 or 2), NTC 2018, ASCE 7-16 or NZS 1170.5, or a user-defined table"
    )
    ground: Literal["A", "B", "C", "D", "E"] = key("A", "ground type (EN 1998-1, NTC) or site subsoil class (NZS 1170.5)")
    acceleration: Acceleration | None = key(None, "a_g on ground A (EN 1998-1, NTC)", gt=0)
    amplification: float = key(2.5, "amplification factor F_0 (NTC)", ge=1, le=10)
    corner_period: Time = key(0.35, "period T_C* (NTC)", gt=0, le=2)
    topography: float = key(1.0, "topographic amplification S_T (NTC)", ge=1, le=2)
    sds: Acceleration | None = key(None, "S_DS (ASCE 7)", gt=0)
    sd1: Acceleration | None = key(None, "S_D1 (ASCE 7)", gt=0)
    long_period: Time = key(8.0, "long period T_L (ASCE 7)", gt=0)
    hazard_factor: float | None = key(None, "hazard factor Z (NZS 1170.5)", gt=0, le=1)
    return_factor: float = key(1.0, "return period factor R (NZS 1170.5)", gt=0, le=2)
    table: str | None = key(None, "CSV file with the columns period_s,sa_g", min_length=1, max_length=1024)

    @model_validator(mode="after")
    def _has_values(self) -> "CodeSpectrum":
        need = {
            "EN1998-1": ("acceleration",),
            "EN1998-2": ("acceleration",),
            "NTC": ("acceleration",),
            "ASCE7": ("sds", "sd1"),
            "NZS1170": ("hazard_factor",),
            "table": ("table",),
        }[self.code]
        missing = [name for name in need if getattr(self, name) is None]
        if missing:
            raise ValueError(f"code {self.code} requires {' and '.join(missing)}")
        return self


class TargetSpectrum(CodeSpectrum):
    """The target of motions: the spectrum of a code, a table such as a uniform hazard spectrum, or the conditional mean of a table of
    medians and standard deviations."""

    conditional_period: Time | None = key(
        None,
        "conditional mean spectrum: period at which `conditional_sa` is given. The table of the spectrum then has the columns "
        "period_s,sa_g,sigma_ln: medians and standard deviations of the logarithm, from a ground-motion model",
        ge=0.01,
        le=10,
        source="Baker 2011; Baker and Jayaram 2008",
    )
    conditional_sa: Acceleration | None = key(None, "spectral acceleration of the hazard at the period `conditional_period`", gt=0)

    @model_validator(mode="after")
    def _conditional(self) -> "TargetSpectrum":
        if (self.conditional_period is None) != (self.conditional_sa is None):
            raise ValueError("conditional_period and conditional_sa go together")
        if self.conditional_period is not None and self.code != "table":
            raise ValueError('`conditional_period` requires code = "table" with the column sigma_ln')
        return self
