"""Stand-ins for analysis programs: `python stand_ins.py NAME ARGUMENTS`.

Each reads the input of the program of that name in its true format, refuses what the format does
not have, and writes a file in the format of its output. Numbers are estimates: lifting surfaces and
panels where that is short, else plate friction. They stand in for XFOIL, AVL, SU2, OpenFOAM, HAMS
and Nemoh where these are not installed.
"""

from __future__ import annotations

import math
import re
import sys
from pathlib import Path

import numpy as np


def need(held: object, said: str) -> None:
    """Ends with the status 2 where the input is not in the program's format."""
    if not held:
        print(f"stand-in: {said}")
        sys.exit(2)


def friction(reynolds: float) -> float:
    """ITTC 1957."""
    return 0.075 / (math.log10(reynolds) - 2) ** 2


# -- XFOIL ---------------------------------------------------------------------------------


def xfoil(_: list[str]) -> None:
    """Top level, OPER and its polar: LOAD, PANE, ITER, VISC, MACH, PACC, CL."""
    lines = iter([line.rstrip("\n") for line in sys.stdin])
    points, reynolds, mach, polar, menu = np.empty((0, 2)), 0.0, 0.0, "", ""
    for line in lines:
        word, _, value = line.strip().upper().partition(" ")
        if not word:
            menu = ""
        elif menu == "PLOP":
            need(word == "G", f"PLOP has no {word}")
        elif word in ("PLOP", "OPER"):
            menu = word
        elif word == "QUIT":
            return
        elif not menu:
            need(word in ("LOAD", "PANE"), f"XFOIL has no {word}")
            if word == "LOAD":
                text = Path(line.split()[1]).read_text().splitlines()
                points = np.array([[float(w) for w in row.split()] for row in text[1:]])
                need(len(points) > 20 and points.shape[1] == 2, "no coordinates")
                need(points[0, 0] > 0.9 and points[-1, 0] > 0.9, "from tail to tail")
        elif word == "PACC" and not polar:
            polar, dump = next(lines).strip(), next(lines).strip()
            need(polar and not dump, "a polar file and no dump file")
            Path(polar).write_text(
                "  \n       XFOIL         Version 6.99\n  \n Calculated polar for: section\n  \n"
                " 1 1 Reynolds number fixed          Mach number fixed         \n  \n"
                " xtrf =   1.000 (top)        1.000 (bottom)  \n"
                f" Mach = {mach:7.3f}     Re = {reynolds / 1e6:9.3f} e 6     Ncrit =   9.000\n  \n"
                "   alpha    CL        CD       CDp       CM     Top_Xtr  Bot_Xtr\n"
                "  ------ -------- --------- --------- -------- -------- --------\n"
            )
        elif word == "CL":
            need(reynolds > 0 and polar, "VISC and PACC come before CL")
            alpha, moment, thick = thin_aerofoil(points, float(value))
            drag = 2 * friction(reynolds) * (1 + 2 * thick + 60 * thick**4)
            with Path(polar).open("a") as out:
                out.write(
                    f"{math.degrees(alpha):8.3f}{float(value):9.4f}{drag:10.5f}{0.1 * drag:10.5f}"
                    f"{moment:9.4f}{0.4:9.4f}{0.6:9.4f}\n"
                )
        elif word == "VISC":
            reynolds = float(value)
        elif word == "MACH":
            mach = float(value)
        else:
            need(word in ("ITER", "PACC"), f"OPER has no {word}")
    need(False, "the input ends without QUIT")


def thin_aerofoil(points: np.ndarray, lift: float) -> tuple[float, float, float]:
    """Angle of attack, moment about a quarter of the chord, thickness."""
    nose = int(np.argmin(points[:, 0]))
    theta = (np.arange(200) + 0.5) * np.pi / 200
    x = (1 - np.cos(theta)) / 2
    up = np.interp(x, *points[nose::-1].T)
    low = np.interp(x, *points[nose:].T)
    slope = np.gradient((up + low) / 2, x)
    a0, a1, a2 = (k * np.mean(slope * np.cos(n * theta)) for k, n in ((1, 0), (2, 1), (2, 2)))
    alpha = (lift / math.pi - a1) / 2 + a0
    return alpha, -math.pi / 4 * (a1 - a2), float((up - low).max())


# -- AVL -----------------------------------------------------------------------------------


def avl(arguments: list[str]) -> None:
    """The file of one surface; OPER, A C, X, FT: a vortex lattice, one row along the chord."""
    lines = [
        line.split("#")[0].split("!")[0].strip()
        for line in Path(arguments[0]).read_text().splitlines()
    ]
    lines = [line for line in lines if line]
    mach, (sym_y, sym_z, _), (area, _, span) = (
        [float(w) for w in line.split()] for line in lines[1:4]
    )
    need(len(mach if isinstance(mach, list) else [mach]) == 1, "the Mach number")
    need(sym_y == 0 and sym_z == 0 and lines[5].split()[0] == "SURFACE", "a SURFACE")
    counts = [float(w) for w in lines[7].split()]
    need(len(counts) == 4, "Nchordwise Cspace Nspanwise Sspace")
    need("YDUPLICATE" in lines, "YDUPLICATE")
    sections, camber = [], []
    for k, line in enumerate(lines):
        if line == "SECTION":
            sections.append([float(w) for w in lines[k + 1].split()])
            need(len(sections[-1]) == 5 and lines[k + 2] == "AFILE", "a section with AFILE")
            text = Path(lines[k + 3]).read_text().splitlines()
            points = np.array([[float(w) for w in row.split()] for row in text[1:]])
            camber.append(-thin_aerofoil(points, 0.0)[0])
    need(len(sections) == 2, "two sections")
    wanted, out = avl_commands()
    root, tip = np.array(sections)
    count = 2 * int(counts[2])
    edges = -np.cos(np.linspace(0, np.pi, count + 1))
    middle = (edges[1:] + edges[:-1]) / 2

    def at(s: np.ndarray) -> np.ndarray:
        return root + np.abs(s)[:, None] * (tip - root)

    ends, mid = at(edges), at(middle)
    y = np.sign(edges) * ends[:, 1]
    bound = np.stack([ends[:, 0] + ends[:, 3] / 4, y, ends[:, 2]], axis=1)
    control = np.stack(
        [mid[:, 0] + 0.75 * mid[:, 3], np.sign(middle) * mid[:, 1], mid[:, 2]], axis=1
    )
    across = np.diff(bound[:, 1:], axis=0)
    width = np.hypot(*across.T)
    normal = np.stack([np.zeros(count), -across[:, 1], across[:, 0]], axis=1) / width[:, None]
    zero_lift = np.array(camber)
    zero = zero_lift[0] + np.abs(middle) * (zero_lift[1] - zero_lift[0])
    turn = np.radians(mid[:, 4]) + zero
    influence = np.einsum("pqk,pk->pq", horseshoes(control, bound), normal)
    once = np.linalg.solve(influence, -np.stack([turn, np.ones(count)], axis=1))
    lift = 2 / area * (once * (width * normal[:, 2])[:, None]).sum(axis=0)
    alpha = (wanted - lift[0]) / lift[1]
    circulation = once[:, 0] + alpha * once[:, 1]
    # The Trefftz plane: each strip's wash by the trailing vortices.
    ends_yz, mid_yz = bound[:, 1:], (bound[1:, 1:] + bound[:-1, 1:]) / 2
    shed = np.diff(np.concatenate([[0], circulation, [0]]))
    apart = mid_yz[:, None] - ends_yz[None]
    wash = np.stack([-apart[..., 1], apart[..., 0]], axis=-1) / (apart**2).sum(-1)[..., None]
    wash = np.einsum("pqk,pk,q->p", wash, normal[:, 1:], shed) / (2 * np.pi)
    drag = abs((circulation * wash * width).sum()) / area
    e = wanted**2 * area / (math.pi * span**2 * drag)
    Path(out).write_text(
        " ---------------------------------------------------------------\n"
        " Vortex Lattice Output -- Total Forces\n\n"
        f"  Alpha ={math.degrees(alpha):10.5f}     pb/2V =  -0.00000     p'b/2V =  -0.00000\n"
        f"  CLtot ={wanted:10.5f}\n  CDtot ={drag:10.5f}\n"
        f"  CLff  ={wanted:10.5f}     CDff  ={drag:11.7f}    | Trefftz\n"
        f"  CYff  ={0:10.5f}         e =    {e:6.4f}    | Plane  \n"
    )


def horseshoes(at: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Velocities at points by horseshoe vortices of circulation 1, ``(points, vortices, 3)``."""
    r1, r2 = at[:, None] - ends[None, :-1], at[:, None] - ends[None, 1:]
    n1, n2 = (np.linalg.norm(r, axis=-1)[..., None] for r in (r1, r2))
    found = np.cross(r1, r2) * (1 / n1 + 1 / n2) / (n1 * n2 + (r1 * r2).sum(-1)[..., None])
    x = np.array([1.0, 0, 0])
    for r, n, sign in ((r1, n1, 1), (r2, n2, -1)):
        found += sign * np.cross(r, x) / (n * (n - r[..., :1]))
    return found / (4 * np.pi)


def avl_commands() -> tuple[float, str]:
    """The lift coefficient and the file of the forces."""
    words = [line.strip() for line in sys.stdin]
    need(words[0].upper() == "OPER" and words[-1].upper() == "QUIT", "OPER first, QUIT last")
    wanted, out = math.nan, ""
    for k, line in enumerate(words):
        if line.upper().startswith("A C "):
            wanted = float(line.split()[2])
        elif line.upper() == "FT":
            need("X" in [w.upper() for w in words[:k]], "X comes before FT")
            out = words[k + 1]
    need(math.isfinite(wanted) and out, "A C and FT with a file")
    return wanted, out


# -- SU2 -----------------------------------------------------------------------------------

SU2_KEYS = [
    "SOLVER",
    "MATH_PROBLEM",
    "RESTART_SOL",
    "MACH_NUMBER",
    "AOA",
    "SIDESLIP_ANGLE",
    "FREESTREAM_PRESSURE",
    "FREESTREAM_TEMPERATURE",
    "FIXED_CL_MODE",
    "TARGET_CL",
    "DCL_DALPHA",
    "UPDATE_AOA_ITER_LIMIT",
    "ITER_DCL_DALPHA",
    "REF_ORIGIN_MOMENT_X",
    "REF_ORIGIN_MOMENT_Y",
    "REF_ORIGIN_MOMENT_Z",
    "REF_LENGTH",
    "REF_AREA",
    "MARKER_EULER",
    "MARKER_FAR",
    "MARKER_MONITORING",
    "MARKER_PLOTTING",
    "NUM_METHOD_GRAD",
    "CONV_NUM_METHOD_FLOW",
    "JST_SENSOR_COEFF",
    "TIME_DISCRE_FLOW",
    "LINEAR_SOLVER",
    "LINEAR_SOLVER_PREC",
    "LINEAR_SOLVER_ERROR",
    "LINEAR_SOLVER_ITER",
    "CFL_NUMBER",
    "ITER",
    "CONV_FIELD",
    "CONV_RESIDUAL_MINVAL",
    "MESH_FILENAME",
    "MESH_FORMAT",
    "TABULAR_FORMAT",
    "CONV_FILENAME",
    "HISTORY_OUTPUT",
    "OUTPUT_FILES",
]


def su2(arguments: list[str]) -> None:
    """The options and the mesh; a history whose drag is the square of the greatest thickness."""
    options = {}
    for line in Path(arguments[0]).read_text().splitlines():
        line = line.split("%")[0].strip()
        if line:
            name, _, value = line.partition("=")
            need(name.strip() in SU2_KEYS, f"SU2 has no option {name}")
            options[name.strip()] = value.strip().strip("()").strip()
    lines = iter(Path(options["MESH_FILENAME"]).read_text().splitlines())

    def count(name: str) -> int:
        found, _, value = next(lines).partition("=")
        need(found == name, f"{name} is expected, found {found}")
        return int(value)

    need(count("NDIME") == 2, "two dimensions")
    cells = np.array([[int(w) for w in next(lines).split()] for _ in range(count("NELEM"))])
    points = np.array([[float(w) for w in next(lines).split()] for _ in range(count("NPOIN"))])
    need((cells[:, 0] == 9).all() and (cells[:, 5] == np.arange(len(cells))).all(), "cells")
    a, b, c, d = (points[cells[:, k], :2] for k in (1, 2, 3, 4))
    across = (c - a)[:, 0] * (d - b)[:, 1] - (c - a)[:, 1] * (d - b)[:, 0]
    need((across > 0).all(), f"{(across <= 0).sum()} cells are clockwise")
    markers = {}
    for _ in range(count("NMARK")):
        name = next(lines).partition("=")[2].strip()
        edges = [[int(w) for w in next(lines).split()] for _ in range(count("MARKER_ELEMS"))]
        markers[name] = np.array(edges)
    for option in ("MARKER_EULER", "MARKER_FAR"):
        need(options[option] in markers, f"the mesh has no marker {options[option]}")
    edges = markers[options["MARKER_EULER"]]
    need(sorted(edges[:, 1]) == sorted(edges[:, 2]), "the wall is a loop")
    wall = points[edges[:, 1], :2]
    drag = float(np.ptp(wall[:, 1])) ** 2
    lift = float(options["TARGET_CL"])
    names = '"Time_Iter","Outer_Iter","Inner_Iter",     "rms[Rho]"     ,'
    header = names + '       "CD"       ,       "CL"       '
    rows = [
        f"          0,          0,{k:11d},{-3.0 - k:19.8f},"
        f"{drag * (1 + 0.5**k):18.10f},{lift:18.10f}"
        for k in range(40)
    ]
    Path(options["CONV_FILENAME"] + ".csv").write_text("\n".join([header, *rows]) + "\n")


# -- OpenFOAM ------------------------------------------------------------------------------


def foam_text(name: str) -> str:
    """A dictionary of OpenFOAM without comments; its braces match and its header names it."""
    text = re.sub(r"//.*|/\*.*?\*/", "", Path(name).read_text())
    need(text.count("{") == text.count("}") and text.count("(") == text.count(")"), name)
    need(re.search(rf"object\s+{Path(name).name};", text), f"{name} has no header")
    need("{{" not in text and not re.search(r"\{\w+\}", text), f"{name} has words left")
    return text


def block_mesh(_: list[str]) -> None:
    """blockMeshDict; the boundary of the mesh."""
    text = foam_text("system/blockMeshDict")
    foam_text("system/controlDict")
    values = dict(re.findall(r"^(\w+)\s+(-?[\d.e+]+);", text, re.M))
    vertices = re.search(r"vertices\s*\((.*?)\);", text, re.S)
    words = re.findall(r"[^\s()]+", vertices[1] if vertices else "")
    for name in {w.strip("$") for w in words if w.startswith("$")}:
        need(name in values, f"${name} is undefined")
    need(len(words) == 24, "eight vertices")
    names = re.findall(r"(\w+)\s*\{\s*type \w+; faces", text)
    Path("constant/polyMesh").mkdir(parents=True)
    Path("constant/polyMesh/boundary").write_text("\n".join(names) + "\n")


def snappy(arguments: list[str]) -> None:
    """snappyHexMeshDict and its STL; a patch for each solid of it."""
    need(arguments == ["-overwrite"], "-overwrite")
    text = foam_text("system/snappyHexMeshDict")
    file, name = re.search(r"(\S+\.stl)\s*\{ type triSurfaceMesh; name (\w+);", text).groups()
    stl = (Path("constant/triSurface") / file).read_text()
    solids = re.findall(r"^solid (\S+)", stl, re.M)
    with Path("constant/polyMesh/boundary").open("a") as out:
        out.writelines(f"{name}_{solid}\n" for solid in solids)
    print(f"Snapped mesh : cells:{4 * stl.count('facet normal')}  faces:1  points:1")


def simple_foam(_: list[str]) -> None:
    """Fields with every patch; the coefficient by plate friction over the STL's area."""
    patches = Path("constant/polyMesh/boundary").read_text().split()
    for field in ("U", "p", "k", "omega", "nut"):
        text = foam_text(f"0/{field}")
        boundary = text[text.index("boundaryField") :]
        known = re.findall(r'^\s+("?[\w.*]+"?)\s+\{', boundary, re.M)
        for patch in patches:
            need(any(re.fullmatch(k.strip('"'), patch) for k in known), f"{field}: {patch}")
    for name in ("constant/transportProperties", "constant/turbulenceProperties"):
        foam_text(name)
    control = foam_text("system/controlDict")
    speed, length, area = (
        float(re.search(rf"{n}\s+([\d.e+-]+);", control)[1]) for n in ("magUInf", "lRef", "Aref")
    )
    (stl,) = Path("constant/triSurface").glob("*.stl")
    rows = re.findall(r"vertex (\S+) (\S+) (\S+)", stl.read_text())
    corners = np.array(rows, dtype=float).reshape(-1, 3, 3)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    wetted = np.linalg.norm(normals, axis=1).sum() / 2
    need(abs(normals.sum(axis=0)).max() < 1e-3 * wetted, "the STL is open")
    drag = friction(speed * length / 1.19e-6) * wetted / area
    folder = Path("postProcessing/forceCoeffs/0")
    folder.mkdir(parents=True)
    names = ["Time", "Cd", "Cs", "Cl", "CmRoll", "CmPitch", "CmYaw", "Cd(f)", "Cd(r)"]
    rows = ["\t".join([str(k), f"{drag * (1 + 1 / k):e}", *["0.000000e+00"] * 7]) for k in (1, 99)]
    (folder / "coefficient.dat").write_text(
        "# Force coefficients\n# dragDir     : (1.000000e+00 0.000000e+00 0.000000e+00)\n"
        "# Aref        : 1\n# "
        + "\t".join(f"{n:14}" for n in names)
        + "\n"
        + "\n".join(rows)
        + "\n"
    )


# -- HAMS and Nemoh ------------------------------------------------------------------------


def heave(vertices: np.ndarray, faces: np.ndarray, where: float, water: tuple, omega: list) -> list:
    """Added mass and damping of heave by Capytaine, of a body mirrored in y = 0."""
    import capytaine as cpt

    cpt.set_logging("ERROR")
    mirrored = vertices * [1, -1, 1]
    points = np.concatenate([vertices, mirrored])
    panels = np.concatenate([faces, faces[:, ::-1] + len(vertices)])
    body = cpt.FloatingBody(cpt.Mesh(points, panels))
    body.add_translation_dof(name="Heave")
    density, gravity, depth = water
    rows = []
    for w in omega:
        problem = cpt.RadiationProblem(
            body=body, radiating_dof="Heave", omega=w, rho=density, g=gravity, water_depth=depth
        )
        found = cpt.BEMSolver().solve(problem)
        rows.append((w, found.added_masses["Heave"], found.radiation_dampings["Heave"]))
    return rows


def hams(_: list[str]) -> None:
    """ControlFile.in, HullMesh.pnl, Hydrostatic.in; `Buoy.1` with heave alone."""
    control = Path("Input/ControlFile.in").read_text().replace("D0", "")
    value = {
        m[1]: [float(w) for w in m[2].split()]
        for m in re.finditer(r"^ +([A-Za-z_0-9-]+) +((?:-?[\d.]+ *)+)$", control, re.M)
    }
    need(value["Input_frequency_type"] == [3] and value["Output_frequency_type"] == [3], "w")
    count, first, step = (
        value[n][0] for n in ("Number_of_frequencies", "Minimum_frequency_Wmin", "Frequency_step")
    )
    need(count < 0, "frequencies by a step")
    body = Path("Input/Hydrostatic.in").read_text().splitlines()
    titles = [k for k, line in enumerate(body) if line.endswith(":")]
    need(titles == [0, 2, 9, 16, 23, 30] and len(body) == 37, "matrices of Hydrostatic.in")
    need(all(len(line.split()) == 6 for k, line in enumerate(body[2:]) if k % 7), "rows of six")
    mesh = Path("Input/HullMesh.pnl").read_text().splitlines()
    rows = [line.split() for line in mesh if re.match(r"^\s*[\d-]", line)]
    rows = [row for row in rows if not row[0].startswith("--")]
    panels, nodes, x, y = (int(w) for w in rows[0])
    need((x, y) == (0, 1), "at present, ISX and ISY cannot be simultaneously 1")
    vertices = np.array(rows[1 : 1 + nodes], dtype=float)[:, 1:]
    corners = [[int(w) - 1 for w in row[2:]] for row in rows[1 + nodes : 1 + nodes + panels]]
    need(
        all(len(c) == int(r[1]) for c, r in zip(corners, rows[1 + nodes :], strict=True)), "panels"
    )
    faces = np.array([c if len(c) == 4 else [*c, c[2]] for c in corners])
    omega = [first + step * k for k in range(int(-count))]
    found = heave(vertices, faces, 0.0, (1025.0, 9.81, -value["Waterdepth"][0]), omega)
    lines = [
        f"{w:14.6E}{i:6d}{j:6d}{a / 1025 if i == j == 3 else 0:14.6E}"
        f"{b / 1025 / w if i == j == 3 else 0:14.6E}"
        for w, a, b in found
        for i in range(1, 7)
        for j in range(1, 7)
    ]
    Path("Output/Wamit_format/Buoy.1").write_text("\n".join(lines) + "\n")


def nemoh_pre(_: list[str]) -> None:
    """ID.dat, Nemoh.cal and its mesh."""
    need(Path("ID.dat").read_text().split() == ["1", "."], "ID.dat")
    need(Path("input.txt").read_text().startswith("---"), "input.txt")
    cal = Path("Nemoh.cal").read_text().splitlines()
    points, panels = (int(w) for w in cal[9].split()[:2])
    mesh = [line.split() for line in Path(cal[8].split()[0]).read_text().splitlines()]
    need(mesh[0] == ["2", "1"], "a mesh of one side")
    need([row[0] for row in mesh].count("0") == 2, "two rows of zeros")
    need(float(mesh[points + 1][0]) == 0 and len(mesh) == points + panels + 3, "counts")
    Path("mesh/L12.dat").write_text("stand-in\n")


def nemoh_solver(_: list[str]) -> None:
    """The coefficients, in a file of the stand-in."""
    need(Path("mesh/L12.dat").exists(), "preProc first")
    cal = Path("Nemoh.cal").read_text().splitlines()
    density, gravity, depth = (float(cal[k].split()[0]) for k in (1, 2, 3))
    points = int(cal[9].split()[0])
    mesh = [line.split() for line in Path(cal[8].split()[0]).read_text().splitlines()]
    vertices = np.array(mesh[1 : 1 + points], dtype=float)[:, 1:]
    faces = np.array(mesh[2 + points : -1], dtype=int) - 1
    load = next(k for k, line in enumerate(cal) if line.startswith("--- Load cases"))
    count, low, high = (float(w) for w in cal[load + 1].split()[:3])
    omega = list(np.linspace(low, high, int(count)))
    found = heave(vertices, faces, 0.0, (density, gravity, depth), omega)
    np.savetxt("results/stand-in.txt", np.array(found))


def nemoh_post(_: list[str]) -> None:
    """`RadiationCoefficients.tec` with heave alone."""
    rows = np.loadtxt("results/stand-in.txt")
    out = ['VARIABLES="w (rad/s)"', *(f'"A   1   {k}" "B   1   {k}"' for k in range(1, 7))]
    for motion in range(6):
        out.append(f'Zone t="Motion of body    1 in DoF   {motion + 1}",I= {len(rows):5d},F=POINT')
        for w, a, b in rows:
            pairs = [(a, b) if motion == k == 2 else (0.0, 0.0) for k in range(6)]
            out.append("".join(f" {v:14.7E}" for v in (w, *(v for p in pairs for v in p))))
    Path("results/RadiationCoefficients.tec").write_text("\n".join(out) + "\n")


PROGRAMS = {
    "xfoil": xfoil,
    "avl": avl,
    "SU2_CFD": su2,
    "blockMesh": block_mesh,
    "snappyHexMesh": snappy,
    "simpleFoam": simple_foam,
    "HAMS_Prog": hams,
    "preProc": nemoh_pre,
    "solver": nemoh_solver,
    "postProc": nemoh_post,
}

if __name__ == "__main__":
    PROGRAMS[sys.argv[1]](sys.argv[2:])
