//! Corners of the box round a snake in the parameter plane of its surface, and the points of the snake that face them:
//! where patches round an appendage meet.

use crate::arguments::Snake;
use moldloft_num::{Order, Real, find_root};
use moldloft_registry::{Build, CallError, Context, Kind, Point, Value};

/// A corner of the box round a snake: 1 is the low u and the low v, 2 the high u and the low v, 3 the high u and the high v, 4 the low u
/// and the high v.
///
/// The sides of the box are parameter lines of the surface. They keep a distance from the snake, in both directions the same in
/// space, and stay off the edges of the surface: the box is between the snake and the edges for every size of the snake. The snake is closed,
/// or begins and ends on one edge of the surface, which is then a side of the box.
#[derive(Kind)]
#[kind(
    class = Magnet,
    columns = "snake corner edge margin",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 0); AbsPoint D(4, 3, 1); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0.5, 0.5); AbsMagnet q(S, 0.6, 0.5); \
               AbsMagnet r(S, 0.5, 0.7); ConicSnake s(p, q, r); BoxMagnet c(s, 1); BoxMagnet d(s, 3); LineSnake diagonal(c, d);"
)]
pub struct BoxMagnet<T: Real> {
    /// The snake.
    snake: Snake<T>,
    /// The corner.
    #[field(min = 1, max = 4)]
    corner: usize,
    /// The edge of the surface on which the snake begins and ends: 1 is v = 0, 2 is u = 1, 3 is v = 1, 4 is u = 0. 0: it is closed.
    #[field(default = 0, max = 4)]
    edge: usize,
    /// Distance of the box from the snake, as a fraction of the snake's size.
    #[field(default = 0.5)]
    margin: T,
}

impl<T: Real> Build<T> for BoxMagnet<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { snake, corner, edge, margin } = self;
        let bounds = SnakeBox::of(&snake, edge, margin).map_err(|why| why.in_field(Self::SNAKE))?;
        let [u, v] = bounds.corner(corner - 1);
        Ok(Value::Point(Box::new(Point::on_surface(snake.surface, u, v))))
    }
}

/// The ring of a snake that faces a corner of the box round it: on the straight line of the parameter plane from the middle of the
/// snake to the corner.
///
/// The rings of the four corners divide the snake into the parts that face the sides of the box; side k is from corner k to the next.
/// The snake begins in one of these parts, and the rings keep a distance from its beginning.
#[derive(Kind)]
#[kind(
    class = Ring,
    columns = "snake corner edge margin side",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 0); AbsPoint D(4, 3, 1); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0.5, 0.5); AbsMagnet q(S, 0.6, 0.5); \
               AbsMagnet r(S, 0.5, 0.7); ConicSnake s(p, q, r); BoxMagnet c(s, 1); BoxRing t(s, 1); LineSnake spoke(t, c);"
)]
pub struct BoxRing<T: Real> {
    /// The snake.
    snake: Snake<T>,
    /// The corner.
    #[field(min = 1, max = 4)]
    corner: usize,
    /// The edge of the surface on which the snake begins and ends, as of the corner's magnet. 0: it is closed.
    #[field(default = 0, max = 4)]
    edge: usize,
    /// Distance of the box from the snake, as of the corner's magnet.
    #[field(default = 0.5)]
    margin: T,
    /// The side of the box that the beginning of a closed snake faces. 0: as it is at the values of the parameters.
    #[field(default = 0, max = 4)]
    side: usize,
}

impl<T: Real> Build<T> for BoxRing<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Self { snake, corner, edge, margin, side } = self;
        let bounds = SnakeBox::of(&snake, edge, margin).map_err(|why| why.in_field(Self::SNAKE))?;
        let facing = |corner: usize| {
            bounds.facing(&snake, corner).ok_or_else(|| {
                no_box("not every ray from the middle of the snake meets it")
                    .expected("a snake that the rays from its middle to the corners of its box meet")
                    .found(format!("none to corner {}", corner + 1))
                    .help("divide the surface by a `SubSurf` on either side of a long or bent appendage, and cut the parts")
                    .in_field(Self::SNAKE)
            })
        };
        let mut t = facing(corner - 1)?;
        if edge == 0 {
            // Counter-clockwise from the beginning.
            let run = |t: T| if bounds.clockwise { -t + 1.0 } else { t };
            let first = match side {
                0 => {
                    let mut first = (corner - 1, run(t).re());
                    for other in (0..4).filter(|other| *other != corner - 1) {
                        let at = run(facing(other)?).re();
                        if at < first.1 {
                            first = (other, at);
                        }
                    }
                    first.0
                }
                side => side % 4,
            };
            t = run(apart(run(t), (corner - 1 + 4 - first) % 4, side != 0));
        }
        Ok(Value::Point(Box::new(Point::on_curve(snake.curve, t))))
    }
}

/// Least distance of the rings from the beginning of a closed snake and from one another there, as a fraction of its length.
const APART: f64 = 0.02;

/// The parameter of the `k`th ring of four, counter-clockwise from the beginning of a closed snake, at that distance from the
/// beginning. A ring that is beyond the beginning, of a stated side, is brought back.
fn apart<T: Real>(t: T, k: usize, stated: bool) -> T {
    let turns = if stated { ((k as f64 + 0.5) / 4.0 - t.re()).round() } else { 0.0 };
    let t = t + turns;
    let [low, high] = [APART * (k + 1) as f64, 1.0 - APART * (4 - k) as f64];
    if t.re() < low {
        T::from(low)
    } else if t.re() > high {
        T::from(high)
    } else {
        t
    }
}

/// Number of points at which a snake is sampled.
const SAMPLES: usize = 64;

/// Least distance of a snake from an edge of the surface, in u or v.
const CLEAR: f64 = 1e-6;

/// Greatest distance in u or v between the ends of a closed snake, or of an end from an edge.
const MEETING: f64 = 1e-6;

fn no_box(text: &str) -> CallError {
    CallError::new("no-box", text)
}

/// The box round a snake in the parameter plane of its surface.
struct SnakeBox<T> {
    /// A point inside the snake.
    middle: [T; 2],
    low: [T; 2],
    high: [T; 2],
    clockwise: bool,
    /// Places of the snake at equal steps of its parameter, both ends included.
    samples: Vec<[T; 2]>,
}

impl<T: Real> SnakeBox<T> {
    fn of(snake: &Snake<T>, edge: usize, margin: T) -> Result<Self, CallError> {
        let place = |t: f64| {
            let w = snake.path(T::from(t), Order::Zero)[0];
            [w.x, w.y]
        };
        let samples: Vec<[T; 2]> =
            (0..=SAMPLES).map(|k| place(k as f64 / SAMPLES as f64)).collect();
        check_turns(&samples, snake.surface.closed())?;
        check_ends(&samples, edge)?;
        let count = SAMPLES as f64;
        let mut middle = [0, 1].map(|a| {
            samples[..SAMPLES].iter().fold(T::zero(), |sum, w| sum + w[a]) * (1.0 / count)
        });
        let on_edge = edge_line(edge);
        if let Some((a, at)) = on_edge {
            middle[a] = T::from(at);
        }
        let extreme = |a: usize, sign: f64| {
            let mut best = samples[0][a];
            for w in &samples[1..] {
                if w[a].re() * sign > best.re() * sign {
                    best = w[a];
                }
            }
            best
        };
        let [mut low, mut high] = [-1.0, 1.0].map(|sign| [0, 1].map(|a| extreme(a, sign)));
        let jet = snake.surface.jet(middle[0], middle[1], Order::First);
        let size = [0, 1].map(|a| high[a] - low[a]);
        let speed = [jet.u.norm(), jet.v.norm()];
        let wide = (size[0] * size[1] * speed[0] * speed[1]).sqrt();
        for a in 0..2 {
            let plain = size[a] * margin;
            let flat = speed[a].re() * size[a].re() <= 1e-9 * wide.re();
            let grow = if flat { plain } else { wide * margin / speed[a] };
            if !(grow.re() > 0.0 && grow.re().is_finite()) {
                return Err(no_box("the snake bounds no area of the parameter plane")
                    .expected("a closed snake round an area, and a positive margin")
                    .found(format!("a size of {} in u and {} in v", size[0].re(), size[1].re())));
            }
            for upper in [false, true] {
                let at = f64::from(u8::from(upper));
                if on_edge == Some((a, at)) {
                    *(if upper { &mut high[a] } else { &mut low[a] }) = T::from(at);
                    continue;
                }
                let room = if upper { -high[a] + 1.0 } else { low[a] };
                if room.re() <= CLEAR {
                    return Err(at_edge(a, at, room.re()));
                }
                // Between the snake and the middle of the gap to the edge.
                let step = T::one() / (T::one() / grow + T::from(2.0) / room);
                if upper {
                    high[a] += step;
                } else {
                    low[a] -= step;
                }
            }
        }
        let area: f64 = samples
            .windows(2)
            .map(|w| {
                let [p, q] = [0, 1].map(|k| [0, 1].map(|a| (w[k][a] - middle[a]).re()));
                p[0] * q[1] - p[1] * q[0]
            })
            .sum();
        Ok(Self { middle, low, high, clockwise: area < 0.0, samples })
    }

    fn corner(&self, k: usize) -> [T; 2] {
        [[self.low[0], self.high[0]][usize::from(k == 1 || k == 2)], {
            [self.low[1], self.high[1]][usize::from(k >= 2)]
        }]
    }

    /// The parameter of the farthest point of the snake on the ray from the middle to a corner.
    fn facing(&self, snake: &Snake<T>, corner: usize) -> Option<T> {
        let ray = {
            let q = self.corner(corner);
            [0, 1].map(|a| q[a] - self.middle[a])
        };
        let off = |w: [T; 2]| {
            let d = [0, 1].map(|a| w[a] - self.middle[a]);
            (d[0] * ray[1] - d[1] * ray[0], d[0] * ray[0] + d[1] * ray[1])
        };
        let mut best: Option<(usize, f64)> = None;
        for (k, pair) in self.samples.windows(2).enumerate() {
            let [(f, along), (g, _)] = [off(pair[0]), off(pair[1])];
            let (f, g, along) = (f.re(), g.re(), along.re());
            let crosses = (f < 0.0) != (g < 0.0);
            if crosses && along > 0.0 && best.is_none_or(|(_, far)| along > far) {
                best = Some((k, along));
            }
        }
        let (k, _) = best?;
        let step = 1.0 / SAMPLES as f64;
        let at = |t: T| {
            let [w, d, _] = snake.path(t, Order::First);
            (off([w.x, w.y]).0, d.x * ray[1] - d.y * ray[0])
        };
        let t =
            find_root(|t| at(T::from(t)).0.re(), k as f64 * step, (k + 1) as f64 * step).ok()?;
        let (level, slope) = at(T::from(t));
        let slope = slope.re();
        let rate = if slope == 0.0 { T::zero() } else { (level - level.re()) * (1.0 / slope) };
        Some(T::from(t) - rate)
    }
}

/// The direction across an edge of the surface, 1 to 4, and its parameter there.
fn edge_line(edge: usize) -> Option<(usize, f64)> {
    [None, Some((1, 0.0)), Some((0, 1.0)), Some((1, 1.0)), Some((0, 0.0))][edge]
}

fn at_edge(axis: usize, at: f64, room: f64) -> CallError {
    let edge = [[4, 2], [1, 3]][axis][usize::from(at == 1.0)];
    let letter = ["u", "v"][axis];
    no_box("the snake reaches an edge of the surface")
        .expected("room between the snake and the edges")
        .found(format!("a distance of {room:.3e} from {letter} = {at}"))
        .help(format!(
            "keep the appendage away from the edge, or let it cross it: `attach_at_edge(..., {edge})` lays out the half that is left"
        ))
}

/// Snakes across a seam or round a closed surface have no box.
fn check_turns<T: Real>(samples: &[[T; 2]], closed: [bool; 2]) -> Result<(), CallError> {
    for (a, letter) in ["u", "v"].into_iter().enumerate().filter(|(a, _)| closed[*a]) {
        let mut turns = 0.0f64;
        let mut seams = false;
        for pair in samples.windows(2) {
            let step = (pair[1][a] - pair[0][a]).re();
            seams |= step.abs() > 0.5;
            turns += step - step.round();
        }
        if turns.abs() > 0.5 {
            return Err(no_box("the snake runs round the closed surface")
                .expected("a snake round an area of the surface")
                .found(format!("a whole turn of {letter}"))
                .help(
                    "`SubSurf({snake, edge})` is the part between it and an edge of the surface",
                ));
        }
        if seams {
            return Err(no_box("the snake crosses the seam of the closed surface")
                .expected("a seam outside of the snake")
                .found(format!("a snake across {letter} = 0"))
                .help(
                    "begin the surface on its other side: other angles of `RevSurf`, or curves that begin elsewhere",
                ));
        }
    }
    Ok(())
}

/// A snake is closed, or ends on the edge.
fn check_ends<T: Real>(samples: &[[T; 2]], edge: usize) -> Result<(), CallError> {
    let ends = [samples[0], samples[SAMPLES]].map(|w| w.map(|x| x.re()));
    let says = format!(
        "ends at (u, v) = ({}, {}) and ({}, {})",
        ends[0][0], ends[0][1], ends[1][0], ends[1][1]
    );
    match edge_line(edge) {
        None if (0..2).any(|a| (ends[0][a] - ends[1][a]).abs() > MEETING) => {
            Err(no_box("the snake is not closed")
                .expected(
                    "a closed snake, or one that begins and ends on a stated edge of the surface",
                )
                .found(says)
                .help("an appendage across an edge of the surface is attached by `attach_at_edge`"))
        }
        Some((a, at)) if ends.iter().any(|w| (w[a] - at).abs() > MEETING) => Err(no_box(
            "the snake does not begin and end on the edge",
        )
        .expected(format!("both ends on {} = {at}", ["u", "v"][a]))
        .found(says)
        .help("state the edge on which it ends: 1 is v = 0, 2 is u = 1, 3 is v = 1, 4 is u = 0")),
        _ => Ok(()),
    }
}
