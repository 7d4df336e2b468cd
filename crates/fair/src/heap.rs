/// A heap over the items 0..n that knows where each item stands: the largest key comes first,
/// equal keys in the order of the items, so that results repeat on every machine.
#[derive(Clone, Debug)]
pub(crate) struct Heap {
    keys: Vec<f64>,
    order: Vec<u32>,
    place: Vec<u32>,
}

impl Heap {
    /// A heap of these keys, in O(n).
    pub fn new(keys: Vec<f64>) -> Self {
        let n = keys.len() as u32;
        let mut heap = Self { keys, order: (0..n).collect(), place: (0..n).collect() };
        for at in (0..heap.order.len() / 2).rev() {
            heap.sink(at);
        }
        heap
    }

    /// The first item and its key.
    pub fn top(&self) -> Option<(usize, f64)> {
        self.order.first().map(|&i| (i as usize, self.keys[i as usize]))
    }

    /// Changes a key, in O(log n).
    #[inline]
    pub fn set(&mut self, item: usize, key: f64) {
        let old = std::mem::replace(&mut self.keys[item], key);
        let at = self.place[item] as usize;
        if key > old {
            self.rise(at);
        } else if key < old {
            self.sink(at);
        }
    }

    #[inline(always)]
    fn before(&self, a: u32, b: u32) -> bool {
        let (ka, kb) = (self.keys[a as usize], self.keys[b as usize]);
        ka > kb || (ka == kb && a < b)
    }

    fn rise(&mut self, mut at: usize) {
        let item = self.order[at];
        while at > 0 {
            let up = (at - 1) / 2;
            let above = self.order[up];
            if !self.before(item, above) {
                break;
            }
            self.order[at] = above;
            self.place[above as usize] = at as u32;
            at = up;
        }
        self.order[at] = item;
        self.place[item as usize] = at as u32;
    }

    fn sink(&mut self, mut at: usize) {
        let item = self.order[at];
        let n = self.order.len();
        loop {
            let mut down = 2 * at + 1;
            if down >= n {
                break;
            }
            if down + 1 < n && self.before(self.order[down + 1], self.order[down]) {
                down += 1;
            }
            let below = self.order[down];
            if !self.before(below, item) {
                break;
            }
            self.order[at] = below;
            self.place[below as usize] = at as u32;
            at = down;
        }
        self.order[at] = item;
        self.place[item as usize] = at as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    #[test]
    fn the_top_is_the_first_maximum() {
        let mut random = Random::new(5);
        // Coarse keys: ties are common.
        let mut keys: Vec<f64> = (0..50).map(|_| (random.unit() * 8.0).round()).collect();
        let mut heap = Heap::new(keys.clone());
        for k in 0..2000 {
            let best = (0..50).fold(0, |b, i| if keys[i] > keys[b] { i } else { b });
            assert_eq!(heap.top(), Some((best, keys[best])));
            let item = if k % 3 == 0 { best } else { (k * 7) % 50 };
            keys[item] = (random.unit() * 8.0).round();
            heap.set(item, keys[item]);
        }
        assert_eq!(Heap::new(vec![]).top(), None);
    }
}
