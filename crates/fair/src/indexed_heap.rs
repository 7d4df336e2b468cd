//! A heap of keys that can be changed by index, for the next knot to remove.

/// A heap over the items 0..n with the position of each: the largest key comes first, equal keys in
/// the order of the items, so that results are reproducible.
///
/// A 4-ary heap with keys beside their items has half the levels of a binary heap and one cache
/// line for a node's children, which dominates at a million items.
#[derive(Clone, Debug)]
pub(crate) struct IndexedHeap {
    order: Vec<(f64, u32)>,
    place: Vec<u32>,
}

const CHILDREN: usize = 4;

#[inline(always)]
fn before(a: (f64, u32), b: (f64, u32)) -> bool {
    a.0 > b.0 || (a.0 == b.0 && a.1 < b.1)
}

impl IndexedHeap {
    /// A heap of these keys, in O(n).
    pub fn new(keys: Vec<f64>) -> Self {
        let n = keys.len() as u32;
        let mut heap =
            Self { order: keys.into_iter().zip(0..n).collect(), place: (0..n).collect() };
        for at in (0..heap.order.len().div_ceil(CHILDREN)).rev() {
            heap.sink(at);
        }
        heap
    }

    /// The first item and its key.
    pub fn top(&self) -> Option<(usize, f64)> {
        self.order.first().map(|&(key, i)| (i as usize, key))
    }

    /// Changes a key, in O(log n).
    #[inline]
    pub fn set(&mut self, item: usize, key: f64) {
        let at = self.place[item] as usize;
        let old = std::mem::replace(&mut self.order[at].0, key);
        if key > old {
            self.rise(at);
        } else if key < old {
            self.sink(at);
        }
    }

    #[inline(always)]
    fn put(&mut self, at: usize, entry: (f64, u32)) {
        self.order[at] = entry;
        self.place[entry.1 as usize] = at as u32;
    }

    fn rise(&mut self, mut at: usize) {
        let entry = self.order[at];
        while at > 0 {
            let up = (at - 1) / CHILDREN;
            if !before(entry, self.order[up]) {
                break;
            }
            self.put(at, self.order[up]);
            at = up;
        }
        self.put(at, entry);
    }

    fn sink(&mut self, mut at: usize) {
        let entry = self.order[at];
        loop {
            let first = CHILDREN * at + 1;
            let Some(children) = self.order.get(first..) else { break };
            let children = &children[..children.len().min(CHILDREN)];
            if children.is_empty() {
                break;
            }
            let mut best = 0;
            for k in 1..children.len() {
                if before(children[k], children[best]) {
                    best = k;
                }
            }
            if !before(children[best], entry) {
                break;
            }
            self.put(at, children[best]);
            at = first + best;
        }
        self.put(at, entry);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use moldloft_testing::Lcg;

    #[test]
    fn the_top_is_the_first_maximum() {
        let mut random = Lcg::new(5);
        // Coarse keys: ties are common.
        let mut keys: Vec<f64> = (0..50).map(|_| (random.centred() * 8.0).round()).collect();
        let mut heap = IndexedHeap::new(keys.clone());
        for k in 0..2000 {
            let best = (0..50).fold(0, |b, i| if keys[i] > keys[b] { i } else { b });
            assert_eq!(heap.top(), Some((best, keys[best])));
            let item = if k % 3 == 0 { best } else { (k * 7) % 50 };
            keys[item] = (random.centred() * 8.0).round();
            heap.set(item, keys[item]);
        }
        assert_eq!(IndexedHeap::new(vec![]).top(), None);
    }
}
