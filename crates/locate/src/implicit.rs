//! Unknowns that are given by equations: solved in plain numbers, differentiated exactly by the
//! implicit function theorem.

use moldloft_num::{Jet, Order, Real, Uni1, Uni2, solve_dense};

/// N equations F(q, t) = 0 for N unknowns q that depend on one parameter t.
///
/// An equation in plain numbers that has no parameter ignores `t`.
pub trait Implicit<T: Real, const N: usize> {
    /// The left sides at unknowns and parameter that are jets.
    fn at<J: Jet<T>>(&self, q: [J; N], t: J) -> [J; N];

    /// Their derivatives by the unknowns: `[equation][unknown]`.
    fn jacobian(&self, q: [T; N], t: T) -> [[T; N]; N];
}

/// Solves the N by N system in place by elimination with partial pivoting; `None` when singular.
pub fn solve<T: Real, const N: usize>(a: &[[T; N]; N], b: [T; N]) -> Option<[T; N]> {
    if N == 1 {
        let mut x = b;
        x[0] = b[0] / a[0][0];
        return (a[0][0].re() != 0.0).then_some(x);
    }
    if N == 2 {
        let det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
        if det.re() == 0.0 {
            return None;
        }
        let mut x = b;
        x[0] = (b[0] * a[1][1] - a[0][1] * b[1]) / det;
        x[1] = (a[0][0] * b[1] - b[0] * a[1][0]) / det;
        return Some(x);
    }
    let mut x = b;
    // No more than six unknowns occur.
    let mut flat = [T::zero(); 36];
    for (r, row) in a.iter().enumerate() {
        flat[r * N..(r + 1) * N].copy_from_slice(row);
    }
    solve_dense(&mut flat[..N * N], &mut x).ok()?;
    Some(x)
}

/// The unknowns with their derivatives in T, from the converged plain solution: one Newton step in
/// T without its real part.
pub fn refined<T: Real, const N: usize, F: Implicit<T, N>>(
    f: &F,
    q: [f64; N],
    t: T,
) -> Option<[T; N]> {
    let plain = q.map(T::from);
    if T::PARTS == 1 {
        return Some(plain);
    }
    let rest = f.at::<T>(plain, t).map(|r| r - r.re());
    if rest.iter().all(|r| r.is_constant()) {
        return Some(plain);
    }
    let jacobian = f.jacobian(plain, T::from(t.re())).map(|row| row.map(|x| T::from(x.re())));
    let step = solve(&jacobian, rest)?;
    Some(std::array::from_fn(|k| plain[k] - step[k]))
}

/// The unknowns as functions of t, with derivatives to `order`: `[derivative][unknown]`.
///
/// With q = q0 + q1 s + q2 s^2 / 2, the equations of order s and s^2 are linear in q1 and q2, and
/// their constant terms are F at the lower terms.
pub fn jets<T: Real, const N: usize, F: Implicit<T, N>>(
    f: &F,
    q: [f64; N],
    t: T,
    order: Order,
) -> Option<[[T; N]; 3]> {
    let q0 = refined(f, q, t)?;
    let mut out = [q0, [T::zero(); N], [T::zero(); N]];
    if order == Order::Zero {
        return Some(out);
    }
    let jacobian = f.jacobian(q0, t);
    let rest = f.at(q0.map(Uni1::fixed), Uni1::parameter(t)).map(|r| -r.t);
    out[1] = solve(&jacobian, rest)?;
    if order == Order::Second {
        let path = std::array::from_fn(|k| Uni2 { f: q0[k], t: out[1][k], tt: T::zero() });
        let rest = f.at(path, Uni2::parameter(t)).map(|r| -r.tt);
        out[2] = solve(&jacobian, rest)?;
    }
    Some(out)
}
