//! Types of inclined lines in a row, from their copies at the other end of a prism.

use moldloft_sketch::*;
use moldloft_testing::{Random, rounds};

/// Sections of prisms along z with inclined neighbours.
const SECTIONS: [&[[f64; 2]]; 5] = [
    // Hexagon, dovetail, haunched culvert, gusset with two slopes, hull.
    &[[20.0, 0.0], [45.0, 0.0], [62.0, 24.0], [45.0, 48.0], [20.0, 48.0], [3.0, 24.0]],
    &[[0.0, 0.0], [70.0, 0.0], [58.0, 22.0], [70.0, 47.0], [0.0, 47.0], [13.0, 22.0]],
    &[
        [12.0, 0.0],
        [60.0, 0.0],
        [72.0, 14.0],
        [72.0, 40.0],
        [54.0, 53.0],
        [15.0, 53.0],
        [0.0, 38.0],
        [0.0, 15.0],
    ],
    &[[0.0, 0.0], [66.0, 0.0], [50.0, 30.0], [21.0, 44.0], [0.0, 60.0]],
    &[[10.0, 0.0], [50.0, 0.0], [68.0, 25.0], [33.0, 61.0], [0.0, 29.0]],
];

fn unit(degrees: f64) -> [f64; 2] {
    let angle = degrees.to_radians();
    [libm::cos(angle), libm::sin(angle)]
}

/// Wrongly typed lines of a prism that is drawn within `noise`.
fn wrong(section: &[[f64; 2]], noise: f64, random: &mut Random) -> usize {
    let [x, y, z] = [345.0, 40.0, 90.0].map(unit);
    let n = section.len();
    let mut s = SketchSession::new();
    s.run_line("SKETCH A 3D; AXES 345 40 90");
    for (level, height) in [0.0, 30.0].into_iter().enumerate() {
        for (k, [a, b]) in section.iter().enumerate() {
            let at = [0, 1]
                .map(|i| 4.0 * (a * x[i] + b * y[i] + height * z[i]) + noise * random.signed());
            s.run_line(&format!("POINT {} AT {:.6} {:.6}", level * n + k + 1, at[0], at[1]));
        }
    }
    let mut want = Vec::new();
    let free = |d: [f64; 2]| match d.map(|x| x != 0.0) {
        [true, false] => "X",
        [false, true] => "Y",
        _ => "XY",
    };
    for level in 0..2 {
        for k in 0..n {
            let next = (k + 1) % n;
            s.run_line(&format!("LINE FROM {} TO {}", level * n + k + 1, level * n + next + 1));
            want.push(free([section[next][0] - section[k][0], section[next][1] - section[k][1]]));
        }
    }
    for k in 0..n {
        s.run_line(&format!("LINE FROM {} TO {}", k + 1, n + k + 1));
        want.push("Z");
    }
    assert!(s.run_line("TYPE AUTO").iter().all(|r| !r.is_error()));
    let lines = s.active_object().unwrap().drawing.lines.values();
    lines.zip(&want).filter(|(l, w)| l.free.map(Free::spelling) != Some(**w)).count()
}

#[test]
fn prisms_with_inclined_neighbours() {
    let mut random = Random::new(5);
    for section in SECTIONS {
        assert_eq!(wrong(section, 0.0, &mut random), 0, "{section:?}");
    }
    let (mut drawn, mut right) = (0, 0);
    for _ in 0..rounds(4, 200) {
        for section in SECTIONS {
            drawn += 1;
            right += usize::from(wrong(section, 1.0, &mut random) == 0);
        }
    }
    println!("{right} of {drawn} drawn within 1 are typed right");
    assert!(10 * right >= 9 * drawn, "{right} of {drawn}");
}
