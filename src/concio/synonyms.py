"""Other words for what has a name here: of other programs, of the literature, in symbols and in Italian.

They are not accepted, so that every file says one thing in one way; whoever types one is shown the word that is meant.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

SAME: Mapping[str, tuple[str, ...]] = {
    "blocks": ("bodies", "body", "elements", "stones", "bricks", "units", "voussoirs", "solids", "blocchi", "corpi"),
    "joints": ("contacts", "interfaces", "laws", "joint_laws", "contact_laws", "giunti", "contatti"),
    "supports": ("bcs", "boundary", "boundary_conditions", "constraints", "fixed", "restraints", "vincoli"),
    "loads": ("forces", "actions", "load_cases", "carichi", "forze", "azioni"),
    "ties": ("anchors", "bars", "cables", "chains", "rods", "tie_rods", "catene", "tiranti"),
    "materials": ("properties", "sections", "materiali"),
    "stages": ("phases", "steps", "history", "fasi"),
    "outline": ("contour", "corners", "nodes", "points", "polygon", "vertices", "xy", "contorno", "vertici"),
    "vertices": ("nodes", "outline", "points", "vertici"),
    "rectangle": ("rect", "box", "rettangolo"),
    "name": ("id", "label", "tag", "nome"),
    "kind": ("type", "tipo"),
    "friction": ("mu", "friction_coefficient", "coefficient_of_friction", "phi", "tan_phi", "attrito"),
    "cohesion": ("c", "coesione"),
    "dilatancy": ("psi", "dilation", "dilatanza"),
    "tensile_strength": ("ft", "f_t", "tension", "tensile"),
    "compressive_strength": ("fc", "f_c", "cap", "compression", "crushing_strength"),
    "normal_stiffness": ("kn", "k_n"),
    "tangential_stiffness": ("ks", "kt", "k_s", "k_t", "shear_stiffness"),
    "E": ("young", "youngs_modulus", "young_modulus", "elastic_modulus", "modulus"),
    "nu": ("poisson", "poissons_ratio", "poisson_ratio"),
    "unit_weight": ("density", "gamma", "rho", "weight", "specific_weight", "peso_specifico"),
    "thickness": ("depth", "spessore"),
    "cover": ("depth", "fill_depth", "depth_of_fill", "crown_depth", "ricoprimento"),
    "ring": ("thickness", "ring_thickness", "barrel_thickness", "spessore"),
    "rise": ("freccia",),
    "friction_angle": ("phi", "angle", "angolo_di_attrito"),
    "depth": ("thickness",),
    "span": ("width", "opening", "luce"),
    "length": ("width", "lunghezza"),
    "width": ("length", "larghezza"),
    "height": ("altezza",),
    "courses": ("rows", "layers", "corsi"),
    "joint": ("mortar_thickness", "giunto"),
    "at": ("point", "position", "punto"),
    "group": ("case", "load_case", "gruppo"),
    "value": ("magnitude", "valore"),
    "displacement": ("settlement", "cedimento", "spostamento"),
    "engine": ("linear_solver", "backend"),
    "blocks_file": ("drawing_file", "dxf", "dxf_file", "file_of_blocks"),
    "solids_file": ("ifc_file", "mesh_file", "obj_file", "stl_file"),
}  # fmt: skip
"""The other words of each name, in lower case."""


def meant(word: str, known: Iterable[str]) -> str | None:
    """Return the known word for which another one stands, None where it stands for none of them.

    Parameters
    ----------
    word : str
    known : iterable of str
        Where several of them go by the other word, the first one of :data:`SAME` counts.
    """
    folded, here = word.casefold().replace(" ", "_").replace("-", "_"), set(known)
    return next((name for name, others in SAME.items() if name in here and folded in others), None)
