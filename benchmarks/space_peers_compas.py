"""compas_cra on one case; run by a Python that has it (``pip install compas_cra``, its solver is in the wheel).

    python space_peers_compas.py case.json answer.json

Knows nothing of concio. The case names a sample of the package, or brings blocks (vertices and faces); the answer has
blocks, supports, interfaces as compas_cra found them, forces at their corners, displacements, seconds and its verdict.
"""

import contextlib
import io
import json
import sys
import time
from pathlib import Path


def assembly_of(case):
    """Return the assembly of a case."""
    import compas
    import compas_cra
    from compas_assembly.datastructures import Block
    from compas_cra.datastructures import CRA_Assembly

    if "sample" in case:
        folder = Path(compas_cra.__file__).parent / "data" / "samples"
        assembly = compas.json_load(str(folder / (case["sample"] + ".json"))).copy(cls=CRA_Assembly)
    else:
        assembly = CRA_Assembly()
        for k, (vertices, faces) in enumerate(case["blocks"]):
            assembly.add_block(Block.from_vertices_and_faces(vertices, faces), node=k)
    if case["supports"]:
        assembly.set_boundary_conditions(case["supports"])
    for node in case.get("heavy", []):
        assembly.node_block(node).attributes["density"] = case["heavy_density"]
    return assembly


def write(assembly, detection, verdict, seconds):
    """Write the answer: before solving, too, for whom stops the process."""
    index = {node: k for k, node in enumerate(assembly.graph.nodes())}
    blocks = []
    for node in index:
        block = assembly.node_block(node)
        numbers = {v: k for k, v in enumerate(block.vertices())}
        blocks.append({
            "vertices": [block.vertex_coordinates(v) for v in block.vertices()],
            "faces": [[numbers[v] for v in block.face_vertices(f)] for f in block.faces()],
            "support": bool(assembly.graph.node_attribute(node, "is_support")),
            "density": block.attributes.get("density", 1.0),
            "displacement": list(assembly.graph.node_attribute(node, "displacement") or [0.0] * 6),
            "centre": list(block.center()),
        })  # fmt: skip
    interfaces = []
    for a, b in assembly.graph.edges():
        for interface in assembly.graph.edge_attribute((a, b), "interfaces"):
            frame = interface.frame
            forces = [[f["c_np"] - f["c_nn"], f["c_u"], f["c_v"]] for f in interface.forces or []]
            axes = [list(frame.zaxis), list(frame.xaxis), list(frame.yaxis)]
            points = [list(p) for p in interface.points]
            interfaces.append({"a": index[a], "b": index[b], "points": points, "axes": axes, "forces": forces})
    answer = {"verdict": verdict, "detection": detection, "seconds": seconds}
    Path(sys.argv[2]).write_text(json.dumps(answer | {"blocks": blocks, "interfaces": interfaces}))


def main():
    """Solve the case of the first file, write the answer to the second."""
    from compas_cra.algorithms import assembly_interfaces_numpy
    from compas_cra.equilibrium import cra_penalty_solve, cra_solve, rbe_solve

    case = json.loads(Path(sys.argv[1]).read_text())
    assembly = assembly_of(case)
    begin = time.process_time()
    if not any(assembly.graph.edge_attribute(e, "interfaces") for e in assembly.graph.edges()):
        assembly_interfaces_numpy(assembly, nmax=case["nmax"], amin=case["amin"], tmax=case["tmax"])
    if case.get("turned"):
        assembly.rotate_assembly([0, 0, 0], case["turned"], 90)
    detection = time.process_time() - begin
    write(assembly, detection, "stopped", 0.0)
    options = {"mu": case["mu"], "density": 1.0}
    if case["method"] != "rbe":
        options |= {"d_bnd": case["d_bnd"], "eps": case["eps"]}
    solve = {"rbe": rbe_solve, "cra": cra_solve, "penalty": cra_penalty_solve}[case["method"]]
    begin = time.process_time()
    said = "ok"
    with contextlib.redirect_stdout(io.StringIO()):
        try:
            solve(assembly, **options)
        except (ValueError, RuntimeError) as error:
            said = str(error).splitlines()[0]
    seconds = time.process_time() - begin
    write(assembly, detection, said, seconds)


if __name__ == "__main__":
    main()
