//! The cells between candidate faces.

use super::regions::{SheetRegion, SpannedPlane};
use super::wire::Wireframe;
use moldloft_num::union_find::UnionFind;
use moldloft_num::{Real, Vec3};

/// A candidate at an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wing {
    pub region: usize,
    /// True if the counter-clockwise side (about the edge) is the side of the normal.
    pub forward: bool,
    angle: f64,
}

/// The space between candidates.
pub(super) struct CellComplex {
    /// Cell on the normal side (`2 r`) and on the other (`2 r + 1`) of region `r`; `None` is outside.
    pub side: Vec<Option<usize>>,
    /// The volume of each cell.
    pub volume: Vec<f64>,
    /// The wings at each edge, counter-clockwise about it.
    pub wings: Vec<Vec<Wing>>,
}

impl CellComplex {
    /// The sides (indices into [`Self::side`]) clockwise and counter-clockwise of a wing.
    pub fn sides(wing: Wing) -> [usize; 2] {
        let (plus, minus) = (2 * wing.region, 2 * wing.region + 1);
        if wing.forward { [minus, plus] } else { [plus, minus] }
    }

    pub fn build(
        wire: &Wireframe,
        sheets: &[SpannedPlane],
        regions: &[SheetRegion],
    ) -> CellComplex {
        let wings = wings(wire, sheets, regions);
        let mut shell = UnionFind::new(2 * regions.len());
        let mut part = UnionFind::new(regions.len());
        for around in &wings {
            for (k, &wing) in around.iter().enumerate() {
                let next = around[(k + 1) % around.len()];
                shell.join(CellComplex::sides(wing)[1], CellComplex::sides(next)[0]);
                part.join(wing.region, next.region);
            }
        }
        let centre = wire.vertices.first().copied().unwrap_or_default();
        let cones: Vec<f64> = regions.iter().map(|r| cone(wire, r, centre)).collect();
        let mut volumes = vec![0.0; 2 * regions.len()];
        for (r, cone) in cones.iter().enumerate() {
            volumes[shell.find(2 * r)] -= cone;
            volumes[shell.find(2 * r + 1)] += cone;
        }
        let nothing = wire.tolerance.powi(3);
        let mut number = vec![None; 2 * regions.len()];
        let mut volume = Vec::new();
        for s in 0..2 * regions.len() {
            if shell.find(s) == s && volumes[s] > nothing {
                number[s] = Some(volume.len());
                volume.push(volumes[s]);
            }
        }
        // A shell with its inside out is the wall of a cavity in the smallest cell around it.
        let walls: Vec<usize> =
            (0..2 * regions.len()).filter(|&s| shell.find(s) == s && number[s].is_none()).collect();
        let mut host = vec![None; 2 * regions.len()];
        for &wall in &walls {
            let (e, _) = regions[wall / 2].loops[0][0];
            let [a, b] = wire.edges[e].ends.map(|v| wire.vertices[v]);
            let point = (a + b) * 0.5;
            let own = part.find(wall / 2);
            let mut turns = vec![0.0; volume.len()];
            for (r, region) in regions.iter().enumerate() {
                if part.find(r) == own {
                    continue;
                }
                let angle = solid_angle(wire, region, point);
                for (side, sign) in [(2 * r, -1.0), (2 * r + 1, 1.0)] {
                    if let Some(cell) = number[shell.find(side)] {
                        turns[cell] += sign * angle;
                    }
                }
            }
            let around = (0..volume.len()).filter(|&c| turns[c] > 2.0 * std::f64::consts::PI);
            host[wall] = around.min_by(|&a, &b| volume[a].total_cmp(&volume[b]));
        }
        for &wall in &walls {
            if let Some(cell) = host[wall] {
                volume[cell] += volumes[wall];
            }
        }
        let side = (0..2 * regions.len())
            .map(|s| {
                let root = shell.find(s);
                number[root].or(host[root])
            })
            .collect();
        CellComplex { side, volume, wings }
    }
}

fn wings(wire: &Wireframe, sheets: &[SpannedPlane], regions: &[SheetRegion]) -> Vec<Vec<Wing>> {
    let mut wings: Vec<Vec<Wing>> = vec![Vec::new(); wire.edges.len()];
    let frames: Vec<[Vec3; 2]> = (wire.edges.iter())
        .map(|e| {
            let d = wire.vertices[e.ends[1]] - wire.vertices[e.ends[0]];
            let d = d.normalized().unwrap_or_default();
            let x = d.perpendicular();
            [x, d.cross(x)]
        })
        .collect();
    for (region, r) in regions.iter().enumerate() {
        for &(e, forward) in r.loops.iter().flatten() {
            let [a, b] = wire.edges[e].ends.map(|v| wire.vertices[v]);
            let mut inward = sheets[r.sheet].normal.cross(b - a);
            if !forward {
                inward = -inward;
            }
            let [x, y] = frames[e];
            let angle = Real::atan2(inward.dot(y), inward.dot(x));
            wings[e].push(Wing { region, forward, angle });
        }
    }
    for around in &mut wings {
        around.sort_by(|a, b| a.angle.total_cmp(&b.angle).then(a.region.cmp(&b.region)));
    }
    wings
}

/// The signed triangles of a region, all from one corner.
fn fan<'a>(wire: &'a Wireframe, region: &'a SheetRegion) -> impl Iterator<Item = [Vec3; 3]> + 'a {
    let apex = wire.vertices[wire.tail(region.loops[0][0])];
    (region.loops.iter().flatten())
        .map(move |&h| [apex, wire.vertices[wire.tail(h)], wire.vertices[wire.head(h)]])
}

/// The volume of the cone from `centre` over a region, positive when its normal points away.
fn cone(wire: &Wireframe, region: &SheetRegion, centre: Vec3) -> f64 {
    fan(wire, region).map(|[a, b, c]| (a - centre).dot((b - centre).cross(c - centre)) / 6.0).sum()
}

/// The solid angle of a region seen from `p`, positive from the side against its normal
/// (van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30, 1983).
fn solid_angle(wire: &Wireframe, region: &SheetRegion, p: Vec3) -> f64 {
    fan(wire, region)
        .map(|corners| {
            let [a, b, c] = corners.map(|x| x - p);
            let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
            let top = a.dot(b.cross(c));
            let bottom = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
            if top == 0.0 { 0.0 } else { 2.0 * Real::atan2(top, bottom) }
        })
        .sum()
}
