//! HDF5 files, written: groups in groups, texts and numbers as attributes, arrays in one piece.
//!
//! A superblock of version 2 and object headers of version 2, which HDF5 1.8 and newer reads. A group has all its
//! links in its header, with their order of creation.

use super::codes;
use crate::WriteError;

/// A group: its attributes, and its members in their order.
#[derive(Debug, Default)]
pub(crate) struct Hdf5Group {
    pub attributes: Vec<(&'static str, Hdf5Attribute)>,
    pub members: Vec<(String, Hdf5Object)>,
}

#[derive(Debug)]
pub(crate) enum Hdf5Object {
    Group(Hdf5Group),
    Array(Hdf5Array),
}

#[derive(Debug)]
pub(crate) enum Hdf5Attribute {
    /// A text in a number of bytes, padded with zeros.
    Text(String, usize),
    Integers(Vec<i32>),
}

/// An array, the last extent fastest.
#[derive(Debug)]
pub(crate) struct Hdf5Array {
    pub extents: Vec<usize>,
    pub element: Hdf5Element,
    bytes: Vec<u8>,
}

/// The type of the elements of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Hdf5Element {
    Byte,
    Integer,
    Single,
    Double,
}

impl Hdf5Array {
    /// Characters as whole numbers of a byte.
    pub fn characters(extents: Vec<usize>, bytes: Vec<u8>) -> Self {
        Self { extents, element: Hdf5Element::Byte, bytes }
    }

    pub fn integers(extents: Vec<usize>, values: &[i32]) -> Self {
        let bytes = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        Self { extents, element: Hdf5Element::Integer, bytes }
    }

    pub fn singles(values: &[f32]) -> Self {
        let bytes = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        Self { extents: vec![values.len()], element: Hdf5Element::Single, bytes }
    }

    pub fn doubles(extents: Vec<usize>, values: &[f64]) -> Self {
        let bytes = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        Self { extents, element: Hdf5Element::Double, bytes }
    }
}

/// The address of nothing.
const NOWHERE: u64 = u64::MAX;

/// Bytes of the superblock; objects begin behind it.
const SUPERBLOCK_BYTES: usize = 48;

/// Maximum number of links that a header may hold.
const MOST_LINKS: usize = u16::MAX as usize;

/// Object headers and arrays begin at multiples of this number of bytes.
const ALIGNED_BYTES: usize = 8;

// Kinds of messages that are written but not read.
const FILL_VALUE: u16 = 5;
const GROUP_INFO: u16 = 10;

/// The file with this root group.
///
/// # Errors
/// A group of more members than a header can hold.
pub(crate) fn write(root: Hdf5Group) -> Result<Vec<u8>, WriteError> {
    let mut out = vec![0; SUPERBLOCK_BYTES];
    let root = object(&mut out, Hdf5Object::Group(root))?;
    let mut head = codes::SIGNATURE.to_vec();
    // Version 2, addresses and lengths of 8 bytes, closed.
    head.extend([2, 8, 8, 0]);
    for address in [0, NOWHERE, out.len() as u64, root] {
        head.extend(address.to_le_bytes());
    }
    head.extend(checksum(&head).to_le_bytes());
    out[..SUPERBLOCK_BYTES].copy_from_slice(&head);
    Ok(out)
}

/// Appends an object behind its members; its address.
fn object(out: &mut Vec<u8>, object: Hdf5Object) -> Result<u64, WriteError> {
    let mut messages = Messages::default();
    match object {
        Hdf5Object::Array(array) => {
            align(out);
            let address = out.len() as u64;
            out.extend(&array.bytes);
            messages.add(codes::DATASPACE, &dataspace(&array.extents));
            messages.add(codes::DATATYPE, &array.element.datatype());
            // Version 3: allocated late, written if set, zero.
            messages.add(FILL_VALUE, &[3, 0x0a]);
            let mut layout = vec![3, 1];
            layout.extend(address.to_le_bytes());
            layout.extend((array.bytes.len() as u64).to_le_bytes());
            messages.add(codes::LAYOUT, &layout);
        }
        Hdf5Object::Group(group) => {
            let count = group.members.len();
            if count > MOST_LINKS {
                return Err(WriteError::TooLarge { what: "members of a group", count });
            }
            // The order of creation is tracked and indexed.
            let mut info = vec![0, 3];
            info.extend((count as u64).to_le_bytes());
            info.extend([0xff; 24]);
            messages.add(codes::LINK_INFO, &info);
            // All links stay in the header, however many there are.
            messages.add(GROUP_INFO, &[0, 1, 0xff, 0xff, 0, 0]);
            for (name, value) in &group.attributes {
                messages.add(codes::ATTRIBUTE, &attribute(name, value));
            }
            for (order, (name, member)) in group.members.into_iter().enumerate() {
                let address = self::object(out, member)?;
                messages.add(codes::LINK, &link(&name, order, address)?);
            }
        }
    }
    Ok(messages.header(out))
}

fn align(out: &mut Vec<u8>) {
    out.resize(out.len().next_multiple_of(ALIGNED_BYTES), 0);
}

/// The messages of an object header.
#[derive(Default)]
struct Messages(Vec<u8>);

impl Messages {
    fn add(&mut self, kind: u16, body: &[u8]) {
        self.0.push(kind as u8);
        self.0.extend((body.len() as u16).to_le_bytes());
        self.0.push(0);
        self.0.extend(body);
    }

    /// Appends the header; its address.
    fn header(self, out: &mut Vec<u8>) -> u64 {
        align(out);
        let start = out.len();
        out.extend(b"OHDR");
        // Version 2; the length of the messages takes 4 bytes.
        out.extend([2, 2]);
        out.extend((self.0.len() as u32).to_le_bytes());
        out.extend(self.0);
        let sum = checksum(&out[start..]);
        out.extend(sum.to_le_bytes());
        start as u64
    }
}

impl Hdf5Element {
    fn datatype(self) -> Vec<u8> {
        match self {
            Self::Byte => integer_type(1),
            Self::Integer => integer_type(4),
            Self::Single => real_type(4, 31, [23, 8, 0, 23], 127),
            Self::Double => real_type(8, 63, [52, 11, 0, 52], 1023),
        }
    }
}

/// A signed whole number, little-endian.
fn integer_type(bytes: u8) -> Vec<u8> {
    vec![0x10, 8, 0, 0, bytes, 0, 0, 0, 0, 0, 8 * bytes, 0]
}

/// A real number of IEEE 754, little-endian: its sign's bit; position and bits of exponent and mantissa; bias.
fn real_type(bytes: u8, sign: u8, parts: [u8; 4], bias: u32) -> Vec<u8> {
    let mut all = vec![0x11, 0x20, sign, 0, bytes, 0, 0, 0, 0, 0, 8 * bytes, 0];
    all.extend(parts);
    all.extend(bias.to_le_bytes());
    all
}

/// A dataspace of version 2; no extents are a single value.
fn dataspace(extents: &[usize]) -> Vec<u8> {
    let mut all = vec![2, extents.len() as u8, 0, u8::from(!extents.is_empty())];
    all.extend(extents.iter().flat_map(|n| (*n as u64).to_le_bytes()));
    all
}

fn attribute(name: &str, value: &Hdf5Attribute) -> Vec<u8> {
    let (kind, space, data) = match value {
        Hdf5Attribute::Text(text, width) => {
            let mut data = text.as_bytes()[..text.len().min(*width)].to_vec();
            data.resize(*width, 0);
            let mut kind = vec![0x13, 1, 0, 0];
            kind.extend((*width as u32).to_le_bytes());
            (kind, dataspace(&[]), data)
        }
        Hdf5Attribute::Integers(values) => {
            let data = values.iter().flat_map(|x| x.to_le_bytes()).collect();
            (integer_type(4), dataspace(&[values.len()]), data)
        }
    };
    let mut all = vec![3, 0];
    for length in [name.len() + 1, kind.len(), space.len()] {
        all.extend((length as u16).to_le_bytes());
    }
    all.push(0);
    all.extend(name.as_bytes());
    all.push(0);
    for part in [kind, space, data] {
        all.extend(part);
    }
    all
}

/// A hard link with its order of creation.
fn link(name: &str, order: usize, address: u64) -> Result<Vec<u8>, WriteError> {
    let Ok(length) = u8::try_from(name.len()) else {
        return Err(WriteError::TooLarge { what: "characters of a name", count: name.len() });
    };
    let mut all = vec![1, 4];
    all.extend((order as u64).to_le_bytes());
    all.push(length);
    all.extend(name.as_bytes());
    all.extend(address.to_le_bytes());
    Ok(all)
}

/// The steps of a round of lookup3: x = (x - y) ^ y turned, y += z.
const MIXED: [(usize, usize, usize, u32); 6] =
    [(0, 2, 1, 4), (1, 0, 2, 6), (2, 1, 0, 8), (0, 2, 1, 16), (1, 0, 2, 19), (2, 1, 0, 4)];

/// The checksum of HDF5's metadata: `hashlittle` of Jenkins' lookup3, started at 0.
fn checksum(bytes: &[u8]) -> u32 {
    let [mut a, mut b, mut c] = [0xdead_beef_u32.wrapping_add(bytes.len() as u32); 3];
    let whole = bytes.len().saturating_sub(1) / 12 * 12;
    let (body, tail) = bytes.split_at(whole);
    let word = |block: &[u8], k: usize| {
        let part = block.iter().skip(4 * k).take(4).enumerate();
        part.fold(0, |sum, (n, byte)| sum | u32::from(*byte) << (8 * n))
    };
    for block in body.chunks_exact(12) {
        a = a.wrapping_add(word(block, 0));
        b = b.wrapping_add(word(block, 1));
        c = c.wrapping_add(word(block, 2));
        for (x, y, z, turn) in MIXED {
            let mut all = [a, b, c];
            all[x] = all[x].wrapping_sub(all[y]) ^ all[y].rotate_left(turn);
            all[y] = all[y].wrapping_add(all[z]);
            [a, b, c] = all;
        }
    }
    if tail.is_empty() {
        return c;
    }
    a = a.wrapping_add(word(tail, 0));
    b = b.wrapping_add(word(tail, 1));
    c = c.wrapping_add(word(tail, 2));
    let mixed = |x: u32, y: u32, turn: u32| (x ^ y).wrapping_sub(y.rotate_left(turn));
    c = mixed(c, b, 14);
    a = mixed(a, c, 11);
    b = mixed(b, a, 25);
    c = mixed(c, b, 16);
    a = mixed(a, c, 4);
    b = mixed(b, a, 14);
    mixed(c, b, 24)
}

#[cfg(test)]
mod tests {
    use super::super::Hdf5File;
    use super::*;

    #[test]
    fn checksums_are_those_of_lookup3() {
        // The values that the author of lookup3 prints.
        assert_eq!(checksum(b""), 0xdead_beef);
        assert_eq!(checksum(b"Four score and seven years ago"), 0x1777_0551);
    }

    #[test]
    fn groups_of_all_sizes_are_read_back() {
        for count in [0, 1, 8, 9, 300, 70_000] {
            let members = (0..count).map(|k| {
                let array = Hdf5Array::integers(vec![2], &[k, -k]);
                (format!("member {k}"), Hdf5Object::Array(array))
            });
            let text = Hdf5Attribute::Text("a text".into(), 33);
            let group = Hdf5Group {
                attributes: vec![("label", text), ("flags", Hdf5Attribute::Integers(vec![1]))],
                members: members.collect(),
            };
            let written = write(group);
            if count as usize > MOST_LINKS {
                let count = count as usize;
                assert_eq!(
                    written,
                    Err(WriteError::TooLarge { what: "members of a group", count })
                );
                continue;
            }
            let bytes = written.unwrap();
            let file = Hdf5File::open(&bytes).unwrap();
            assert_eq!(file.text(file.root(), "label").unwrap().as_deref(), Some("a text"));
            let links = file.children(file.root()).unwrap();
            assert_eq!(links.len(), count as usize);
            for (k, link) in links.iter().enumerate() {
                assert_eq!(
                    (link.name.clone(), link.order),
                    (format!("member {k}"), Some(k as u64))
                );
                let numbers = file.numbers(link.to.unwrap()).unwrap();
                assert_eq!(
                    (numbers.extents, numbers.values),
                    (vec![2], vec![k as f64, -(k as f64)])
                );
            }
        }
    }

    #[test]
    fn no_part_of_a_file_is_a_file() {
        let reals =
            Hdf5Array::doubles(vec![2, 3], &[1.5, -2.0, 0.0, 1e300, f64::MIN_POSITIVE, 6.0]);
        let group = Hdf5Group {
            attributes: vec![],
            members: vec![
                ("reals".into(), Hdf5Object::Array(reals)),
                ("singles".into(), Hdf5Object::Array(Hdf5Array::singles(&[0.5]))),
            ],
        };
        let bytes = write(group).unwrap();
        let read = |bytes: &[u8]| {
            let file = Hdf5File::open(bytes)?;
            let links = file.children(file.root())?;
            links.iter().map(|link| file.numbers(link.to.unwrap())).collect::<Result<Vec<_>, _>>()
        };
        let all = read(&bytes).unwrap();
        assert_eq!(all[0].extents, [2, 3]);
        assert_eq!(all[0].values, [1.5, -2.0, 0.0, 1e300, f64::MIN_POSITIVE, 6.0]);
        assert_eq!(all[1].values, [0.5]);
        for end in 0..bytes.len() - 4 {
            assert!(read(&bytes[..end]).is_err(), "{end}");
        }
    }
}
