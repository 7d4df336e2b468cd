"""Terms of each field, with the page, kind or function that explains them.

``moldloft doc TERM`` and the index of terms in the documentation use this table.
"""

from __future__ import annotations

__all__ = ["FIELDS", "targets"]

#: Field: target and its terms. A target is a page of the documentation, a kind or a function.
FIELDS: dict[str, dict[str, str]] = {
    "Naval architecture": {
        "hydrostatics": (
            "hydrostatics, displacement, displaced volume, draft, draught, trim, heel, freeboard,"
            " metacentre, metacentric height, metacentric radius, GM, KM, KB, BM, centre of "
            "buoyancy, LCB, VCB, LCF, centre of flotation, waterplane, waterplane area, wetted "
            "area, block coefficient, prismatic coefficient, midship coefficient, waterplane "
            "coefficient, tonnes per centimetre, TPC, moment to change trim, MTC, righting arm, "
            "GZ curve, cross curves, KN, downflooding, angle of loll, equilibrium, stability "
            "criteria, stability booklet, Bonjean curves, section area curve, hydrostatic "
            "stiffness, loading condition"
        ),
        "tutorials/naval-architect": "offset table, half-breadth, lines plan, body plan",
        "XContours": "station",
        "YContours": "buttock",
        "ZContours": "waterline",
        "Weight": "weight estimate, centre of gravity",
        "relational": "sheer, chine",
        "DevSurf": "plate development, developable hull",
        "fairing": "knuckle, batten, lofting",
        "python": "resistance, Holtrop",
    },
    "Aerofoils, wings and propellers": {
        "FoilCurve": (
            "aerofoil, airfoil, camber, mean line, thickness distribution, leading edge, trailing"
            " edge, leading edge radius, chord, foil section, NACA section, NACA 66"
        ),
        "FoilLoftSurf": "wing, keel fin, rudder, taper, blade surface",
        "FoilSnake": "foil on a surface",
        "naca4": "NACA 4-digit",
        "naca5": "NACA 5-digit",
        "naca16": "NACA 16-series",
        "naca6": "NACA 6-series, a = 0.8 mean line",
        "naca66tmb": "TMB thickness",
        "read_aerofoil": "aerofoil coordinates, Selig format, Lednicer format, UIUC",
        "tutorials/propeller": (
            "propeller, blade, hub, pitch, skew, rake, blade root, advance, pitch ratio"
        ),
        "tutorials/cfd": (
            "wing and body, wing-body junction, sweep angle, dihedral, wing tip, span, aspect ratio"
        ),
        "XLoftSurf": "wing loft",
        "twisted": "twist, washout",
        "RotatCurve": "blade section rotation",
        "CylinderContours": "cylindrical blade section",
        "deformation": "free-form deformation, FFD, shape optimisation, control box",
        "python": "sensitivity, shape derivative",
        "studies": "design variable",
        "panels": "panel method, lifting surface, vortex lattice",
    },
    "Grids": {
        "grids": (
            "structured grid, surface grid, volume grid, multiblock, C-grid, O-grid, H-grid, "
            "first cell height, growth rate, stretching, wall spacing, y plus, orthogonality, "
            "boundary layer grid, smoothing, block face, blanking, Plot3D, CGNS, blockMesh"
        ),
        "quality": (
            "skewness, aspect ratio of cells, scaled Jacobian, cell quality, non-orthogonality"
        ),
        "folds": "folded cell, negative volume",
        "tfi": "transfinite interpolation, algebraic grid, Coons patch",
        "elliptic": "elliptic grid, Poisson smoothing, Laplace smoothing",
        "elliptic_block": "elliptic volume grid",
        "hyperbolic": "hyperbolic grid, marching, extrusion of a surface grid",
        "o_grid": "O topology",
        "c_grid": "C topology, wake cut",
        "h_grid": "H topology",
        "check_edges": "matching edges",
        "uniform": "uniform spacing",
        "cosine": "cosine spacing",
        "geometric": "geometric progression",
        "d_tanh": "hyperbolic tangent spacing, tanh stretching",
        "d_sinh": "hyperbolic sine spacing",
        "redist": "redistribution of points",
        "count_for": "number of cells for a ratio",
        "first_cell": "first cell size",
        "growth": "growth factor",
        "refined": "grid refinement, grid convergence study",
        "write_p3d": "Plot3D file, solver file",
        "write_cgns": "boundary condition patch",
        "write_su2": "SU2 mesh",
        "write_gmsh": "Gmsh mesh",
        "write_blockmesh": "OpenFOAM mesh",
        "write_polymesh": "OpenFOAM mesh, polyMesh",
        "write_ugrid": "FUN3D mesh, AFLR3 mesh, mapbc",
        "write_nmf": "neutral map file, block connectivity",
        "interfaces": "block connectivity, one-to-one interfaces",
        "RuledSolid": "hexahedral block",
        "BlendSolid": "transfinite solid",
        "write_vts": "ParaView file",
    },
    "Solids and implicit geometry": {
        "implicit": (
            "constructive solid geometry, CSG, Boolean, Boolean operation, set operation, "
            "implicit surface, signed distance, distance field, lattice, level set, F-rep, "
            "half-space, primitive, rail blend, sharp edge, printability, convex hull of sets"
        ),
        "fillet": "fillet between fields, rolling-ball fillet",
        "set_fillet": "fillet, edge fillet",
        "set_round": "rounded edge, round",
        "set_chamfer": "chamfer, bevel",
        "set_offset": "offset of a solid, thickening",
        "set_shell": "shell, hollow, wall thickness",
        "set_union": "union",
        "set_intersection": "intersection of solids",
        "convex_hull": "convex hull",
        "minkowski_sum": "Minkowski sum, dilation",
        "smooth_union": "smooth blend, smooth minimum, metaball",
        "extruded": "extrusion of a profile",
        "revolved": "solid of revolution, lathe",
        "cuboid": "box, cuboid, brick",
        "sphere": "sphere, ball",
        "cylinder": "cylinder, drilled hole",
        "torus": "torus, ring solid",
        "cone": "cone",
        "polyhedron": "polyhedron, closed mesh as a solid",
        "repeated": "linear pattern, array of solids",
        "circular_array": "circular pattern, polar array",
        "mirrored": "mirrored solid",
        "SetBody": "facets of a solid, tessellation, marching cubes, dual contouring",
        "mass_centre": "centre of mass",
        "inertia": "moment of inertia, inertia tensor",
        "volume": "volume of a solid",
        "tutorials/product": "pipe tee, manifold block, 3D printing",
    },
    "CAD, meshes and files": {
        "cad": (
            "boundary representation, B-rep, STEP, IGES, 3DM, Rhino, OpenCASCADE, trimmed "
            "surface, shell of faces, edge loop, sewing, tolerance of edges, AP242, CAD import, "
            "CAD export, healing, solid body in STEP"
        ),
        "formats": (
            "STL, OBJ, PLY, glTF, 3MF, GDF, Nemoh, HAMS, Capytaine, AQWA, VTK, OFF, WAMIT, DXF, "
            "SVG, unit conversion, mesh file, panel file, GLB"
        ),
        "panels": (
            "panel, facet, watertight, manifold, open edge, T-junction, mesh density, mesh "
            "quality, normal direction, waterline lid, irregular frequencies, symmetry plane, "
            "patch, divisions, triangulation"
        ),
        "TrimSurf": "trimming curve, hole in a surface, trimmed face",
        "TriMesh": "triangle mesh",
        "MeshBody": "imported mesh, scan, point cloud mesh",
        "FaceSurf": "face of a STEP file",
        "FacePatch": "retained CAD face",
        "Join": "join of patches, edge matching",
        "migration": "MultiSurf, OpenVSP, CadQuery, geomdl, OpenSCAD, Orca3D",
    },
    "Curves and surfaces": {
        "relational": (
            "parametric model, dependency, parent object, bead, magnet, ring, snake, constraint, "
            "component, parameter"
        ),
        "BCurve": (
            "B-spline curve, control point, control polygon, Bézier curve, spline degree, knot"
        ),
        "CCurve": "cubic spline, interpolating curve, curve through points",
        "NURBCurve": "NURBS, rational curve, weights of control points",
        "Conic": "conic section, parabola, ellipse arc, hyperbola, rho",
        "Arc": "circular arc",
        "Helix": "helix, spiral",
        "PolyCurve": "composite curve, joined curves",
        "SubCurve": "part of a curve, trimmed curve",
        "OffsetCurve": "offset curve, parallel curve",
        "ProjCurve": "projection of a curve",
        "Intersection": "intersection curve of cylinders",
        "RuledSurf": "ruled surface",
        "CLoftSurf": "loft, lofted surface, skinning",
        "BLoftSurf": "B-spline loft",
        "BSurf": "B-spline surface, tensor product surface, control net",
        "NURBSurf": "rational surface",
        "RevSurf": "surface of revolution",
        "SweepSurf": "sweep, swept surface, pipe surface",
        "TranSurf": "translation surface, extrusion",
        "BlendSurf": "Coons surface, blending four edges",
        "DevSurf": "developable surface, unrolling",
        "ExpandedSurf": "flat pattern, plate expansion",
        "OffsetSurf": "offset surface, plate thickness",
        "RollFillet": "rolling ball, fillet of surfaces",
        "SubSurf": "subsurface, trimmed patch",
        "MirrSurf": "mirror image",
        "GeoSnake": "geodesic, shortest path on a surface",
        "IntSnake": "intersection of surfaces, surface-surface intersection",
        "ProjSnake": "projection onto a surface",
        "UVSnake": "isoparametric curve, parameter line",
        "EdgeSnake": "edge curve of a surface",
        "ArcLenBead": "arc length",
        "TanPoint": "tangent line",
        "curvature": "curvature of a curve, curvature comb",
        "gauss": "Gaussian curvature",
        "torsion": "torsion",
        "normals": "surface normal",
        "closest": "nearest point, point projection",
        "FramePoint": "local coordinate system",
        "RPYFrame": "roll pitch yaw",
        "TanhRelabel": "reparametrisation",
    },
    "Fairing": {
        "fairing": (
            "fairing, fairness, fair curve, smoothing spline, least squares, tolerance band, "
            "residual, noise, outlier, inflection, curvature plot, convexity, bending energy, "
            "minimum variation, tangent continuity, curvature continuity, G1, G2, end condition, "
            "knot removal, digitised points, certificate, optimality gap, duality gap, data "
            "fitting, approximation of points, knuckle point, corner, planted error, wrong digit,"
            " fairing desk, fairing report, offsets to the last digit, monotone curvature, spline"
            " through points, isophote, zebra stripes, reflection lines, third derivative"
        ),
        "FairCurve": "faired curve",
        "FairSurf": "faired surface",
        "FairNet": "fair network, faired lines of a hull",
        "FairPatches": "fair patches, seam continuity",
        "FairSnake": "fair curve on a surface",
        "BFitCurve": "B-spline fit",
        "BFitSurf": "surface fit",
        "NUBFitCurve": "non-uniform fit",
        "jumps": "jump of a derivative",
        "fair": "fair rows of points",
        "workbench": "drag of a point",
        "inside/certificate": "proof of optimality, dual solution",
        "inside/fairing-studies": "study of noise",
        "NetCurve": "curve of a network",
        "NetSurf": "surface of a network",
    },
    "Sketches and civil engineering": {
        "sketch": (
            "sketch, dimension, geometric constraint, profile, orthographic view, isometric "
            "sketch, oblique line, degree of freedom, under-constrained, over-constrained, "
            "redundant dimension, horizontal line, vertical line, parallel lines, perpendicular, "
            "line type, plane of a face, drawing board, snap, hole, counterbore, countersink, "
            "slot, bolt circle, rectangle, polygon, fillet in a sketch, chamfer in a sketch, "
            "draft angle, symmetric part, journal, variable, section view, pocket, boss, wall, "
            "rebuild, wireframe, solid from lines, sloping face, imported sketch"
        ),
        "tutorials/dam": (
            "gravity dam, arch dam, overturning, sliding, uplift, spillway, heel pressure, factor"
            " of safety, concrete volume, water pressure, reservoir level"
        ),
        "sketch-routines": "sketch routine of 1983",
    },
    "Derivatives, optimisation and numerics": {
        "python": (
            "derivative, gradient, Jacobian, automatic differentiation, dual number, NumPy array,"
            " Jupyter, notebook, pandas, PyVista, trimesh, meshio"
        ),
        "tutorials/optimisation": (
            "optimiser, SciPy minimize, objective function, equality constraint, exact gradient"
        ),
        "studies": (
            "design of experiments, parameter study, sweep of parameters, Latin hypercube, Sobol "
            "sequence, Pareto front, multi-objective optimisation, robustness, manufacturing "
            "tolerance, OpenMDAO, Dask cluster, surrogate, constraint of a study, warm start, "
            "SLSQP, Ipopt, feasible design"
        ),
        "SolveSet": (
            "nonlinear equations, Newton's method, implicit function, solve for a parameter, "
            "target value"
        ),
        "soak": "random tests, fuzzing",
        "performance": "benchmark, speed, timing",
        "policy": "compatibility, versions, deprecation",
        "conventions": "axes, units, sign convention, right-handed",
        "diagnostics": "error message, warning",
        "development": "contributing, build from source",
        "architecture": "crates, incremental evaluation",
        "workbench": "browser, slider, viewer, live preview",
        "command-line": "command line, shell completion, exit status, pipe",
        "sdl": "array language, subroutine, loop, function definition",
    },
}


def _key(text: str) -> str:
    word = " ".join(text.lower().replace("-", " ").split())
    return word[:-1] if len(word) > 4 and word.endswith("s") and not word.endswith("ss") else word


_TARGETS: dict[str, list[str]] = {}
for _rows in FIELDS.values():
    for _target, _terms in _rows.items():
        for _term in _terms.split(", "):
            _TARGETS.setdefault(_key(_term), []).append(_target)


def targets(words: str) -> list[str]:
    """Pages, kinds and functions that explain a term; empty for an unknown one.

    Parameters
    ----------
    words
        A term, in singular or plural.

    Examples
    --------
    >>> targets("Metacentre"), targets("fillets")
    (['hydrostatics'], ['set_fillet'])
    """
    return _TARGETS.get(_key(words), [])
