//! Every option of curves on random data: its derivatives are those of differences, or are refused as not known.

use crate::entity::call;
use moldloft_num::{Dual4, Order, Real, Vec3};
use moldloft_registry::{CallError, CurveRef, Scalar, Value};
use moldloft_testing::Random;

/// An option with numbers, one of which may be a parameter.
#[derive(Clone, Debug)]
enum Given {
    Text(&'static str),
    Texts(Vec<&'static str>),
    Number(f64),
    Numbers(Vec<f64>),
    Vectors(Vec<Vec3<f64>>),
    Vector(Vec3<f64>),
}

impl Given {
    /// The value with its number `at` seeded by `seed`.
    fn value<T: Real>(&self, at: Option<usize>, seed: impl Fn(f64) -> T) -> Value<T> {
        let one = |k: usize, x: f64| if at == Some(k) { seed(x) } else { T::from(x) };
        let vector = |k: usize, p: &Vec3<f64>| {
            Value::Vector(Vec3::new(T::from(p.x), one(k, p.y), T::from(p.z)))
        };
        match self {
            Given::Text(word) => Value::text(word),
            Given::Texts(words) => Value::list(words.iter().map(|word| Value::text(word))),
            Given::Number(x) => Value::Number(one(0, *x)),
            Given::Numbers(all) => {
                Value::list(all.iter().enumerate().map(|(k, &x)| Value::Number(one(k, x))))
            }
            Given::Vectors(all) => Value::list(all.iter().enumerate().map(|(k, p)| vector(k, p))),
            Given::Vector(p) => vector(0, p),
        }
    }

    fn numbers(&self) -> usize {
        match self {
            Given::Text(_) | Given::Texts(_) => 0,
            Given::Number(_) | Given::Vector(_) => 1,
            Given::Numbers(all) => all.len(),
            Given::Vectors(all) => all.len(),
        }
    }
}

struct Case {
    points: Vec<Vec3<f64>>,
    tolerance: f64,
    options: Vec<(&'static str, Given)>,
    /// The point that moves, the option with a parameter among its numbers, and the index of that
    /// number.
    moving: usize,
    seeded: Option<(usize, usize)>,
}

impl Case {
    fn made<T: Scalar>(
        &self,
        points: &[Vec3<T>],
        tolerance: T,
        seed: impl Fn(f64) -> T,
    ) -> Result<CurveRef<T>, CallError> {
        let list = Value::list(points.iter().map(|&p| Value::Vector(p)));
        let named = self.options.iter().enumerate().map(|(k, (name, given))| {
            let at = self.seeded.filter(|s| s.0 == k).map(|s| s.1);
            (*name, given.value(at, &seed))
        });
        match call("FairCurve", vec![list, Value::Number(tolerance)], named.collect())? {
            Value::Curve(curve) => Ok(curve),
            other => panic!("{other:?}"),
        }
    }

    /// The curve with the point, the tolerance or the number of an option moved.
    fn moved(&self, direction: usize, by: f64) -> Result<CurveRef<f64>, CallError> {
        let mut points = self.points.clone();
        let mut tolerance = self.tolerance;
        match direction {
            0 => points[self.moving].y += by,
            1 => points[self.moving].z += by,
            2 => tolerance += by,
            _ => {}
        }
        self.made(&points, tolerance, |x| if direction == 3 { x + by } else { x })
    }
}

fn picked<T: Clone>(g: &mut Random, of: &[T]) -> T {
    g.pick(of).clone()
}

fn options(g: &mut Random, n: usize) -> Vec<(&'static str, Given)> {
    let mut out: Vec<(&'static str, Given)> = Vec::new();
    let measures = ["second", "third", "bending", "variation", "jumps"];
    out.push(("measure", Given::Text(picked(g, &measures))));
    let wanted = 1 + g.below(3);
    for _ in 0..wanted {
        let each = |g: &mut Random, scale: f64| {
            (0..n).map(|_| scale * (0.6 + 0.8 * g.unit())).collect::<Vec<f64>>()
        };
        let rising = |count: usize| (0..count).map(move |k| k as f64 / (count - 1) as f64);
        match g.below(27) {
            0 => out.push(("as", Given::Text(picked(g, &["fit", "control", "points"])))),
            1 => out.push((
                "ends",
                Given::Text(picked(g, &["free", "position", "tangent", "curvature"])),
            )),
            2 => out.push((
                "last_end",
                Given::Text(picked(g, &["free", "position", "tangent", "curvature"])),
            )),
            3 => {
                let modes = ["faithful", "literal", "vertex", "sweeps", "levels"];
                out.push(("mode", Given::Text(picked(g, &modes))));
            }
            4 => out.push(("degree", Given::Number(picked(g, &[3.0, 4.0, 5.0])))),
            5 => out.push(("closed", Given::Number(1.0))),
            6 => out.push(("breaks", Given::Numbers(vec![(2 + g.below(n - 3)) as f64]))),
            7 => {
                let all = ["chord", "centripetal", "x", "index", "curvature"];
                out.push(("spacing", Given::Text(picked(g, &all))));
            }
            8 => {
                let goals = ["budget", "fairest", "nearest", "closest", "near"];
                out.push(("goal", Given::Text(picked(g, &goals))));
            }
            9 => out.push(("share", Given::Number(0.2 + 0.6 * g.unit()))),
            10 => out.push(("along", Given::Vector(Vec3::of(0.0, 1.0, 0.1 * g.unit())))),
            11 => {
                out.push(("along", Given::Vector(Vec3::of(1.0, 0.1, 0.0))));
                out.push(("motion", Given::Text("across")));
            }
            12 => out.push(("motion", Given::Text("box"))),
            13 => {
                let shapes = ["concave", "one-way", "within=0,1:0.051", "straight=1-4"];
                out.push(("shape", Given::Texts(vec![picked(g, &shapes)])));
            }
            14 => out.push(("tolerances", Given::Numbers(each(g, 8e-4)))),
            15 => out.push(("fixed", Given::Numbers(vec![(1 + g.below(n)) as f64]))),
            16 => out.push(("release", Given::Numbers(vec![(2 + g.below(n - 2)) as f64]))),
            17 => {
                let p = Vec3::of(0.5, 0.05, 0.025);
                out.push(("through", Given::Vectors(vec![p])));
                out.push(("through_at", Given::Numbers(vec![0.5])));
            }
            18 => {
                out.push(("tangents", Given::Vectors(vec![Vec3::of(1.0, 0.02 * g.unit(), 0.1)])));
                out.push(("tangents_at", Given::Numbers(vec![0.5])));
            }
            19 => {
                out.push(("keep", Given::Texts(vec![picked(g, &["area", "volume", "centroid"])])))
            }
            20 => out.push(("bends", Given::Number(1.0))),
            21 => {
                let wave = |t: f64| t + 0.03 * (3.0 * t).sin() * (1.0 - t);
                out.push(("at", Given::Numbers(rising(n).map(wave).collect())));
            }
            22 => out.push(("bound", Given::Text(picked(g, &["data", "curve", "points"])))),
            23 => out.push(("count", Given::Number((n - 3 - g.below(n / 2 - 2)) as f64))),
            24 => {
                out.push(("as", Given::Text("control")));
                out.push(("weights", Given::Numbers(each(g, 1.0))));
            }
            25 => {
                let inner = rising(n - 2).map(|t| t * (0.7 + 0.3 * t));
                let all = [0.0; 3].into_iter().chain(inner).chain([1.0; 3]);
                out.push(("knots", Given::Numbers(all.collect())));
            }
            _ => {
                let steps = (1 + g.below(3 * n)) as f64;
                out.push(("mode", Given::Text(picked(g, &["faithful", "vertex"]))));
                out.push(("steps", Given::Number(steps)));
            }
        }
    }
    // The last of a name counts.
    let mut kept: Vec<(&'static str, Given)> = Vec::new();
    for (name, given) in out.into_iter().rev() {
        if kept.iter().all(|(other, _)| *other != name) {
            kept.push((name, given));
        }
    }
    kept
}

fn case(g: &mut Random) -> Case {
    let n = 14 + g.below(14);
    let mut t = 0.0;
    let points: Vec<Vec3<f64>> = (0..n)
        .map(|_| {
            let here = t;
            t += (0.4 + 1.2 * g.unit()) / n as f64;
            let y = 0.2 * here * (1.0 - here) + 1e-3 * (g.unit() - 0.5) * 2.0;
            Vec3::of(here, y, 0.1 * here * here + 1e-3 * (g.unit() - 0.5) * 2.0)
        })
        .collect();
    let options = options(g, n);
    let free: Vec<(usize, usize)> = (0..options.len())
        .filter(|&k| {
            !["degree", "closed", "breaks", "fixed", "release", "bends", "count", "steps"]
                .contains(&options[k].0)
        })
        .flat_map(|k| (0..options[k].1.numbers()).map(move |i| (k, i)))
        .collect();
    let seeded = if free.is_empty() { None } else { Some(picked(g, &free)) };
    Case { tolerance: 8e-4, moving: 1 + g.below(n - 2), points, options, seeded }
}

/// Counts over all directions of a case.
#[derive(Debug, Default)]
struct Count {
    refused: usize,
    unknown: usize,
    equal: usize,
    kinks: usize,
    unclear: usize,
}

#[test]
fn derivatives_by_every_option() {
    let cases = if std::env::var_os("MOLDLOFT_SOAK").is_some() { 3000 } else { 260 };
    let mut g = Random::new(2611);
    let mut count = Count::default();
    let mut wrong = Vec::new();
    for number in 0..cases {
        let case = case(&mut g);
        let told = std::panic::AssertUnwindSafe(|| case.moved(9, 0.0));
        let base = std::panic::catch_unwind(told)
            .unwrap_or_else(|_| panic!("{number} {:?} {:?}", case.options, case.points));
        let Ok(base) = base else {
            count.refused += 1;
            continue;
        };
        // One parameter at a time, as one that is not known hides the others.
        for direction in 0..4 {
            if direction == 3 && case.seeded.is_none() {
                continue;
            }
            let of = |x: f64, own: usize| {
                if direction == own { Dual4::seeded(x, own) } else { Dual4::from(x) }
            };
            let mut points: Vec<Vec3<Dual4>> =
                case.points.iter().map(|&p| Vec3::lifted(p)).collect();
            let p = case.points[case.moving];
            points[case.moving] = Vec3::new(Dual4::from(p.x), of(p.y, 0), of(p.z, 1));
            let dual = match case.made(&points, of(case.tolerance, 2), |x| of(x, 3)) {
                Ok(dual) => dual,
                Err(fault) => {
                    assert_eq!(fault.id, "no-derivative", "{:?}: {fault:?}", case.options);
                    count.unknown += 1;
                    continue;
                }
            };
            for t in [0.21, 0.5, 0.83] {
                let exact = dual.jet(Dual4::from(t), Order::Zero)[0];
                let here = base.jet(t, Order::Zero)[0];
                assert!(exact.re().bits_eq(here), "{:?}", case.options);
                let got = exact.map(|x| x.eps[direction]);
                let at = |by: f64| {
                    case.moved(direction, by).ok().map(|curve| curve.jet(t, Order::Zero)[0])
                };
                let both = |h: f64| Some((at(-h)?, at(h)?));
                let h = 1e-6;
                let (Some((a, b)), Some((c, d))) = (both(h), both(3.0 * h)) else {
                    count.unclear += 1;
                    continue;
                };
                let near = |v: Vec3<f64>, band: f64| (got - v).norm() < band * (v.norm() + 0.1);
                let (centred, wide) = ((b - a) * (0.5 / h), (d - c) * (0.5 / (3.0 * h)));
                let sides = [(here - a) * (1.0 / h), (b - here) * (1.0 / h)];
                let smooth = (centred - wide).norm() < 2e-3 * (centred.norm() + 0.1)
                    && (sides[0] - sides[1]).norm() < 1e-2 * (centred.norm() + 0.1);
                if smooth && near(centred, 1e-2) {
                    count.equal += 1;
                } else if sides.iter().any(|&s| near(s, 2e-2)) {
                    count.kinks += 1;
                } else if smooth {
                    let options: Vec<_> = case
                        .options
                        .iter()
                        .map(|(name, given)| format!("{name} = {given:?}"))
                        .collect();
                    wrong.push(format!(
                        "{number} {direction} {t} {:?}: {got:?} {centred:?} {}",
                        case.seeded.map(|s| case.options[s.0].0),
                        options.join(", ")
                    ));
                } else {
                    count.unclear += 1;
                }
            }
        }
    }
    eprintln!("{count:?}");
    let clear = count.equal + count.kinks;
    assert!(wrong.is_empty(), "{} of {clear}\n{}", wrong.len(), wrong.join("\n"));
    assert!(count.equal > cases && count.unknown > cases / 10, "{count:?}");
    assert!(20 * count.unclear < clear, "{count:?}");
}
