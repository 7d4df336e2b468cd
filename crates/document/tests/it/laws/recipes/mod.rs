//! A random object of each kind, by family. A new kind has its arm in the file of its family.

mod curves;
mod others;
mod points;
mod snakes;
mod surfaces;
mod weights;

use crate::laws::program::Program;

/// The arguments of a random object of this kind, with all that it needs declared before; `None`
/// when no family knows the kind.
pub fn arguments(p: &mut Program, kind: &str) -> Option<String> {
    let families = [
        points::arguments,
        curves::arguments,
        snakes::arguments,
        surfaces::arguments,
        others::arguments,
        weights::arguments,
    ];
    families.iter().find_map(|family| family(p, kind))
}
