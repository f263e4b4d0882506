"""The table of load factors: one row an analysis, values as words and figures."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from churchpipe.io.records import Analysis, Strength
from churchpipe.model.results import CapacityCurve, LimitState, ShellLimitState
from churchpipe.model.swept import friction_of_material, heading, setting


@dataclass(frozen=True, slots=True)
class Row:
    """An analysis: its record in the summary, and its state when this report draws it: `state` of the rigid blocks; of the shell
    `shell`, the name of its mesh and the state."""

    record: Analysis
    state: LimitState | None = None
    shell: tuple[str, ShellLimitState | CapacityCurve] | None = None

    @property
    def status(self) -> str:
        return self.record.status

    @property
    def kind(self) -> str:
        """Flow rule or method, and the strength where it is not the exact one."""
        return self.record.kind

    @property
    def of_shell(self) -> bool:
        """Whether the analysis is one of the shell."""
        return self.record.of_shell

    @property
    def load(self) -> str:
        return minus(self.record.load)

    @property
    def variant(self) -> str:
        """Name of its variant of the building; "" as the building is."""
        return self.record.variant or ""

    @property
    def label(self) -> str:
        """Name of the analysis for a chooser or a heading."""
        words = [*([self.variant] if self.variant else []), *(["shell"] if self.of_shell else []), self.kind]
        words += [f"load {self.load}", f"friction {friction_text(self)}"]
        return ", ".join(words + [setting(key, value) for key, value in swept(self).items()])

    @property
    def mesh_size(self) -> str:
        """Size of the elements of its mesh in words; "" of the rigid blocks."""
        return f"{1e3 * self.record.element_size:g} mm" if self.record.element_size else ""

    def value(self, key: str) -> float | None:
        """Return a number of the record, else of the state (JSON has no infinity); None when neither has one."""
        value = getattr(self.record, key)
        if (value is None or math.isnan(value)) and self.state is not None:
            value = getattr(self.state, key, None)
        return None if value is None or math.isnan(value) else value

    @property
    def relative_gap(self) -> float | None:
        """Gap g over load factor."""
        gap, factor = self.value("gap"), self.value("load_factor")
        return None if gap is None or not factor or math.isinf(factor) else gap / abs(factor)


@dataclass(frozen=True, slots=True)
class Column:
    """A column: heading, explanation, and the text of a row's cell ("" when such a row has none)."""

    title: str
    meaning: str
    text: Callable[[Row], str]
    numeric: bool = True


OF_PUSH = "load factor: lateral load over weight of the loaded part at collapse"


def rows_of(
    analyses: Sequence[Analysis],
    results: Sequence[tuple[Analysis, LimitState]],
    shells: Sequence[tuple[Analysis, str, ShellLimitState | CapacityCurve]] = (),
) -> list[Row]:
    """Return the analyses of a run, each with its state."""
    states = {record.name: Row(record, state) for record, state in results}
    states |= {record.name: Row(record, None, (mesh, state)) for record, mesh, state in shells}
    return [states.get(record.name, Row(record)) for record in analyses]


def columns_for(rows: Sequence[Row]) -> list[Column]:
    """Return the columns that at least one row has something to say in; the model only where there are two."""
    keys = list(dict.fromkeys(key for row in rows for key in swept(row)))
    settings = [Column(heading(key), key, lambda row, key=key: swept(row).get(key, "")) for key in keys]
    columns = [column for column in COLUMNS if any(column.text(row) not in ("", "none") for row in rows)]
    if len({_model(row) for row in rows}) < 2:
        columns = [column for column in columns if column.text is not _model]
    return settings + columns


def figure(value: object, digits: int = 6) -> str:
    """Return a load factor as text: `digits` decimals; NaN and None are "none", infinity is "no limit"."""
    if not isinstance(value, int | float) or math.isnan(value):
        return "none"
    if math.isinf(value):
        return "no limit"
    return minus(f"{value:z.{digits}f}")


def amount(value: object, digits: int) -> str:
    """Return a quantity as text with so many decimals, or three figures where it is too small for them: the weight of a model."""
    if not isinstance(value, int | float) or not math.isfinite(value):
        return figure(value, digits)
    return minus(f"{value:,.{digits}f}" if abs(value) >= 10.0 ** (1 - digits) or value == 0 else f"{value:.3g}")


def small(value: object) -> str:
    """Return an error or residual as text, such as "3.1e\u221210"; NaN and None are "none"."""
    if not isinstance(value, int | float) or math.isnan(value):
        return "none"
    if math.isinf(value):
        return "infinite"
    return "0" if value == 0 else minus(f"{value:.1e}")


def minus(text: str) -> str:
    """Return text with typographic minus signs before figures and axes; other hyphens stay."""
    is_number = any(c.isdigit() for c in text) and not any(c.isalpha() and c != "e" for c in text)
    is_axis = len(text) == 2 and text[1] in "xyz"
    return text.replace("-", "\u2212") if is_number or is_axis else text


def change(share: float) -> str:
    """Return a change as text, in per cent with its sign: "+14.3 %"; what rounds to nothing is "+0.0 %"."""
    return minus(f"{100 * share:+z.1f} %")


def swept(row: Row) -> dict[str, str]:
    """Return the swept settings of a row and their values; friction of the material has a column of its own."""
    alone = not isinstance(row.record.friction, dict)
    return {key: str(value) for key, value in row.record.swept.items() if not (alone and friction_of_material(key))}


def named_of(name: str, variant: str | None, settings: Mapping[str, object]) -> str:
    """Return a name with the variant of the building and the swept settings that it is of: "pier, tied, friction 0.5"."""
    return ", ".join([name, *([variant] if variant else []), *(setting(key, value) for key, value in settings.items())])


def friction_text(row: Row) -> str:
    """Return the friction coefficient, or one a material, and the names of joints with a strength of their own."""
    own = ", ".join(group.name for group in row.record.joints)
    return by_material(row.record.friction) + (f"; joints of their own: {own}" if own else "")


def by_material(value: Strength, unit: float = 1.0) -> str:
    """Return a strength as text in a unit (of so much in SI), or one a material."""
    if isinstance(value, dict):
        return ", ".join(f"{name} {number / unit:g}" for name, number in value.items())
    return f"{value / unit:g}"


def _model(row: Row) -> str:
    return row.record.model_words


def _cohesion(row: Row) -> str:
    if row.record.cohesion and row.record.method == "curve" and not row.of_shell:
        return "left out"
    return by_material(row.record.cohesion, 1e3) if row.record.cohesion else ""


def _crushing(row: Row) -> str:
    strength = row.record.compressive_strength
    return by_material(strength, 1e6) if row.record.crushes and strength else ""


def _elements(row: Row) -> str:
    return f"{row.record.elements:,}" if row.record.elements else ""


def _seconds(row: Row) -> str:
    value = row.value("seconds")
    return "" if value is None else f"{value:.1f}"


_UPPER = (
    'associative: an upper estimate where joints slide; flow = ["associative", "non-associative"] under [rigid] adds the '
    "value to use"
)


def factor_words(analyses: Sequence[Analysis], of_push: str) -> list[str]:
    """Return what the load factors of these analyses are; of_push: those of loads that push weight."""
    multiplied = dict.fromkeys(name for one in analyses for name in one.multiplies)
    words = [of_push] if any(not one.multiplies for one in analyses) else []
    words += [f"load factor of {name}: how many times it is carried, 1 as it is given" for name in multiplied]
    flows = {one.flow for one in analyses}
    return words + ([_UPPER] if "associative" in flows and "non-associative" not in flows else [])


def interval_text(analysis: Analysis) -> str:
    """Return the interval of a load factor without dilatancy, "" where there is none."""
    low, high = analysis.interval or (math.nan, math.nan)
    return f"{figure(low, 4)} to {figure(high, 4)}" if math.isfinite(high - low) else ""


def _iterations(row: Row) -> str:
    value = row.value("iterations")
    return "" if value is None else f"{value:.0f}"


COLUMNS = (
    Column("Variant", "of the building; none: as it is", lambda row: row.variant, numeric=False),
    Column("Model", "", _model, numeric=False),
    Column("Analysis", "flow rule of the joints, or method", lambda row: row.kind, numeric=False),
    Column("Load", "direction or name of the load", lambda row: row.load, numeric=False),
    Column("Friction", "friction coefficient of the joints", friction_text),
    Column("Elements", "facets of the shell's mesh", _elements),
    Column("Cohesion, kPa", "cohesion of the joints", _cohesion),
    Column("Strength, MPa", "compressive strength of the joints, where the stones of the analysis crush", _crushing),
    Column(
        "Load factor",
        "of a push, over the weight of the loaded part; of loads that grow, how many times they are carried",
        lambda row: figure(row.value("load_factor")),
    ),
    Column("Lower bound", "static: forces in equilibrium and within friction", lambda row: figure(row.value("lower_bound"), 7)),
    Column("Upper bound", "kinematic: work of the mechanism", lambda row: figure(row.value("upper_bound"), 7)),
    Column(
        "Interval",
        "without dilatancy: load factors that fit the same mechanism; quote it with the load factor",
        lambda row: interval_text(row.record),
    ),
    Column("Status", "", lambda row: row.status, numeric=False),
    Column("Equilibrium", "largest residual over total weight", lambda row: small(row.value("equilibrium_residual"))),
    Column(
        "Strength",
        "worst force outside its friction cone over total weight; of the shell, stress outside its strength over the unit of it",
        lambda row: small(row.value("yield_violation" if row.of_shell else "cone_violation")),
    ),
    Column(
        "Friction violation", "shear beyond friction over frictional strength", lambda row: small(row.value("friction_violation"))
    ),
    Column("Gap g / α", "de Saxc\u00e9 gap over load factor; 0 is an exact state", lambda row: small(row.relative_gap)),
    Column("Iterations", "", _iterations),
    Column("Seconds", "", _seconds),
)
