//! Identifiers as small numbers.

/// An identifier of one [`Program`](super::Program); equal names have equal symbols.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Symbol(pub u32);

/// All names of a program, each once, in order of first appearance (reserved words first).
#[derive(Clone, Debug)]
pub(crate) struct Interner {
    text: String,
    /// Byte range of each symbol in `text`.
    ranges: Vec<(u32, u32)>,
    /// Open addressing, symbol + 1; 0 is an empty slot. The length is a power of two.
    table: Vec<u32>,
}

fn hash(name: &[u8]) -> u64 {
    const FACTOR: u64 = 0x517c_c1b7_2722_0a95;
    let mut state = name.len() as u64;
    let mut step = |word: u64| state = (state.rotate_left(5) ^ word).wrapping_mul(FACTOR);
    let chunks = name.chunks_exact(8);
    let rest = chunks.remainder();
    for chunk in chunks {
        step(u64::from_le_bytes(chunk.try_into().expect("chunks of eight bytes")));
    }
    let mut last = [0; 8];
    last[..rest.len()].copy_from_slice(rest);
    step(u64::from_le_bytes(last));
    state ^ (state >> 29)
}

impl Interner {
    pub(crate) fn new() -> Self {
        Interner { text: String::new(), ranges: Vec::new(), table: vec![0; 256] }
    }

    pub(crate) fn intern(&mut self, name: &str) -> Symbol {
        if self.ranges.len() * 2 >= self.table.len() {
            self.grow();
        }
        let slot = self.slot(name);
        if self.table[slot] == 0 {
            let start = self.text.len() as u32;
            self.text.push_str(name);
            self.ranges.push((start, self.text.len() as u32));
            self.table[slot] = self.ranges.len() as u32;
        }
        Symbol(self.table[slot] - 1)
    }

    pub(crate) fn find(&self, name: &str) -> Option<Symbol> {
        self.table[self.slot(name)].checked_sub(1).map(Symbol)
    }

    pub(crate) fn name(&self, symbol: Symbol) -> &str {
        let (start, end) = self.ranges[symbol.0 as usize];
        &self.text[start as usize..end as usize]
    }

    pub(crate) fn len(&self) -> usize {
        self.ranges.len()
    }

    fn slot(&self, name: &str) -> usize {
        let mask = self.table.len() - 1;
        let mut slot = hash(name.as_bytes()) as usize & mask;
        while self.table[slot] != 0 && self.name(Symbol(self.table[slot] - 1)) != name {
            slot = (slot + 1) & mask;
        }
        slot
    }

    fn grow(&mut self) {
        self.table = vec![0; self.table.len() * 4];
        let mask = self.table.len() - 1;
        for (at, (start, end)) in self.ranges.iter().enumerate() {
            let name = &self.text.as_bytes()[*start as usize..*end as usize];
            let mut slot = hash(name) as usize & mask;
            while self.table[slot] != 0 {
                slot = (slot + 1) & mask;
            }
            self.table[slot] = at as u32 + 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn same_name_same_symbol_through_growth() {
        let mut interner = Interner::new();
        let names: Vec<String> = (0..5000).map(|i| format!("P{i}")).collect();
        let symbols: Vec<Symbol> = names.iter().map(|name| interner.intern(name)).collect();
        for (name, symbol) in names.iter().zip(&symbols) {
            assert_eq!(interner.intern(name), *symbol);
            assert_eq!(interner.find(name), Some(*symbol));
            assert_eq!(interner.name(*symbol), name);
        }
        assert_eq!(interner.len(), 5000);
        assert_eq!(interner.find("absent"), None);
    }
}
