//! Colours, and the table between stored and physical light.

use moldloft_mesh::{Patch, Tag};

/// The sixteen colours of model files (the order of the EGA palette: black, blue, green, cyan, red,
/// magenta, brown, light grey, then the bright eight), softened so that shading is visible on them
/// and they contrast with a light background. sRGB.
pub const PALETTE: [[u8; 3]; 16] = [
    [0x46, 0x4d, 0x57],
    [0x3a, 0x66, 0xad],
    [0x3f, 0x8f, 0x5c],
    [0x2f, 0x97, 0xa3],
    [0xb8, 0x4a, 0x40],
    [0x94, 0x55, 0x9c],
    [0xa6, 0x77, 0x3d],
    [0xb6, 0xbc, 0xc4],
    [0x72, 0x7d, 0x89],
    [0x78, 0xa5, 0xe0],
    [0x80, 0xc4, 0x8e],
    [0x78, 0xc8, 0xce],
    [0xe3, 0x82, 0x74],
    [0xca, 0x8f, 0xd0],
    [0xe6, 0xc3, 0x62],
    [0xde, 0xe2, 0xe7],
];

/// Colours of patches without their own, in turn.
const TURN: [usize; 8] = [9, 14, 10, 12, 11, 13, 6, 7];

/// The colour of a patch: by its colour index, otherwise by its role, otherwise the next in
/// sequence.
pub fn patch_colour(patch: &Patch, index: usize) -> [u8; 3] {
    let own = patch.info.colour.and_then(|c| PALETTE.get(c as usize));
    let by_role = match patch.info.tag {
        Tag::Waterline => 11,
        Tag::Symmetry => 15,
        Tag::Lid => 7,
        Tag::Wetted | Tag::Other(_) => TURN[index % TURN.len()],
    };
    *own.unwrap_or(&PALETTE[by_role])
}

/// Conversion between 8-bit sRGB and linear light in [0, 1], by the pure power 2.2.
pub(crate) struct Gamma {
    linear: [f32; 256],
    stored: Vec<u8>,
}

impl Gamma {
    const STEPS: usize = 4096;

    pub fn new() -> Self {
        let power = |x: f64, p: f64| libm::pow(x, p);
        let linear = std::array::from_fn(|k| power(k as f64 / 255.0, 2.2) as f32);
        let stored = (0..=Self::STEPS)
            .map(|k| (255.0 * power(k as f64 / Self::STEPS as f64, 1.0 / 2.2) + 0.5) as u8)
            .collect();
        Self { linear, stored }
    }

    pub fn linear(&self, colour: [u8; 3]) -> [f32; 3] {
        colour.map(|c| self.linear[c as usize])
    }

    pub fn stored(&self, light: [f32; 3]) -> [u8; 3] {
        light.map(|x| self.stored[(x.clamp(0.0, 1.0) * Self::STEPS as f32) as usize])
    }
}
