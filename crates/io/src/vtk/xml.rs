//! Common parts of all files: arrays after the XML, and the output. Invariant: an offset is that of
//! the length before its array.

use crate::text::put;

/// A file to be written, with its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedFile {
    /// File name, without folder.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// The bytes behind the XML, and where each array starts.
#[derive(Default)]
pub(super) struct Appended(Vec<u8>);

impl Appended {
    /// Adds an array and returns its offset.
    pub fn add(&mut self, bytes: &[u8]) -> usize {
        let offset = self.0.len();
        self.0.extend_from_slice(&(bytes.len() as u64).to_le_bytes());
        self.0.extend_from_slice(bytes);
        offset
    }

    pub fn add_reals(&mut self, values: impl Iterator<Item = f64>) -> usize {
        self.add(&values.flat_map(|x| (x + 0.0).to_le_bytes()).collect::<Vec<_>>())
    }

    pub fn add_integers(&mut self, values: impl Iterator<Item = i64>) -> usize {
        self.add(&values.flat_map(i64::to_le_bytes).collect::<Vec<_>>())
    }

    /// The whole file around a data set element.
    pub fn file(self, kind: &str, body: &str) -> Vec<u8> {
        let mut out = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\" version=\"1.0\" \
             byte_order=\"LittleEndian\" header_type=\"UInt64\">\n{body}<AppendedData \
             encoding=\"raw\">\n_"
        )
        .into_bytes();
        out.extend_from_slice(&self.0);
        out.extend_from_slice(b"\n</AppendedData>\n</VTKFile>\n");
        out
    }
}

pub(super) fn array(kind: &str, name: &str, components: usize, offset: usize) -> String {
    format!(
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
         format=\"appended\" offset=\"{offset}\"/>\n"
    )
}

/// A field array of strings: the bytes of each, ended by zero.
pub(super) fn strings<'a>(name: &str, values: impl ExactSizeIterator<Item = &'a str>) -> String {
    let mut out = format!(
        "<Array type=\"String\" Name=\"{name}\" NumberOfTuples=\"{}\" format=\"ascii\">\n",
        values.len()
    );
    for value in values {
        for byte in value.bytes().filter(|&b| b != 0) {
            put!(out, "{byte} ");
        }
        out.push_str("0\n");
    }
    out + "</Array>\n"
}

/// Numbers at points.
#[derive(Clone, Debug, PartialEq)]
pub struct VtkArray {
    /// The name of the array.
    pub name: String,
    /// Numbers per point.
    pub components: usize,
    /// The numbers, point by point; NaN for missing ones.
    pub values: Vec<f64>,
}

/// The fields of a structured patch, point (i, j) of its block at `i * nv + j`.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchFields {
    /// The patch's name.
    pub patch: String,
    /// Its fields.
    pub fields: Vec<VtkArray>,
}

/// The `PointData` element of arrays already added.
pub(super) fn point_data(arrays: &str) -> String {
    if arrays.is_empty() { String::new() } else { format!("<PointData>\n{arrays}</PointData>\n") }
}
