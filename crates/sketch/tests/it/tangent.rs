//! Round faces that touch plane ones and each other, in any order of operations and at random sizes, against closed forms:
//! a few of each here, a thousand under `MOLDLOFT_SOAK=1`.

use moldloft_sketch::*;
use moldloft_testing::{Random, rounds};
use std::f64::consts::PI;
use std::fmt::Write as _;

/// A part in commands, with its figures.
struct Part {
    text: String,
    /// Volume and area.
    want: [f64; 2],
}

/// An extruded rectangle in a plane, or the disc inscribed in it, moved.
fn prism(name: &str, plane: &str, [a, b, e]: [f64; 3], disc: bool, at: [f64; 3]) -> String {
    let mut text = format!(
        "SKETCH {name} 2D {plane}\nPOINT 1 0 0; POINT 2 90 0; POINT 3 90 90; POINT 4 0 90\nPOLYLINE 1 2 3 4 CLOSE\n"
    );
    let (x, y) = plane.split_at(1);
    writeln!(text, "DIM {x} 1 2 {a:?}; DIM {y} 1 4 {b:?}").unwrap();
    if disc {
        text.push_str("CIRCLE C CORNER 1 2 4\n");
    }
    let [p, q, r] = at;
    writeln!(text, "EXTRUDE {name} {e:?}\nMOVE {name} {p:?} {q:?} {r:?}").unwrap();
    text
}

fn block(name: &str, size: [f64; 3], at: [f64; 3]) -> String {
    prism(name, "XY", size, false, at)
}

/// A bar of radius `r` along an axis, its middle line at `at` in the other two coordinates.
fn rod(name: &str, axis: usize, r: f64, at: [f64; 2], [low, high]: [f64; 2]) -> String {
    let plane = ["YZ", "XZ", "XY"][axis];
    let d = 2.0 * r;
    let mut place = [low; 3];
    for (k, x) in (0..3).filter(|k| *k != axis).zip(at) {
        place[k] = x - r;
    }
    prism(name, plane, [d, d, high - low], true, place)
}

/// The figures of a body by all methods.
fn check(what: &str, part: &Part) -> Result<f64, String> {
    let mut s = SketchSession::new();
    if let Some(e) = s.run_text(&part.text).iter().find(|r| r.is_error()) {
        return Err(format!("{what}: {}\n{}", e.text, part.text));
    }
    let o = s.objects().into_iter().find(|o| o.name == "P").unwrap();
    let (Some(volume), Some(area)) = (o.volume, o.area) else {
        return Err(format!("{what}: no body\n{}", part.text));
    };
    let off = ((volume - part.want[0]) / part.want[0])
        .abs()
        .max(((area - part.want[1]) / part.want[1]).abs());
    assert!(off < 1e-11, "{what}: {volume} {area} for {:?}\n{}", part.want, part.text);
    let report = o.solid.unwrap().mesh(0.5).report();
    // Where a post touches a wall four faces share an edge.
    let touches = report.branching_edges > 0 && what == "cup";
    let outward = touches || report.outward == Some(true);
    assert!(report.closed && outward, "{what}: {report:?}\n{}", part.text);
    Ok(off)
}

fn all(what: &str, part: impl Fn(&mut Random) -> Part) {
    let mut random =
        Random::new(what.bytes().fold(7, |seed, b| seed.wrapping_mul(31) + u64::from(b)));
    let mut worst = 0.0f64;
    let (mut refused, mut first) = (0, None);
    let count = rounds(4, 1000);
    for _ in 0..count {
        match check(what, &part(&mut random)) {
            Ok(off) => worst = worst.max(off),
            Err(why) => {
                refused += 1;
                first.get_or_insert(why);
            }
        }
    }
    println!("{what}: {count}, refused {refused}, worst {worst:.1e}");
    assert!(refused == 0, "{refused} of {count} refused; first {}", first.unwrap());
}

fn cents(random: &mut Random, low: f64, high: f64) -> f64 {
    (random.between(low, high) * 100.0).round() / 100.0
}

fn whole(random: &mut Random, low: f64, high: f64) -> f64 {
    random.between(low, high + 1.0).floor()
}

/// A block with a round top of radius r, thickness w, axis at height h: volume and area, without the disc's rim outside.
fn round_top(r: f64, w: f64, h: f64) -> [f64; 2] {
    let face = 2.0 * r * h + PI * r * r / 2.0;
    [face * w, 2.0 * face + w * (2.0 * h + 2.0 * r + PI * r)]
}

fn lug_outline(r: f64, w: f64, h: f64, proud: f64) -> String {
    prism("M", "XZ", [2.0 * r, h, w], false, [-r, 0.0, 0.0])
        + &rod("C", 1, r, [0.0, h], [-proud, w + proud])
}

#[test]
fn round_tops() {
    all("round top", |random| {
        let [r, w, h] =
            [cents(random, 10.0, 40.0), cents(random, 10.0, 60.0), cents(random, 40.0, 80.0)];
        Part { text: lug_outline(r, w, h, 0.0) + "UNION M C INTO P\n", want: round_top(r, w, h) }
    });
    all("round top of whole numbers", |random| {
        let [r, w, h] =
            [whole(random, 10.0, 40.0), whole(random, 10.0, 60.0), whole(random, 40.0, 80.0)];
        Part { text: lug_outline(r, w, h, 0.0) + "UNION C M INTO P\n", want: round_top(r, w, h) }
    });
}

#[test]
fn discs_that_stand_out() {
    all("disc 1 proud", |random| {
        let [r, w, h] =
            [cents(random, 10.0, 30.0), cents(random, 10.0, 60.0), cents(random, 40.0, 80.0)];
        let [volume, area] = round_top(r, w, h);
        let want = [volume + 2.0 * PI * r * r, area + 2.0 * 2.0 * PI * r];
        Part { text: lug_outline(r, w, h, 1.0) + "UNION M C INTO P\n", want }
    });
}

#[test]
fn lugs_with_bores() {
    all("lug", |random| {
        let [r, w, h] =
            [cents(random, 10.0, 40.0), cents(random, 10.0, 60.0), cents(random, 40.0, 80.0)];
        let bore = cents(random, 2.0, 0.6 * r);
        let [volume, area] = round_top(r, w, h);
        let want =
            [volume - PI * bore * bore * w, area - 2.0 * PI * bore * bore + 2.0 * PI * bore * w];
        let text = lug_outline(r, w, h, 0.0) + &rod("D", 1, bore, [0.0, h], [-1.0, w + 1.0]);
        let order = *random.pick(&[
            "UNION M C INTO L\nCUT L D INTO P\n",
            "CUT M D INTO A\nCUT C D INTO B\nUNION A B INTO P\n",
        ]);
        Part { text: text + order, want }
    });
}

#[test]
fn clevises() {
    all("clevis", |random| {
        let [r, t, g] =
            [whole(random, 8.0, 20.0), whole(random, 4.0, 10.0), whole(random, 6.0, 20.0)];
        let [h, bore] = [whole(random, 22.0, 50.0), whole(random, 3.0, 6.0)];
        let (w, base) = (2.0 * t + g, 8.0);
        let shank = whole(random, 3.0, 0.4 * w.min(2.0 * r));
        let text = lug_outline(r, w, h, 0.0)
            + &block("G", [2.0 * r + 2.0, g, h + r], [-r - 1.0, t, base])
            + &rod("D", 1, bore, [0.0, h], [-1.0, w + 1.0])
            + &rod("S", 2, shank, [0.0, w / 2.0], [-20.0, 0.0])
            + "UNION M C INTO L\nCUT L G INTO F\nCUT F D INTO E\nUNION E S INTO P\n";
        let [volume, area] = round_top(r, w, h);
        let gap = 2.0 * r * (h - base) + PI * r * r / 2.0;
        let inner = 2.0 * (h - base) + PI * r;
        let want = [
            volume - gap * g - 2.0 * PI * bore * bore * t + 20.0 * PI * shank * shank,
            area - inner * g + 2.0 * gap + 2.0 * r * g - 4.0 * PI * bore * bore
                + 2.0 * PI * bore * 2.0 * t
                + 2.0 * PI * shank * 20.0,
        ];
        Part { text, want }
    });
}

#[test]
fn slots() {
    let slot = |random: &mut Random, order: &str| {
        let [r, t, l] =
            [cents(random, 3.0, 9.0), cents(random, 5.0, 20.0), cents(random, 20.0, 60.0)];
        let text = block("B", [100.0, 60.0, t], [0.0; 3])
            + &block("M", [l, 2.0 * r, t + 2.0], [20.0, 30.0 - r, -1.0])
            + &rod("C", 2, r, [20.0 + l, 30.0], [-1.0, t + 1.0])
            + order;
        let hole = 2.0 * r * l + PI * r * r / 2.0;
        let rim = 2.0 * l + 2.0 * r + PI * r;
        Part { text, want: [(6000.0 - hole) * t, 2.0 * (6000.0 - hole) + (320.0 + rim) * t] }
    };
    all("slot, cut by cut", |random| slot(random, "CUT B M INTO A\nCUT A C INTO P\n"));
    all("slot, round end first", |random| slot(random, "CUT B C INTO A\nCUT A M INTO P\n"));
    all("slot, united", |random| slot(random, "UNION M C INTO A\nCUT B A INTO P\n"));
}

#[test]
fn holes_in_rows() {
    let holes = |random: &mut Random, grid: bool| {
        let t = 8.0;
        let d = whole(random, 3.0, 9.0);
        let r = d / 2.0;
        let [x, y] = [whole(random, 10.0, 20.0), whole(random, 10.0, 20.0)];
        let places: Vec<[f64; 2]> = match grid {
            true => [[x, y], [x + 30.0, y], [x, y + 25.0], [x + 30.0, y + 25.0]].to_vec(),
            false => (0..3).map(|k| [x + 25.0 * f64::from(k), whole(random, 10.0, 50.0)]).collect(),
        };
        let mut text = block("A0", [100.0, 60.0, t], [0.0; 3]);
        let n = places.len();
        for (k, at) in places.iter().enumerate() {
            text += &rod(&format!("H{k}"), 2, r, *at, [-1.0, t + 1.0]);
            let into = if k + 1 == n { "P".to_owned() } else { format!("A{}", k + 1) };
            writeln!(text, "CUT A{k} H{k} INTO {into}").unwrap();
        }
        let (hole, n) = (PI * r * r, n as f64);
        let want = [(6000.0 - n * hole) * t, 2.0 * (6000.0 - n * hole) + (320.0 + n * PI * d) * t];
        Part { text, want }
    };
    all("holes on a grid", |random| holes(random, true));
    all("holes anywhere", |random| holes(random, false));
}

#[test]
fn equal_bars() {
    all("equal cross", |random| {
        let [r, l] = [whole(random, 5.0, 20.0), whole(random, 50.0, 90.0)];
        let at = [whole(random, -9.0, 9.0), whole(random, -9.0, 9.0), whole(random, -9.0, 9.0)];
        let along = |k: usize| [at[k] - l / 2.0, at[k] + l / 2.0];
        let text = rod("A", 2, r, [at[0], at[1]], along(2))
            + &rod("B", 0, r, [at[1], at[2]], along(0))
            + "UNION A B INTO P\n";
        let want = [
            2.0 * PI * r * r * l - 16.0 * r.powi(3) / 3.0,
            2.0 * (2.0 * PI * r * (l + r)) - 16.0 * r * r,
        ];
        Part { text, want }
    });
    all("equal cross, common part", |random| {
        let [r, l] = [cents(random, 5.0, 20.0), 90.0];
        let text = rod("A", 2, r, [0.0; 2], [-l, l])
            + &rod("B", 1, r, [0.0; 2], [-l, l])
            + "COMMON A B INTO P\n";
        Part { text, want: [16.0 * r.powi(3) / 3.0, 16.0 * r * r] }
    });
    all("equal tee", |random| {
        let [r, l] = [cents(random, 5.0, 20.0), cents(random, 50.0, 90.0)];
        let text = rod("A", 2, r, [0.0; 2], [-l, l])
            + &rod("B", 0, r, [0.0; 2], [0.0, l])
            + "UNION A B INTO P\n";
        let want = [
            PI * r * r * 3.0 * l - 8.0 * r.powi(3) / 3.0,
            2.0 * PI * r * (3.0 * l + 1.5 * r) - 8.0 * r * r,
        ];
        Part { text, want }
    });
}

/// Four posts that touch the inside of a ring, on its axes.
#[test]
fn posts_inside_of_a_cap() {
    all("posts", |random| {
        let [r, post, t] =
            [whole(random, 20.0, 40.0), whole(random, 2.0, 6.0), whole(random, 3.0, 9.0)];
        let h = t + whole(random, 5.0, 20.0);
        let mut text = rod("A0", 2, r, [0.0; 2], [0.0, t]);
        let off = r - post;
        let places = [[off, 0.0], [0.0, off], [-off, 0.0], [0.0, -off]];
        for (k, at) in places.into_iter().enumerate() {
            text += &rod(&format!("H{k}"), 2, post, at, [0.0, h]);
            let into = if k == 3 { "P".to_owned() } else { format!("A{}", k + 1) };
            writeln!(text, "UNION A{k} H{k} INTO {into}").unwrap();
        }
        let want = [
            PI * r * r * t + 4.0 * PI * post * post * (h - t),
            2.0 * PI * r * (r + t) + 4.0 * 2.0 * PI * post * (h - t),
        ];
        Part { text, want }
    });
}

/// Posts on the floor of a cup, which touch its wall, at any angle and in polar rows.
#[test]
fn posts_along_the_wall_of_a_cup() {
    all("cup", |random| {
        let [r, wall, post] =
            [cents(random, 18.0, 40.0), whole(random, 2.0, 4.0), cents(random, 2.0, 5.0)];
        let [h, floor] = [whole(random, 8.0, 20.0), 2.0];
        let (inner, n) = (r - wall, 1 + random.below(4));
        let any = whole(random, 1.0, 89.0);
        let turn = *random.pick(&[0.0, 30.0, 45.0, 7.0, 88.0, any]);
        let text = rod("A", 2, r, [0.0; 2], [0.0, h])
            + &rod("I", 2, inner, [0.0; 2], [floor, h + 1.0])
            + &rod("S", 2, post, [inner - post, 0.0], [0.0, h])
            + &format!(
                "CUT A I INTO C\nROTATE S Z {turn} THROUGH 0 0 0\n\
                 PATTERN S POLAR {n} Z {:?} INTO T\nUNION C T INTO P\n",
                360.0 / n as f64
            );
        let (deep, n) = (h - floor, n as f64);
        let want = [
            PI * r * r * h - PI * (inner * inner - n * post * post) * deep,
            2.0 * PI * r * (r + h) + 2.0 * PI * (inner + n * post) * deep,
        ];
        Part { text, want }
    });
}

/// Two crossing bars with axes `off` apart: volume of their common part, and area of each one's surface in the other.
fn crossing(r: f64, q: f64, off: f64) -> [f64; 2] {
    let (low, high) = ((-r).max(off - q), r.min(off + q));
    let root = |x: f64| x.max(0.0).sqrt();
    let (mut volume, mut area) = (0.0, 0.0);
    let parts = 400;
    for k in 0..parts {
        for (x, w) in moldloft_num::GAUSS_8_UNIT {
            // Over a sine, for the roots at the ends of z.
            let angle = PI * ((f64::from(k) + x) / f64::from(parts) - 0.5);
            let z = 0.5 * (low + high) + 0.5 * (high - low) * libm::sin(angle);
            let dz = 0.5 * (high - low) * libm::cos(angle) * PI * w / f64::from(parts);
            let (a, b) = (root(r * r - z * z), root(q * q - (z - off) * (z - off)));
            volume += 4.0 * a * b * dz;
            area += 4.0 * (r * b / a + q * a / b) * dz;
        }
    }
    [volume, area]
}

/// Bars across each other, often so that one touches the other from inside.
#[test]
fn crosses_off_centre() {
    all("cross off centre", |random| {
        let [r, q, l] =
            [whole(random, 8.0, 20.0), whole(random, 5.0, 20.0), whole(random, 40.0, 60.0)];
        let any = whole(random, 0.0, 12.0);
        let off = *random.pick(&[any, (r - q).abs(), 0.5 * (r - q).abs()]);
        let text = rod("A", 0, r, [0.0; 2], [-l, l])
            + &rod("B", 1, q, [0.0, off], [-l, l])
            + *random.pick(&["UNION A B INTO P\n", "UNION B A INTO P\n"]);
        let [volume, area] = crossing(r, q, off);
        let want = [
            2.0 * PI * l * (r * r + q * q) - volume,
            2.0 * PI * (r * r + q * q) + 4.0 * PI * l * (r + q) - area,
        ];
        Part { text, want }
    });
}

#[test]
fn keyways() {
    all("keyway", |random| {
        let [r, b, l] =
            [whole(random, 10.0, 30.0), whole(random, 2.0, 4.0), whole(random, 10.0, 25.0)];
        let depth = cents(random, 1.0, 4.0);
        // A key with one round end, milled into a shaft along z from its end.
        let text = rod("A", 2, r, [0.0; 2], [0.0, 60.0])
            + &block("M", [2.0 * b, 20.0, l + 1.0], [-b, r - depth, -1.0])
            + &rod("C", 1, b, [0.0, l], [r - depth, r - depth + 20.0])
            + "CUT A M INTO B\nCUT B C INTO P\n";
        // Depth of the shaft above the floor over x, by Gauss's rule.
        let floor = r - depth;
        let column = |x: f64| (r * r - x * x).sqrt() - floor;
        let slope = |x: f64| r / (r * r - x * x).sqrt();
        let mut sums = [0.0; 4];
        let n = 64;
        for k in 0..n {
            for (g, w) in moldloft_num::GAUSS_8_UNIT {
                let x = -b + 2.0 * b * (f64::from(k) + g) / f64::from(n);
                let w = w * 2.0 * b / f64::from(n);
                sums[0] += w * column(x);
                sums[1] += w * slope(x);
            }
            for (g, w) in moldloft_num::GAUSS_8_UNIT {
                // Over the round end by its angle.
                let angle = PI * (f64::from(k) + g) / f64::from(n);
                let w = w * PI / f64::from(n);
                let (x, z) = (b * libm::cos(angle), b * libm::sin(angle));
                sums[2] += w * z * column(x) * b * libm::sin(angle);
                sums[3] += w * b * column(x);
            }
        }
        let end: f64 = (0..n)
            .flat_map(|k| {
                moldloft_num::GAUSS_8_UNIT
                    .map(|(g, w)| (PI * (f64::from(k) + g) / f64::from(n), w * PI / f64::from(n)))
            })
            .map(|(angle, w)| {
                let (x, z) = (b * libm::cos(angle), b * libm::sin(angle));
                w * z * slope(x) * b * libm::sin(angle)
            })
            .sum();
        let volume = PI * r * r * 60.0 - sums[0] * l - sums[2];
        let area = 2.0 * PI * r * (r + 60.0) - sums[0] - sums[1] * l - end
            + 2.0 * b * l
            + PI * b * b / 2.0
            + 2.0 * column(b) * l
            + sums[3];
        Part { text, want: [volume, area] }
    });
}
