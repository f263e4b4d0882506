"""What the stages of a run have left in its folder: stones, meshes, states and records, by the names of the plan."""

import importlib.metadata
import platform
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from churchpipe import compare
from churchpipe.config.carries import carries_of, placed
from churchpipe.config.settings import load_of, site_of
from churchpipe.config.soil_questions import end_questions
from churchpipe.halved_steps import careful_check
from churchpipe.io.atomic import read_json
from churchpipe.io.movement_record import Shift, Turn
from churchpipe.io.npz import Absent, read_if_made, read_npz
from churchpipe.io.recording import halved_record
from churchpipe.io.records import Analysis, read_record
from churchpipe.io.sample_study import Sample
from churchpipe.io.summary import Mesh
from churchpipe.match import Match
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.block_curve import BlockCapacityCurve
from churchpipe.model.contacts import Contacts
from churchpipe.model.placed_loads import Applied
from churchpipe.model.results import CapacityCurve, LimitState, ShellLimitState
from churchpipe.model.settlement import SettlementPath
from churchpipe.model.shell import ShellModel
from churchpipe.stones.footing import whole_ground_question


@dataclass(frozen=True, slots=True)
class RunFolder:
    """The folder of a run, and the content of its plan.json. An `entry` is one of the plan's analyses."""

    path: Path
    index: dict[str, Any]

    def folder(self, entry: dict[str, Any]) -> Path:
        """Return where the settings and results of an analysis lie."""
        return self.path / entry["kind"] / entry["name"]

    def stones(self, geometry: str) -> tuple[Assemblage, Contacts]:
        """Return the stones of a geometry and their joints."""
        folder = self.path / "geometry" / geometry
        return read_npz(folder / "assemblage.npz", Assemblage), read_npz(folder / "contacts.npz", Contacts)

    def shell(self, name: str) -> ShellModel | Absent:
        """Return a mesh, or why there is none."""
        return read_if_made(self._mesh(name), ShellModel)

    def has_shell(self, name: str) -> bool:
        """Return whether a mesh, or why there is none, has been written."""
        return self._mesh(name).exists()

    def _mesh(self, name: str) -> Path:
        return self.path / "shell" / name / "shell.npz"

    def block_state(self, entry: dict[str, Any]) -> LimitState:
        """Return the state of a limit analysis of the stones."""
        return read_npz(self.folder(entry) / "rigid.npz", LimitState)

    def block_curve(self, entry: dict[str, Any]) -> BlockCapacityCurve:
        """Return a capacity curve of the stones."""
        return read_npz(self.folder(entry) / "curve.npz", BlockCapacityCurve)

    def halved_curve(self, entry: dict[str, Any]) -> BlockCapacityCurve | None:
        """Return that curve with steps half as long, None where the case does not ask for it."""
        return read_npz(self.folder(entry) / "halved.npz", BlockCapacityCurve) if entry.get("halved") else None

    def applied(self, entry: dict[str, Any], stones: Assemblage) -> Applied:
        """Return what the stones carry, and their ties, in an analysis of them."""
        return placed(carries_of(read_json(self.folder(entry) / "settings.json")), stones)

    def shell_state(self, entry: dict[str, Any]) -> ShellLimitState | CapacityCurve | Absent:
        """Return the state of an analysis of the shell; of a capacity curve, its last step's."""
        if entry["kind"] == "limit":
            return read_if_made(self.folder(entry) / "limit.npz", ShellLimitState)
        return read_if_made(self.folder(entry) / "pushover.npz", CapacityCurve)

    def meshes(self) -> dict[str, Mesh]:
        """Return the size and the gate of each mesh; of a drawing, also the stones that no panel fits, and how far
        stones were moved for it."""
        return {mesh["name"]: self._mesh_size(mesh["name"], mesh["geometry"]) for mesh in self.index["shells"]}

    def _mesh_size(self, name: str, geometry: str) -> Mesh:
        gate = read_record(self.path / "shell" / name / "match.json", Match)
        if self.index["drawing"]:
            fit = read_json(self.path / "geometry" / geometry / "fit.json")
            gate = replace(gate, unfit=tuple(fit["unfit"]), message=fit["message"] or gate.message, moved=fit["moved"])
        size = read_json(self.path / "shell" / name / "settings.json")["element_size"]
        mesh = self.shell(name)
        return compare.mesh_size(None if isinstance(mesh, Absent) else mesh, gate, geometry, size)

    def record(self, entry: dict[str, Any], meshes: dict[str, Mesh]) -> Analysis:
        """Return the record of an analysis, with its name, its variant, what was swept, its geometry where there are several, its
        mesh and what is known of its mechanism. meshes: all of them, by name."""
        mesh = meshes.get(entry.get("shell", ""))
        return replace(
            found := read_record(self.folder(entry) / f"{entry['kind']}.json", Analysis),
            **self._place(entry),
            element_size=mesh.element_size if mesh else None,
            elements=mesh.elements if mesh else None,
            **self._mechanism(entry, found.status),
        )

    def _mechanism(self, entry: dict[str, Any], status: str) -> dict[str, Any]:
        """Return the macro-elements that move and, of the rigid blocks, the safety check."""
        # A capacity curve of the stones is checked as far as its steps are proved.
        known = ("optimal", "converged", *(["not-converged"] if entry["kind"] == "curve" else []))
        # What does not stand, or has no result, has a check that says so, where one is asked for.
        unknown = status not in known
        if entry["kind"] == "pushover" or (
            unknown and (entry["kind"] != "rigid" or "check" not in entry or status == "unbounded")
        ):
            return {}
        settings = read_json(self.folder(entry) / "settings.json")
        load = load_of(settings)
        site = site_of(entry["check"]) if "check" in entry else None
        crushing = all("compressive_strength" in values for values in settings["material"].values())
        if entry["kind"] == "curve":
            curve, stones = self.block_curve(entry), self.stones(entry["geometry"])[0]
            applied = self.applied(entry, stones)
            halved = self.halved_curve(entry)
            check = careful_check(curve, halved, stones, load, site, applied, crushing=crushing)
            return {"check": check, "halved": halved_record(curve, halved) if halved else None}
        if entry["kind"] == "limit":
            mesh = read_npz(self._mesh(entry["shell"]), ShellModel)
            return compare.shell_parts(mesh, read_npz(self.folder(entry) / "limit.npz", ShellLimitState), load)
        stones, state = self.stones(entry["geometry"])[0], self.block_state(entry)
        masses = self.applied(entry, stones).loads
        check = compare.safety(stones, state, load, site, masses, crushing=crushing)
        return {"check": check} if unknown else compare.stone_parts(stones, state, load) | {"check": check}

    def movements(self, geometry: str | None = None) -> list[Shift | Turn]:
        """Return the records of the supports that move, of all geometries or of one, as `record` does for the analyses."""
        return [
            replace(read_record(self.path / "movement" / entry["name"] / "movement.json", Shift, Turn), **self._place(entry))
            for entry in self.index["movements"]
            if geometry in (None, entry["geometry"])
        ]

    def _place(self, entry: dict[str, Any]) -> dict[str, Any]:
        """Return the place of a record in the plan: name, variant, what was swept, its geometry where there are several."""
        geometry = entry["geometry"] if len(self.index["geometries"]) > 1 else None
        return {"name": entry["name"], "variant": entry["variant"], "swept": entry["swept"], "geometry": geometry}

    def moved(self, name: str) -> tuple[Assemblage, Contacts, SettlementPath]:
        """Return the stones of a movement, their ground cut, their joints and the path."""
        folder = self.path / "movement" / name
        stones = read_npz(folder / "assemblage.npz", Assemblage)
        return stones, read_npz(folder / "contacts.npz", Contacts), read_npz(folder / "movement.npz", SettlementPath)

    def ground_questions(self) -> list[str]:
        """Return what to ask about movements of all the ground that a building stands on."""
        asked: list[str] = []
        for entry in self.index["movements"]:
            table = read_json(self.path / "movement" / entry["name"] / "settings.json")
            if table["about"] is None:
                place = table["support"] or table["within"]
                asked.append(whole_ground_question(*self.stones(entry["geometry"]), table["name"], place))
        return [text for text in asked if text]

    def end_questions(self) -> list[str]:
        """Return what to ask about walls that stand in soil or water which presses on another wall."""
        asked: list[str] = []
        for geometry in self.index["geometries"]:
            entries = [entry for entry in self.index["analyses"] if entry["geometry"] == geometry and entry["kind"] == "rigid"]
            tables = [read_json(self.folder(entry) / "settings.json") for entry in entries]
            soil = {str(table): carries_of({"pressures": table}) for one in tables if (table := one.get("pressures"))}
            asked += [text for carries in soil.values() for text in end_questions(carries, self.stones(geometry)[0])]
        return list(dict.fromkeys(asked))

    def samples(self) -> dict[str, Sample]:
        """Return what the samples of a case have left, by name."""
        names = self.index["sample"]["names"] if self.index["sample"] else ()
        return {name: read_record(self.path / "sample" / name / "records.json", Sample) for name in names}

    def overlap(self, blocks: str, shell: str) -> float | None:
        """Return how far the mechanisms of two analyses, by name, are the same; None where the shell has none."""
        entries = {entry["name"]: entry for entry in self.index["analyses"]}
        state = self.shell_state(entries[shell])
        if isinstance(state, Absent):
            return None
        mesh = read_npz(self._mesh(entries[shell]["shell"]), ShellModel)
        # The stones by the names of the shell's panels.
        file = "fitted.npz" if self.index["drawing"] else "assemblage.npz"
        stones = read_npz(self.path / "geometry" / entries[shell]["geometry"] / file, Assemblage)
        motion = state.velocities if isinstance(state, ShellLimitState) else state.displacement
        return compare.overlap(stones, self.block_state(entries[blocks]).velocities, mesh, motion)


def read_run(plan: Path) -> RunFolder:
    """Return the run of a plan.json."""
    return RunFolder(plan.parent, read_json(plan))


def versions() -> dict[str, str]:
    """Return the versions that a result depends on."""
    packages = ("churchpipe", "numpy", "scipy", "shapely", "clarabel", "ezdxf", "manifold3d", "gmsh")
    return {"python": platform.python_version()} | {name: importlib.metadata.version(name) for name in packages}
