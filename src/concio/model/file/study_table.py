"""The table ``[study]`` of a model file: what differs from run to run, and what is asked of every run.

It says nothing of the structure: ``concio.load`` checks it and leaves it at that.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Field, StrictInt, StrictStr, ValidationError, field_validator, model_validator

from concio.model.file.file_errors import first_fault
from concio.model.file.tables import Name, Table
from concio.model.file.values import fault

Plain = StrictInt | float


class VariableTable(Table):
    """A variable; keys beside these are parameters of its distribution.

    Keys
    ----
    name :
        Name of the variable; columns of the results have it.
    distribution :
        Name of the distribution; see ``concio study``.
    keys :
        Keys of the file that take its value.
    unit :
        Unit of its values.
    values :
        Values of a discrete variable.
    weights :
        Probabilities of the values, up to a factor.
    levels :
        Number of values of a grid.
    low, high :
        Smallest and largest value.
    mean, sd, cov :
        Mean, standard deviation, coefficient of variation.
    median, mode :
        Median, most likely value.
    alpha, beta, shape, scale :
        Parameters of the distribution.
    """

    name: Name
    distribution: Name = "uniform"
    keys: StrictStr | list[StrictStr] = Field(default_factory=list)
    unit: StrictStr = ""
    values: list[Any] = Field(default_factory=list)
    weights: list[Plain] = Field(default_factory=list)
    levels: StrictInt = 5
    low: Plain | None = None
    high: Plain | None = None
    mean: Plain | None = None
    sd: Plain | None = None
    cov: Plain | None = None
    median: Plain | None = None
    mode: Plain | None = None
    alpha: Plain | None = None
    beta: Plain | None = None
    shape: Plain | None = None
    scale: Plain | None = None

    def arguments(self) -> dict[str, Any]:
        """Return the arguments of :func:`concio.variable` that the file states."""
        return {k: v for k, v in self.model_dump(exclude_unset=True).items() if v is not None}


class CorrelationTable(Table):
    """Rank correlation of two variables.

    Keys
    ----
    between :
        Names of the two variables.
    rank :
        Spearman's coefficient, from -1 to 1.
    """

    between: tuple[Name, Name]
    rank: float


class StopTable(Table):
    """When the study has seen enough; see :class:`concio.studies.study.Stop`.

    Keys
    ----
    output :
        Name of the output whose mean or share is watched.
    confidence :
        Confidence of its interval.
    """

    output: Name
    width: float
    below: float | None = None
    above: float | None = None
    confidence: float = 0.95
    least: StrictInt = 30


class StudyTable(Table):
    """The arguments of :func:`concio.study`.

    Keys
    ----
    method :
        Solver of each run.
    factors :
        Load factors of each run.
    live :
        Load groups that grow where a limit load is asked for.
    required :
        Multiplier of ``live`` that is required; its reliability index of first order is given beside the sample.
    """

    sample: Name = "latin-hypercube"
    size: StrictInt | None = None
    seed: StrictInt = 0
    outputs: list[StrictStr] = Field(default_factory=list)
    variables: list[VariableTable] = Field(default_factory=list)
    correlation: list[CorrelationTable] = Field(default_factory=list)
    stop: StopTable | None = None
    time_limit: float = float("inf")
    method: Name = "auto"
    factors: dict[str, float] = Field(default_factory=dict)
    live: list[Name] = Field(default_factory=lambda: ["live"])
    required: float | None = None

    @model_validator(mode="before")
    @classmethod
    def _one_or_many(cls, data: Any) -> Any:
        """Let a single output or load group stand without brackets."""
        if isinstance(data, dict):
            data = {k: [v] if k in ("outputs", "live") and isinstance(v, str) else v for k, v in data.items()}
        return data

    @field_validator("correlation", mode="after")
    @classmethod
    def _once(cls, value: list[CorrelationTable]) -> list[CorrelationTable]:
        """Refuse a pair that is stated twice: the last one would count."""
        pairs = [frozenset(c.between) for c in value]
        twice = next((c for c, pair in zip(value, pairs, strict=True) if pairs.count(pair) > 1), None)
        if twice is not None:
            msg = f"the correlation of '{twice.between[0]}' and '{twice.between[1]}' is stated twice"
            raise fault(msg, "state each pair once")
        return value

    @property
    def correlations(self) -> dict[tuple[str, str], float]:
        """Rank correlations by pairs of names."""
        return {c.between: c.rank for c in self.correlation}


Study = Annotated[StudyTable | None, Field(description="many runs of the model; see concio study")]


def study_table(data: Mapping[str, Any], where: str) -> StudyTable | None:
    """Return the table ``[study]`` of the tables of a file, checked; None where there is none.

    Raises
    ------
    InputError
        It holds a key that is not known, or a value that does not fit.
    """
    if "study" not in data:
        return None
    try:
        return StudyTable.model_validate(data["study"])
    except ValidationError as error:
        raise first_fault(error, data["study"], StudyTable, f"{where}, [study]") from None
