# ruff: noqa: E501, E731
"""What the programs of tests/corpus/run/shapes.sdl must print, by NumPy, SciPy and plain Python; a function for each."""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import simpson
from scipy.interpolate import (
    BPoly,
    BSpline,
    CubicHermiteSpline,
    CubicSpline,
    RegularGridInterpolator,
)
from scipy.ndimage import uniform_filter
from scipy.optimize import brentq
from scipy.signal import argrelmax, find_peaks, lfilter
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation
from scipy.stats import rankdata

from wanted import Wanted, approx


def area_and_centre_of_a_polygon() -> Wanted:
    p = np.array([(0, 0), (4, 0), (5, 3), (2, 5), (-1, 2.0)])
    q = np.roll(p, -1, 0)
    w = p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]
    return approx([w.sum() / 2, *(((p + q) * w[:, None]).sum(0) / 6 / (w.sum() / 2))], 1e-13)


def inside_or_outside() -> Wanted:
    return [1, 0, 1, 0]


def convex_hull() -> Wanted:
    h = ConvexHull([(0, 0), (1, 1), (2, 2), (2, 0), (0, 2), (1, 0.5), (3, 1)]).vertices + 1
    return np.roll(h, -int(np.flatnonzero(h == 1)[0]))


def length_of_a_polyline() -> Wanted:
    t = np.linspace(0, 1, 50)
    long = np.linalg.norm(np.diff(np.stack([t, t**2, t**3], 1), axis=0), axis=1).sum()
    return approx([long, long], 1e-13)


def equal_steps_along_a_polyline() -> Wanted:
    at = np.linspace(0, 10, 6)
    return approx(
        [*np.interp(at, [0, 3, 7, 10], [0, 3, 3, 0]), *np.interp(at, [0, 3, 7, 10], [0, 0, 4, 4])],
        1e-14,
    )


def turning_about_an_axis() -> Wanted:
    return approx(
        Rotation.from_rotvec(0.7 * np.array([1, 1, 0]) / math.sqrt(2)).apply([1, 2, 3]), 1e-14
    )


def mirror_in_a_plane() -> Wanted:
    n, v = np.array([1, 2, 2]) / 3, np.array([3, -1, 4])
    return approx(v - 2 * (v @ n) * n, 1e-14)


def distance_of_skew_lines() -> Wanted:
    n = np.cross([1, 0, 0], [0, 1, 2])
    return approx([abs(np.dot([0, 3, -1], n)) / np.linalg.norm(n)], 1e-14)


def nearest_point_of_a_segment() -> Wanted:
    b = np.array([4, 1, 0])
    return approx([*(b * (np.array([2, 3, 1]) @ b / (b @ b))), 1, 0, 0], 1e-14)


def circle_through_three_points() -> Wanted:
    m = np.linalg.solve(2 * np.array([[-1, 2], [-2, -1]]), [4 - 1, 2 - 1])
    r = math.hypot(*(np.array([1, 0]) - m))
    return approx([*m, 0, r, r, r], 1e-13)


def centre_and_radius_of_a_fitted_circle() -> Wanted:
    return approx([3, -1, 2], 1e-10)


def volume_of_tetrahedra() -> Wanted:
    return approx([4], 1e-14)


def volume_of_a_closed_surface_by_its_facets() -> Wanted:
    a, b = np.meshgrid(np.linspace(0, 2 * np.pi, 25), np.linspace(0, np.pi, 13), indexing="ij")
    p = np.stack([2 * np.sin(b) * np.cos(a), 3 * np.sin(b) * np.sin(a), np.cos(b)], -1)
    t = lambda x, y, z: np.einsum("ijk,ijk->", x, np.cross(y, z)) / 6
    return approx(
        [t(p[:-1, :-1], p[:-1, 1:], p[1:, 1:]) + t(p[:-1, :-1], p[1:, 1:], p[1:, :-1])], 1e-12
    )


def area_of_a_graph_of_a_function() -> Wanted:
    x, y = np.meshgrid(np.linspace(0, 1, 21), np.linspace(0, 1, 21), indexing="ij")
    p = np.stack([x, y, x * y], -1)
    return approx(
        [
            np.linalg.norm(
                np.cross(p[1:, 1:] - p[:-1, :-1], p[:-1, 1:] - p[1:, :-1]), axis=-1
            ).sum()
            / 2
        ],
        1e-13,
    )


def normals_of_a_surface() -> Wanted:
    f = lambda i, j: np.array([-0.1 * j, -0.1 * i, 1]) / np.linalg.norm([0.1 * j, 0.1 * i, 1])
    return approx([*f(3, 2), *f(1, 4)], 1e-13)


def de_casteljau() -> Wanted:
    b = BPoly(np.array([(0, 0, 0), (1, 3, 0), (4, 3, 1), (5, 0, 2.0)])[:, None], [0, 1])
    return approx([*b(0.3), *b(0), *b(1)], 1e-14)


def de_boor() -> Wanted:
    b = BSpline(
        [0, 0, 0, 0, 0.5, 1, 1, 1, 1],
        np.array([(0, 0, 0), (1, 2, 0), (3, 2, 0), (4, 0, 0), (6, 1, 0.0)]),
        3,
    )
    return approx([*b(0.25), *b(0.7)], 1e-13)


def natural_cubic_spline_by_its_moments() -> Wanted:
    s = CubicSpline([0, 1, 2.5, 3, 5], [1, 0, 2, 3, -1], bc_type="natural")
    return approx([*s([0, 1, 2.5, 3, 5], 2), s(1.8)], 1e-12)


def catmull_and_rom() -> Wanted:
    p = np.array([(0, 0, 0), (1, 2, 0), (3, 1, 0), (4, 4, 1.0)])
    return approx(
        CubicHermiteSpline([0, 1], p[1:3], [(p[2] - p[0]) / 2, (p[3] - p[1]) / 2])(0.4), 1e-14
    )


def hermite_cubic() -> Wanted:
    return approx(
        CubicHermiteSpline([0, 1], [[0, 0, 0], [1, 1, 1]], [[1, 0, 2], [0, 3, 0]])(0.25), 1e-14
    )


def patch_of_coons() -> Wanted:
    u, v = np.meshgrid(np.linspace(0, 1, 6), np.linspace(0, 1, 5), indexing="ij")
    z = (1 - v) * u * (1 - u) + v * 0.5 * u + u * 0.5 * v - 0.5 * u * v
    return approx([*z[2], *z[:, 2]], 1e-14)


def surface_of_revolution() -> Wanted:
    a = np.pi / 4 * np.arange(9)
    return approx([*np.cos(a), 0, 1.5, 1, 0, -1, 2], 1e-14)


def helix_with_curvature() -> Wanted:
    t = np.array([4.95, 5, 5.05])
    p = np.stack([2 * np.cos(t), 2 * np.sin(t), 0.5 * t], 1)
    a, b = (p[2] - p[0]) / 0.1, (p[2] - 2 * p[1] + p[0]) / 0.05**2
    return approx([np.linalg.norm(np.cross(a, b)) / np.linalg.norm(a) ** 3], 1e-9)


def frenet_frame_of_a_space_curve() -> Wanted:
    d, dd = np.array([1, 1, 0.75]), np.array([0, 2, 3])
    b = np.cross(d, dd)
    return approx(np.cross(b, d) / np.linalg.norm(b) / np.linalg.norm(d), 2e-6)


def evolute_of_a_parabola() -> Wanted:
    t = np.linspace(-1, 1, 5)
    return [*(-4 * t**3), *(3 * t**2 + 0.5)]


def thickness_of_a_four_digit_section() -> Wanted:
    x = (1 - np.cos(np.pi * np.linspace(0, 1, 7))) / 2
    y = 0.6 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    return approx([*y, x[y.argmax()]], 1e-14)


def joukowski_s_section() -> Wanted:
    z = -0.1 + 0.1j + 1.1 * np.exp(2j * np.pi * np.arange(9) / 8)
    w = z + 1 / z
    return approx([*w.real, *w.imag], 1e-13)


def lift_of_vortices_on_a_plate() -> Wanted:
    return approx([2 * np.pi * math.sin(0.1)], 1e-12)


def stations_of_a_hull_and_simpson_s_volume() -> Wanted:
    x = np.linspace(0, 10, 11)
    return approx([simpson(2 * (1 - ((x - 5) / 5) ** 2) * 2, x=x)], 1e-13)


def beam_with_a_load() -> Wanted:
    x = 0.6
    return approx(
        [5 * 5 * 16 / 38400, 5 * 5 * 16 / 38400, 5 * x / 2400 * (8 - 4 * x * x + x**3)], 1e-13
    )


def catenary_through_two_pegs() -> Wanted:
    a = brentq(lambda a: 2 * a * math.sinh(1 / a) - 3, 0.1, 10, xtol=1e-15)
    return approx([a, a * math.cosh(1 / a) - a], 1e-12)


def involute_of_a_gear() -> Wanted:
    t = 0.2 * np.arange(6)
    return approx(2 * np.sqrt(1 + t * t), 1e-14)


def great_circle() -> Wanted:
    p, q = math.radians(52.5), math.radians(35.7)
    d = math.radians(139.7 - 13.4)
    return approx(
        [6371 * math.acos(math.sin(p) * math.sin(q) + math.cos(p) * math.cos(q) * math.cos(d))],
        1e-11,
    )


def barycentric_coordinates() -> Wanted:
    return approx(np.linalg.solve([[0, 4, 1], [0, 0, 3], [1, 1, 1]], [1.5, 1, 1]), 1e-14)


def crossing_of_two_segments() -> Wanted:
    t, _ = np.linalg.solve([[4, -5], [4, 3]], [0, 3])
    return approx([4 * t, 4 * t, 0], 1e-14)


def polygon_clipped_by_a_line() -> Wanted:
    return [5, 0, 4, 4, 1, 0, 0, 0, 1, 4, 4]


def corner_cut_by_chaikin() -> Wanted:
    c = np.array([(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0.0)])
    for _ in range(2):
        n = np.roll(c, -1, 0)
        c = np.stack([0.75 * c + 0.25 * n, 0.25 * c + 0.75 * n], 1).reshape(-1, 3)
    return approx([16, *c[2], *c[15]], 1e-14)


def koch_s_curve_grows() -> Wanted:
    return approx([65, (4 / 3) ** 3, math.sqrt(3) / 6], 1e-12)


def dragon_of_turns() -> Wanted:
    p, d = [0j], 1
    for k in range(1, 257):
        p.append(p[-1] + d)
        d *= 1j if (k // (k & -k)) % 4 == 1 else -1j
    return [p[256].real, p[256].imag, 0, p[128].real, p[128].imag, 0]


def points_of_the_golden_angle() -> Wanted:
    k = np.arange(1, 101)
    g = np.pi * (3 - math.sqrt(5))
    return approx(
        [(np.sqrt(k / 100) * np.cos(g * k)).mean(), (np.sqrt(k / 100) * np.sin(g * k)).mean(), 1],
        1e-12,
    )


def nearest_neighbours() -> Wanted:
    k = np.arange(1, 13)
    p = np.stack([7 * k % 13, 5 * k * k % 11, 3 * k % 7], 1).astype(float)
    d = np.linalg.norm(p[:, None] - p[None], axis=-1)
    np.fill_diagonal(d, 9e9)
    return d.argmin(1) + 1


def two_clusters_of_k_means() -> Wanted:
    return approx([1 / 3, 1 / 3, 0, 25 / 3, 25 / 3, 0], 1e-13)


def inertia_of_points() -> Wanted:
    p = np.array([(1, 0, 0), (0, 2, 0), (0, 0, 3), (1, 1, 1)])
    return sum((v @ v) * np.eye(3) - np.outer(v, v) for v in p).ravel()


def gram_and_schmidt() -> Wanted:
    q, r = np.linalg.qr(np.array([(1, 1, 0), (1, 0, 1), (0, 1, 1.0)]).T)
    return approx((q * np.sign(np.diag(r))).T.ravel(), 1e-14)


def plane_through_points_by_least_squares() -> Wanted:
    x, y = np.tile([0, 1, 2], 3), np.repeat([0, 1, 2], 3)
    z = [1, 3.1, 5, 0, 2, 3.9, -1, 1.1, 3]
    return approx(np.linalg.lstsq(np.stack([x, y, np.ones(9)], 1), z, rcond=None)[0][:2], 1e-12)


def shadow_on_a_plane() -> Wanted:
    e, p = np.array([3, -5, 8]), np.array([1, 2, 3])
    return approx(e + (p - e) * 8 / 5, 1e-14)


def ray_and_sphere() -> Wanted:
    p = np.array([-math.sqrt(4 - 0.29), 0.5, 0.2])
    n, d = p / 2, np.array([1, 0, 0])
    return approx([*p, *(d - 2 * (d @ n) * n)], 1e-13)


def law_of_refraction() -> Wanted:
    s = math.sin(0.5) / 1.33
    return approx([s, -math.sqrt(1 - s * s), 0, 1], 1e-14)


def product_of_quaternions() -> Wanted:
    a, b = np.array([1, 2, 3, 4.0]), np.array([2, -1, 0.5, 3])
    q = (Rotation.from_quat(np.roll(a, -1)) * Rotation.from_quat(np.roll(b, -1))).as_quat(
        canonical=False
    )
    c = np.roll(q, 1) * np.linalg.norm(a) * np.linalg.norm(b)
    return approx(c * np.sign(c[0] * (2 + 2 - 1.5 - 12)), 1e-12)


def angles_of_euler_from_a_matrix() -> Wanted:
    return approx([0.3, -0.4, 1.1], 1e-14)


def from_spherical_coordinates_and_back() -> Wanted:
    return approx([3, math.acos(2 / 3), math.atan2(-2, 1), 1, -2, 2], 1e-14)


def arm_with_two_links() -> Wanted:
    return approx([1.2, 0.9], 1e-14)


def crank_and_slider() -> Wanted:
    return approx([1, math.sqrt(4 - 0.25)], 1e-14)


def cam_with_a_smooth_rise() -> Wanted:
    u = np.linspace(0, 1, 5)
    return approx(10 * u**3 - 15 * u**4 + 6 * u**5, 1e-14)


def contour_through_cells() -> Wanted:
    f = np.array([[(i - 2.4) ** 2 + (j - 2.6) ** 2 - 1 for j in range(1, 5)] for i in range(1, 5)])
    i, j = np.nonzero(f[:-1] * f[1:] < 0)
    x = i + 1 + f[i, j] / (f[i, j] - f[i + 1, j])
    return approx([len(i), x.sum(), (j + 1).sum()], 1e-13)


def bilinear_look_up() -> Wanted:
    g = RegularGridInterpolator(
        (np.arange(1, 4), np.arange(1, 5)),
        [[i * i + 3 * j for j in range(1, 5)] for i in range(1, 4)],
    )
    return approx(g([(1.5, 2.25), (3, 4), (2, 1)]), 1e-14)


def grid_that_is_transposed_and_turned() -> Wanted:
    a = np.arange(1, 7).reshape(2, 3)
    return [*a.T[0], *a.T[2], *np.rot90(a)[0], *np.rot90(a)[2]]


def outer_product_and_trace() -> Wanted:
    m = np.outer([1, 2, 3], [4, -1, 0.5])
    return [*m[2], np.trace(m), 3.5]


def masks_that_choose_and_replace() -> Wanted:
    a = np.array([3, -1, 4, -1, 5, -9, 2, 6])
    return [*np.where(a < 0, 0, a), *np.minimum(a, 4), 3, *(np.flatnonzero(a >= 4) + 1)]


def sums_along_the_axes_of_a_grid() -> Wanted:
    g = np.array([[10 * i + j for j in range(1, 5)] for i in range(1, 4)])
    return [*g.sum(0), *g.mean(1), *g.max(0), g.sum(), 21]


def normalised_columns() -> Wanted:
    g = np.array([(1, 4), (2, 4), (6, 8)]) / [9, 16]
    return approx([*g[0], *g[2], 1, 1], 1e-15)


def filter_of_a_picture() -> Wanted:
    p = np.zeros((5, 5))
    p[1:4, 1:4] = 1
    p[2, 2] = 9
    q = np.zeros((5, 5))
    q[1:4, 1:4] = uniform_filter(p, 3)[1:4, 1:4]
    return approx([*q[1], *q[2]], 1e-14)


def edges_by_differences() -> Wanted:
    return [0, 0, 5, 0, 0, 3]


def ranks_of_numbers() -> Wanted:
    return rankdata([10, 30, 20, 40, 5])


def runs_in_a_row() -> Wanted:
    return [4, 4]


def values_that_are_different() -> Wanted:
    return np.unique([3, 1, 2, 3, 1, 5, 2])


def cumulative_product_and_decay() -> Wanted:
    a = np.linspace(0.9, 0.5, 5)
    return approx([*np.cumprod(a), *np.cumsum(a)], 1e-14)


def trapezoids_over_uneven_steps() -> Wanted:
    x = np.array([0, 0.1, 0.4, 0.9, 1.6, 2.5])
    return approx([np.trapezoid(np.exp(-x), x)], 1e-14)


def slopes_by_central_differences() -> Wanted:
    x = np.linspace(0, 2, 9)
    return approx(np.gradient(x**3, x), 1e-13)


def where_a_signal_crosses_zero() -> Wanted:
    t = np.linspace(0, 10, 101)
    y = np.sin(t) - 0.2
    k = np.flatnonzero(y[:-1] * y[1:] < 0)
    return approx([*(k + 1), *(t[k] - y[k] * (t[k + 1] - t[k]) / (y[k + 1] - y[k]))], 1e-13)


def peaks_of_a_row() -> Wanted:
    k = find_peaks([1, 3, 2, 5, 4, 4, 6, 1, 7, 2])[0]
    return [*(k + 1), 3, 5, 6, 7]


def smoothing_by_an_exponential_mean() -> Wanted:
    a = np.array([5, 7, 6, 9, 12, 8.0])
    return approx(lfilter([0.3], [1, -0.7], a, zi=[0.7 * 5])[0], 1e-14)


def response_of_a_filter_with_two_poles() -> Wanted:
    return approx(lfilter([1], [1, -0.8, 0.5], np.eye(12)[0]), 1e-14)


def every_second_and_backwards() -> Wanted:
    a = np.arange(1, 11)
    return [*a[::3], *a[::-1], 10, 6, 2, 3, 2, 1, 4]


def positions_that_repeat() -> Wanted:
    return [30, 10, 10, 20, 60, 15, 20, 35]


def diagonals_of_a_grid() -> Wanted:
    m = np.array([[i * i + j for j in range(1, 5)] for i in range(1, 5)])
    return [np.trace(m), np.trace(m[:, ::-1])]


def texts_that_are_joined() -> Wanted:
    return ["one;two;three; 1 1"]


def numbers_as_roman_numerals() -> Wanted:
    return ["MCMXCIV MMXXVI XLIX"]


def numbers_that_are_formatted() -> Wanted:
    return [f"{math.pi:5.2f}", "3 of 7", f"{1e-7:g} {12345.678:e}"]


def fizz_and_buzz() -> Wanted:
    return [
        "".join(
            ("fizz" * (k % 3 == 0) + "buzz" * (k % 5 == 0) or str(k)) + " " for k in range(1, 16)
        )
    ]


def hexadecimal_by_a_table_of_texts() -> Wanted:
    return ["beef"]


def routine_as_an_argument() -> Wanted:
    return approx([9, 2], 3e-6)


def functions_that_call_each_other() -> Wanted:
    return [1, 0, 0]


def results_through_arguments() -> Wanted:
    return approx([5, math.atan2(4, -3), 0, 5], 1e-15)


def a_section_written_by_a_routine() -> Wanted:
    return [0, 11, 0, 12, 0, 13, 0, 14, 0, 0, 1, 0, 0, 3, 0]


def counter_that_is_global() -> Wanted:
    return [12, 4]


def values_are_copied() -> Wanted:
    return [1, 2, 3, 4, 9, 2, 3, 4, 1, 4]


def conditions_that_are_not_evaluated() -> Wanted:
    return [0, 1, 1, 5]


def loops_that_go_down_by_fractions_and_not_at_all() -> Wanted:
    return [10 + 7 + 4 + 1, 11]


def breaks_and_continues() -> Wanted:
    return [1 + 6 + 15 + 28, 7]


def layers_of_a_block() -> Wanted:
    return [2, 6, 3, 3 * (2 + 4 + 6 + 8), 3, 3, 3, 3, 3, 4, 2]


def bezier_surface_of_nine_points() -> Wanted:
    b = lambda t: np.array([(1 - t) ** 2, 2 * t * (1 - t), t * t])
    p = np.array([[(i, j, i * j % 4) for j in range(1, 4)] for i in range(1, 4)], float)
    return approx([*np.einsum("i,j,ijk", b(0.5), b(0.25), p), 3, 1, 3], 1e-14)


def swept_section_that_turns() -> Wanted:
    return approx([-math.sin(0.9), math.cos(0.9), 2, -math.cos(1.5), -math.sin(1.5), 3], 1e-14)


def mean_plane_and_sides_of_points() -> Wanted:
    p = np.array([(1, 1, 2), (2, 0, -1), (0, 3, 0), (-1, -1, 1)])
    return [*p.mean(0), *np.sign((p - p.mean(0)).sum(1))]


def growth_of_layers() -> Wanted:
    y = 0.01 * (1.3**8 - 1) / 0.3
    return approx([y, y, 1.3], 1e-13)


def clustering_by_a_tangent() -> Wanted:
    y = 1 + np.tanh(2 * (np.linspace(0, 1, 6) - 1)) / math.tanh(2)
    return approx([*y, *np.diff(y)], 1e-14)


def spline_of_the_library_through_points() -> Wanted:
    s = CubicSpline(
        np.arange(5) / 4, [(0, 0, 0), (1, 2, 0), (3, 3, 1), (4, 1, 2), (6, 0, 0)], bc_type="natural"
    )
    return approx([*s(0.125), *s(0.6)], 1e-12)


def spline_without_knots_by_chord_length() -> Wanted:
    p = np.array([(0, 0, 0), (1, 2, 0), (3, 3, 1), (4, 1, 2), (6, 0, 0)])
    t = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1))])
    return approx(CubicSpline(t / t[-1], p)(0.3), 1e-12)


def arc_of_the_library() -> Wanted:
    t = np.linspace(0, np.pi / 2, 7)
    return approx([*(3 * np.cos(t)), *(3 * np.sin(t)), 9], 1e-15)


def line_of_the_library_with_given_fractions() -> Wanted:
    return approx([1.3, 1.6, 0.3, 2.2, 3.4, 1.2], 1e-15)


def section_of_the_library_by_its_formula() -> Wanted:
    x = (1 + math.cos(0.7 * math.pi)) / 2
    y = 0.6 * (0.2969 * math.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    return approx([1, 1, x, y, 0, 21], 1e-14)


def steps_between_two_given_ends() -> Wanted:
    r = brentq(lambda r: 0.1 * (r**20 - 1) / (r - 1) - 10, 1.01, 3, xtol=1e-15)
    return approx([10, 0.1, 1, r], 1e-9)


def transfinite_interpolation_of_straight_edges() -> Wanted:
    return approx([3, 1, 1 / 3, 2, 2, 2 / 3], 1e-14)


def laplace_s_grid_between_two_circles() -> Wanted:
    return [1, 1]


def curve_of_intersection_by_bisection_along_lines() -> Wanted:
    k = 0.3 * np.arange(1, 6)
    return approx(np.sqrt(4 * 1.04 / (1.04 + np.cos(k) * np.sin(k))), 1e-13)


def bodies_that_fall_with_drag() -> Wanted:
    v, y, t = 0.0, 100.0, 0.0
    while y > 0:
        v += 0.001 * (9.81 - 0.02 * v * v)
        y -= 0.001 * v
        t += 0.001
    return approx([t, v], 1e-12)


def tank_that_is_emptied() -> Wanted:
    h, t = 2.0, 0
    while h > 1e-3 and t < 1e5:
        h, t = max(h - 0.01 * math.sqrt(2 * 9.81 * h), 0), t + 1
    return [t]


def forces_in_a_frame_of_two_bars() -> Wanted:
    u, v = np.array([-2, -1]) / math.sqrt(5), np.array([-2, 2]) / math.sqrt(8)
    return approx(np.linalg.solve(np.stack([u, v], 1), [0, 10]), 1e-13)


def three_springs_and_their_frequencies() -> Wanted:
    return approx(np.sqrt(np.linalg.eigvalsh([[2, -1], [-1, 2]])), 1e-14)


def orbit_s_elements_from_place_and_speed() -> Wanted:
    r, v, mu = np.array([7000, 1000, 500.0]), np.array([-0.5, 7.2, 1.5]), 398600.4418
    h = np.cross(r, v)
    e = np.cross(v, h) / mu - r / np.linalg.norm(r)
    return approx(
        [
            1 / (2 / np.linalg.norm(r) - v @ v / mu),
            np.linalg.norm(e),
            math.acos(h[2] / np.linalg.norm(h)),
        ],
        1e-12,
    )


def tides_as_a_sum_of_cosines() -> Wanted:
    t = np.linspace(0, 24, 25)
    h = 1.2 * np.cos(2 * np.pi * t / 12.42) + 0.4 * np.cos(2 * np.pi * t / 12 + 0.5) + 0.1
    return approx([h.max(), *t[argrelmax(h)[0]]], 1e-13)
