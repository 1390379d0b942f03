"""Files: results reload to the same object, VTK reads what is written, nothing is left half written."""

from __future__ import annotations

import csv
import errno
import json
import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

import concio
from concio.analysis.result import Result
from concio.contact.assembly import assemble
from concio.errors import ConcioError, InputError
from concio.fem.discretisation import FIXED, RIGID
from concio.io import load_result, save_result, write_paraview, write_result
from concio.io.codec import Decoder, Encoder
from concio.io.csv_table import write_csv
from concio.io.vtu import VERTEX, Grid, write_vtu
from concio.model.model import Load, Model, Tie
from concio.problem.certificate import certify
from concio.problem.solution import Status
from models import sliding_panel

pytestmark = pytest.mark.usefixtures("blank_figures")


def _panel(**changes: object) -> Model:
    options: dict = {
        "courses": 2, "blocks": 3, "joint": 0.02, "friction": 0.6, "base": "bearings", "top_pressure": 10.0
    }  # fmt: skip
    return concio.running_bond_panel(**{**options, **changes})


def _mixed() -> Model:
    """Two blocks on the ground, one of them rigid, a joint with every law, a tie and a moved support."""
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    law = concio.JointLaw(
        0.6, cohesion=5.0, tensile_strength=1.0, dilatancy=0.1, normal_stiffness=1e6, tangential_stiffness=5e5,
        compressive_strength=2e3,
    )  # fmt: skip
    return Model(
        bodies=(
            concio.Body("ground", square * [3, 1] - [1, 1], kind="fixed", role="obstacle"),
            concio.Body("lower", square, material="stone", thickness=0.3),
            concio.Body("upper", square + np.array([0, 1]), material="rock", kind="rigid", thickness=0.3),
        ),
        materials={"stone": concio.Elastic(1e6, 0.2, 20.0), "rock": concio.Rigid(22.0)},
        laws={"joint": law, "dry": concio.JointLaw(0.5)},
        rules=(concio.JointRule("dry"), concio.JointRule("joint", ("lower", "upper"))),
        loads=(Load("weight", (0.0, -1.0)), Load("point", (0.5, 0.0), ("upper",), at=(0.5, 2.0), group="push")),
        supports=(concio.Support("sinking", "ground", displacement=(0.0, -1e-4)),),
        ties=(Tie("bar", "upper", (1.0, 1.5), "", (3.0, 0.5), stiffness=50.0, prestress=0.2),),
        title="mixed",
    )


@pytest.fixture(scope="module")
def panel() -> Result:
    return concio.solve(_panel())


@pytest.fixture(scope="module")
def mixed() -> Result:
    return concio.solve(_mixed(), factors={"push": 0.5})


@pytest.fixture(scope="module")
def collapse() -> Result:
    return concio.solve(sliding_panel(), on_failure="return")


@pytest.mark.parametrize("name", ["panel", "mixed", "collapse"])
def test_result_reloads_to_the_same_object(name: str, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    result: Result = request.getfixturevalue(name)
    save_result(result, tmp_path)
    again = load_result(tmp_path)
    assert again.summary() == result.summary()
    assert again.status is result.status
    assert again.certificate == result.certificate
    assert again.factors == result.factors
    np.testing.assert_array_equal(again.displacement, result.displacement)
    np.testing.assert_array_equal(again.solution.normal_force, result.solution.normal_force)
    np.testing.assert_array_equal(again.contacts.state, result.contacts.state)
    np.testing.assert_array_equal(again.stress.mean, result.stress.mean)
    for a, b in zip(again.model.bodies, result.model.bodies, strict=True):
        np.testing.assert_array_equal(a.outline, b.outline)
        assert (a.name, a.material, a.kind, a.role, a.thickness) == (b.name, b.material, b.kind, b.role, b.thickness)
    assert again.model.materials == dict(result.model.materials)
    assert again.model.laws == dict(result.model.laws)
    assert again.model.loads == result.model.loads
    assert again.model.supports == result.model.supports
    assert again.model.ties == result.model.ties
    assert again.assembly.disc.model is again.assembly.model  # shared objects stay shared
    if result.mechanism is not None:
        np.testing.assert_array_equal(again.mechanism.velocity, result.mechanism.velocity)


def test_supports_of_blocks_are_kept(tmp_path: Path) -> None:
    top = concio.Support("top", "c2-b2", edge=((0.1, 0.2), (0.3, 0.2)))
    result = concio.solve(replace(_panel(joint=0.0), supports=(top,)))
    assert result.assembly.supported.held
    save_result(result, tmp_path)
    again = load_result(tmp_path)
    assert again.reactions == result.reactions
    assert "top" in again.reactions
    assert concio.solve(again.assembly).reactions["top"] == pytest.approx(result.reactions["top"], rel=1e-9)


def test_the_load_stages_of_the_model_are_kept(tmp_path: Path) -> None:
    point = concio.ControlPoint("c01-b01", (0.0, 0.1))
    stages = (concio.Stage("weight", {"dead": 1.0}), concio.Stage("push", {"live": 0.5}, point, 0.01, 7))
    result = concio.solve(replace(_panel(), stages=stages))
    save_result(result, tmp_path)
    assert load_result(tmp_path).model.stages == stages


def test_reloaded_result_certifies_and_solves_again(panel: Result, tmp_path: Path) -> None:
    save_result(panel, tmp_path)
    again = load_result(tmp_path)
    s = again.solution
    problem = again.assembly.problem(again.factors)
    assert certify(problem, s.displacement, s.normal_force, s.friction_force).worst <= 1e-9
    assert concio.solve(again.assembly).max_settlement == pytest.approx(panel.max_settlement, rel=1e-9)


def test_file_says_what_wrote_it(panel: Result, tmp_path: Path) -> None:
    save_result(panel, tmp_path)
    tree = json.loads((tmp_path / "result.json").read_text())
    assert tree["format_version"] == 1
    assert tree["concio"] == concio.__version__
    assert tree["engine"]["method"] == panel.method
    assert tree["certificate"]["worst"] == panel.certificate.worst
    with np.load(tmp_path / "result.npz", allow_pickle=False) as arrays:  # readable with numpy alone
        np.testing.assert_array_equal(arrays["solution.normal_force"], panel.solution.normal_force)
        np.testing.assert_array_equal(arrays["assembly.pairs.point"], panel.assembly.pairs.point)


def _spoil(directory: Path, change: str) -> None:
    text, arrays = directory / "result.json", directory / "result.npz"
    if change == "missing":
        arrays.unlink()
    elif change == "cut json":
        text.write_text(text.read_text()[:1000])
    elif change == "cut npz":
        arrays.write_bytes(arrays.read_bytes()[:2000])
    elif change == "foreign":
        text.write_text('{"format": "something else"}')
    elif change == "newer":
        text.write_text(text.read_text().replace('"format_version":1', '"format_version":2'))
    elif change == "unknown class":
        text.write_text(text.read_text().replace('"$type":"Certificate"', '"$type":"Diploma"'))
    elif change == "unknown entry":
        text.write_text(text.read_text().replace('"penetration"', '"intrusion"'))
    elif change == "lost array":
        with np.load(arrays) as file:
            kept = {k: file[k] for k in file.files if k != "solution.normal_force"}
        np.savez(arrays, **kept)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("missing", "no such file"), ("cut json", "not JSON"), ("cut npz", "damaged"), ("foreign", "not a result"),
        ("newer", "newer than 1"), ("unknown class", "Diploma"), ("unknown entry", "intrusion"),
        ("lost array", "solution.normal_force"),
    ],
)  # fmt: skip
def test_damaged_results_are_refused_with_words(panel: Result, tmp_path: Path, change: str, message: str) -> None:
    save_result(panel, tmp_path)
    _spoil(tmp_path, change)
    with pytest.raises(InputError, match=message):
        load_result(tmp_path)


def test_codec_keeps_what_json_has_no_word_for() -> None:
    value = {"a": math.inf, "b": (1, [2.5, None]), "c": np.array([math.nan, 1.0]), "d": np.int8(3), "e": "x", "f": True}
    encoder = Encoder({}, {})
    tree = json.loads(json.dumps(encoder.encode(value), allow_nan=False))
    again = Decoder({}, encoder.arrays, {}, "here").decode(tree)
    assert again["a"] == math.inf
    assert again["b"] == (1, [2.5, None])
    np.testing.assert_array_equal(again["c"], value["c"])
    assert (again["d"], again["e"], again["f"]) == (3, "x", True)


def test_codec_stores_no_strangers() -> None:
    @dataclass
    class Stranger:
        x: int = 1

    with pytest.raises(TypeError, match="no name"):
        Encoder({}, {}).encode(Stranger())
    with pytest.raises(TypeError, match="cannot store"):
        Encoder({}, {}).encode(object())


@pytest.mark.long
def test_result_directory_holds_everything(panel: Result, tmp_path: Path) -> None:
    target = tmp_path / "deep" / "out"
    written = write_result(panel, target)
    assert all(p.is_file() and target in p.parents for p in written)
    names = {p.relative_to(target).as_posix() for p in written}
    for name in ("summary.json", "model.toml", "result.json", "result.npz", "joints.csv", "figures/principal.png",
                 "figures/deformed.svg", "report.html"):  # fmt: skip
        assert name in names
    assert sorted(p for p in target.rglob("*") if p.is_file()) == sorted([*written, target / "concio.json"])
    assert json.loads((target / "summary.json").read_text()) == json.loads(json.dumps(panel.summary()))
    assert load_result(target).summary() == panel.summary()
    model = concio.load(target / "model.toml")
    assert [b.name for b in model.bodies] == [b.name for b in panel.model.bodies]
    assert assemble(model).disc.unknowns == panel.assembly.disc.unknowns


def test_collapse_leaves_a_directory_too(collapse: Result, tmp_path: Path) -> None:
    assert collapse.status is Status.NO_EQUILIBRIUM
    names = {p.relative_to(tmp_path / "out").as_posix() for p in write_result(collapse, tmp_path / "out")}
    assert "figures/mechanism.png" in names
    assert "figures/principal.png" not in names
    assert "reactions.csv" not in names


@pytest.mark.parametrize("error", [OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt()])
def test_nothing_is_half_written(
    panel: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: BaseException
) -> None:
    target = tmp_path / "out"
    write_result(panel, target, figures=False, report=False)
    before = {p.name: p.read_bytes() for p in target.iterdir()}

    def fail(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr("concio.plot.figures.write_figures", fail)
    expected = ConcioError if isinstance(error, OSError) else KeyboardInterrupt
    with pytest.raises(expected) as caught:
        write_result(panel, target, report=False)
    if expected is ConcioError:
        assert "No space left" in str(caught.value)
    assert {p.name: p.read_bytes() for p in target.iterdir()} == before
    assert [p.name for p in tmp_path.iterdir()] == ["out"]


def test_earlier_result_is_replaced_and_other_files_are_not(panel: Result, tmp_path: Path) -> None:
    target = tmp_path / "out"
    write_result(panel, target, figures=True, report=False)
    (target / "notes.txt").write_text("what I thought of it")
    write_result(panel, target, figures=False, report=False)
    assert not (target / "figures").exists()
    assert (target / "notes.txt").read_text() == "what I thought of it"
    other = tmp_path / "thesis"
    other.mkdir()
    (other / "chapter.txt").write_text("years of computing time")
    with pytest.raises(InputError, match="other things"):
        write_result(panel, other)
    assert (other / "chapter.txt").read_text() == "years of computing time"
    with pytest.raises(InputError, match="this is a file"):
        write_result(panel, other / "chapter.txt")


def test_csv_reads_back_to_the_last_bit(panel: Result, tmp_path: Path) -> None:
    table = panel.tables.contacts()
    path = write_csv(table, tmp_path / "contacts.csv")
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(panel.contacts)
    np.testing.assert_array_equal([float(r["normal_force [kN]"]) for r in rows], panel.contacts.normal_force)
    np.testing.assert_array_equal([float(r["gap [m]"]) for r in rows], panel.contacts.gap)
    assert {r["state"] for r in rows} == {"open", "stick", "slip"}


def test_tables_have_equal_columns_and_sum_up(mixed: Result) -> None:
    for table in mixed.tables.all().values():
        assert len({len(column) for column in table.values()}) == 1
    joints = mixed.tables.joints()
    assert set(joints["body_a"]) <= {"ground", "lower", "upper"}
    contacts = mixed.tables.contacts()
    tie = contacts["interface"] == -1
    assert tie.sum() == 1
    assert contacts["law"][tie][0] == "tie"
    assert contacts["body_b"][tie][0] == ""
    inside = contacts["interface"] == 1
    assert contacts["normal_force"][inside].sum() == pytest.approx(joints["normal_force"][1], rel=1e-12)
    bodies = mixed.tables.bodies()
    assert np.isnan(bodies["s_1"]).tolist() == [True, False, True]
    ground = bodies["body"] == "ground"
    assert bodies["u_y"][ground][0] == pytest.approx(-1e-4, rel=1e-12)


def _read(path: Path):
    pytest.importorskip("vtkmodules", reason="the vtk package is not installed")
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader = vtkXMLUnstructuredGridReader()
    assert reader.CanReadFile(str(path))
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()

    def arrays(data) -> dict[str, np.ndarray]:
        return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}

    return grid, vtk_to_numpy(grid.GetPoints().GetData()), arrays(grid.GetPointData()), arrays(grid.GetCellData())


@pytest.mark.long
@pytest.mark.parametrize("name", ["panel", "mixed"])
def test_vtk_reads_bodies(name: str, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    result: Result = request.getfixturevalue(name)
    series = write_paraview(result, tmp_path)
    assert [p.name for p in series[:2]] == ["bodies.pvd", "contacts.pvd"]
    grid, points, point_data, cell_data = _read(tmp_path / "bodies_0000.vtu")
    count = range(len(result.model.bodies))
    exact = {"rtol": 1e-12, "atol": 0.0}
    np.testing.assert_allclose(points[:, :2], np.vstack([result.nodes(b) for b in count]), **exact)
    moved = np.vstack([result.node_displacement(b) for b in count])
    np.testing.assert_allclose(point_data["displacement"][:, :2], moved, **exact)
    disc = result.assembly.disc
    first = 0
    for b in count:
        n = len(result.nodes(b))
        if disc.shape_of[b] >= 0:
            np.testing.assert_allclose(point_data["stress"][first : first + n], result.stress.at_nodes(b), **exact)
        else:
            assert np.isnan(point_data["stress"][first : first + n]).all()
        first += n
    s1, s2, _ = result.stress.principal
    np.testing.assert_allclose(cell_data["body_s_1"], s1[cell_data["body"]], **exact)
    np.testing.assert_allclose(cell_data["body_s_2"], s2[cell_data["body"]], **exact)
    expected = np.select([disc.shape_of == FIXED, disc.shape_of == RIGID], [2, 1], 0)
    np.testing.assert_array_equal(cell_data["kind"], expected[cell_data["body"]])
    areas = np.zeros(len(result.model.bodies))
    from vtkmodules.vtkFiltersVerdict import vtkMeshQuality

    quality = vtkMeshQuality()
    for i in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(i)
        if cell.GetCellType() == 9:
            areas[cell_data["body"][i]] += quality.QuadArea(cell)
    for b in np.flatnonzero(disc.shape_of >= 0):  # the elements fill the block: the cells are connected rightly
        assert areas[b] == pytest.approx(result.model.bodies[b].area, rel=1e-12)


def under_pressure(element: str) -> Result:
    """A rigid block on an elastic one on the ground, in space."""
    blocks = (
        concio.Polyhedron.box("ground", (-1, -1, -1), (3, 3, 0), kind="fixed"),
        concio.Polyhedron.box("low", (0, 0, 0), (1, 0.8, 0.5), mesh_size=0.5),
        concio.Polyhedron.box("high", (0, 0, 0.5), (1, 0.8, 1.2), kind="rigid", material="rock"),
    )
    materials = {"block": concio.Elastic(1e5, 0.2, 20.0), "rock": concio.Rigid(20.0)}
    loads = (concio.Load("weight", (0.1, 0.05, -1.0)),)
    laws = {"joint": concio.JointLaw(0.5)}
    return concio.solve(concio.Model(blocks, materials, laws, loads=loads, element=element))


@pytest.mark.parametrize("element", ["H8I", "H27", "T4", "T10"])
def test_vtk_reads_volumes(element: str, tmp_path: Path) -> None:
    """Cells are connected as VTK expects, so that they fill the block; stresses and principal values agree."""
    from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter

    result = under_pressure(element)
    write_paraview(result, tmp_path)
    grid, points, point_data, cells = _read(tmp_path / "bodies_0000.vtu")
    size = vtkCellSizeFilter()
    size.SetInputData(grid)
    size.Update()
    from vtkmodules.util.numpy_support import vtk_to_numpy

    volume = vtk_to_numpy(size.GetOutput().GetCellData().GetArray("Volume"))
    elastic = cells["kind"] == 0
    assert volume[elastic].sum() == pytest.approx(0.4, rel=1e-9)
    assert (volume[elastic] > 0).all()
    assert sorted(set(cells["body"])) == [0, 1, 2]
    first = len(result.model.polyhedra[0].vertices)
    here = slice(first, first + len(result.nodes(1)))
    np.testing.assert_allclose(points[here], result.nodes(1), atol=1e-12)
    np.testing.assert_allclose(point_data["displacement"][here], result.node_displacement(1), rtol=1e-12)
    np.testing.assert_allclose(point_data["stress"][here], result.stress.at_nodes(1), rtol=1e-12)
    assert np.isnan(point_data["stress"][:first]).all()
    s = cells["element_stress"][elastic]
    tensor = np.stack([s[:, [0, 3, 5]], s[:, [3, 1, 4]], s[:, [5, 4, 2]]], 1)
    values = np.column_stack([cells[f"s_{k}"][elastic] for k in (1, 2, 3)])
    np.testing.assert_allclose(values, np.linalg.eigvalsh(tensor)[:, ::-1], atol=1e-9)
    least = cells["s_3_direction"][elastic]
    np.testing.assert_allclose(np.einsum("eij,ej->ei", tensor, least), values[:, 2:] * least, atol=1e-9)
    mean = (volume[elastic] @ s) / 0.4
    np.testing.assert_allclose(mean, result.stress.mean[1], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(cells["body_s_3"][elastic], result.stress.principal_in_space[0][1, 2], rtol=1e-12)


@pytest.mark.parametrize("name", ["panel", "mixed"])
def test_vtk_reads_contacts(name: str, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    result: Result = request.getfixturevalue(name)
    write_paraview(result, tmp_path)
    grid, points, data, _ = _read(tmp_path / "contacts_0000.vtu")
    contacts = result.contacts
    assert grid.GetNumberOfCells() == len(contacts)
    for found, values in (
        (points[:, :2], contacts.point),
        (data["normal_force"], contacts.normal_force),
        (data["friction_force"], contacts.friction_force[:, 0]),
        (data["force"][:, :2], contacts.force_on_b),
        (data["gap"], contacts.gap),
        (data["slip"], contacts.slip[:, 0]),
        (data["pressure"], contacts.pressure),
    ):
        np.testing.assert_allclose(found, values, rtol=1e-12, atol=0.0)
    np.testing.assert_array_equal(data["state"], contacts.state)


def test_time_series_names_its_steps(panel: Result, tmp_path: Path) -> None:
    half = concio.solve(panel.assembly, factors={"top": 0.5})
    write_paraview([half, panel], tmp_path, times=[0.5, 1.0])
    from xml.etree import ElementTree

    sets = ElementTree.parse(tmp_path / "bodies.pvd").getroot().findall("Collection/DataSet")
    assert [(float(s.get("timestep")), s.get("file")) for s in sets] == [
        (0.5, "bodies_0000.vtu"), (1.0, "bodies_0001.vtu"),
    ]  # fmt: skip
    _, _, data, _ = _read(tmp_path / sets[0].get("file"))
    assert np.abs(data["displacement"]).max() == pytest.approx(
        np.abs(half.displacement).max(), rel=1e-12
    )  # fmt: skip
    with pytest.raises(InputError, match="3 times"):
        write_paraview([half, panel], tmp_path, times=[0, 1, 2])


def test_collapse_carries_its_velocity(collapse: Result, tmp_path: Path) -> None:
    write_paraview(collapse, tmp_path)
    _, _, data, _ = _read(tmp_path / "bodies_0000.vtu")
    assert not data["displacement"].any()
    free = [result_b for result_b, b in enumerate(collapse.model.bodies) if b.kind != "fixed"]
    wanted = np.abs(np.vstack([collapse.node_displacement(b, collapse.mechanism_velocity) for b in free])).max()
    assert np.abs(data["velocity"]).max() == pytest.approx(wanted, rel=1e-12)
    _, _, contact, _ = _read(tmp_path / "contacts_0000.vtu")
    assert "normal_force" not in contact


def test_names_are_escaped(tmp_path: Path) -> None:
    grid = Grid(np.zeros((1, 2)), np.array([0]), np.array([1]), np.array([VERTEX]), {'a "<&': np.ones(1)})
    _, _, data, _ = _read(write_vtu(grid, tmp_path / "odd.vtu"))
    assert list(data) == ['a "<&']
    assert b"\n<!-- forces in kN, lengths in m, " in (tmp_path / "odd.vtu").read_bytes()
