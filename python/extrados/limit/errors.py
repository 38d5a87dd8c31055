"""What limit analysis cannot answer, apart from its solvers: they take a while to load."""


class NoEquilibrium(ValueError):
    """No admissible thrust line exists for the loads asked for."""


class Immovable(NoEquilibrium):
    """No load of the kind asked for brings the structure down: its joints hold it from all sides."""


class NoAnswer(RuntimeError):
    """The solver gave up; never a statement about the structure."""
