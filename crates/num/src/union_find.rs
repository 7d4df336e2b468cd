//! Sets joined pair by pair (Tarjan 1975, with path halving).
//!
//! The smallest member represents its set, so results do not depend on the order of the joins.

/// A partition of the numbers 0 .. n.
#[derive(Clone, Debug, Default)]
pub struct UnionFind {
    above: Vec<u32>,
}

impl UnionFind {
    /// `n` sets with one number each.
    pub fn new(n: usize) -> Self {
        Self { above: (0..n as u32).collect() }
    }

    /// Adds a set with one number, which is returned.
    pub fn push(&mut self) -> u32 {
        self.above.push(self.above.len() as u32);
        self.above.len() as u32 - 1
    }

    /// The smallest member of the set of `k`.
    pub fn find<M: MemberIndex>(&mut self, k: M) -> M {
        let mut k = k.index();
        while self.above[k] as usize != k {
            let next = self.above[self.above[k] as usize];
            self.above[k] = next;
            k = next as usize;
        }
        M::of(k)
    }

    /// Merges the sets of `a` and `b`.
    pub fn join<M: MemberIndex>(&mut self, a: M, b: M) {
        let (a, b) = (self.find(a).index(), self.find(b).index());
        self.above[a.max(b)] = a.min(b) as u32;
    }

    /// True when `a` and `b` are in one set.
    pub fn same<M: MemberIndex>(&mut self, a: M, b: M) -> bool {
        self.find(a).index() == self.find(b).index()
    }
}

/// Type of the members' numbers.
pub trait MemberIndex: Copy {
    /// The number.
    fn index(self) -> usize;
    /// The member of that number.
    fn of(index: usize) -> Self;
}

impl MemberIndex for u32 {
    fn index(self) -> usize {
        self as usize
    }

    fn of(index: usize) -> Self {
        index as u32
    }
}

impl MemberIndex for usize {
    fn index(self) -> usize {
        self
    }

    fn of(index: usize) -> Self {
        index
    }
}

/// A partition of the numbers 0 .. n into sets whose members have the same or opposite signs, such
/// as patches that face the same side or not.
#[derive(Clone, Debug, Default)]
pub struct SignedUnionFind {
    /// Another member of the set, and whether this one is opposite to it.
    above: Vec<(usize, bool)>,
}

impl SignedUnionFind {
    /// `n` sets of one number each.
    pub fn new(n: usize) -> Self {
        Self { above: (0..n).map(|k| (k, false)).collect() }
    }

    /// The smallest member of the set of `k`, and true if `k` has the opposite sign.
    pub fn find(&mut self, k: usize) -> (usize, bool) {
        let mut chain = Vec::new();
        let mut at = k;
        while self.above[at].0 != at {
            chain.push(at);
            at = self.above[at].0;
        }
        let mut opposite = false;
        for &link in chain.iter().rev() {
            opposite ^= self.above[link].1;
            self.above[link] = (at, opposite);
        }
        (at, opposite)
    }

    /// Merges the sets of `p` and `q` with the same or `opposite` signs. Numbers already in one set
    /// keep their signs: a twisted band has no sides.
    pub fn join(&mut self, p: usize, q: usize, opposite: bool) {
        let ((a, p_opposite), (b, q_opposite)) = (self.find(p), self.find(q));
        if a != b {
            self.above[a.max(b)] = (a.min(b), p_opposite ^ q_opposite ^ opposite);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_member_stands_for_the_set() {
        let mut sets = UnionFind::new(6);
        for (a, b) in [(5_u32, 3), (4, 5), (3, 4)] {
            sets.join(a, b);
        }
        assert_eq!([0, 1, 2, 3, 4, 5].map(|k: u32| sets.find(k)), [0, 1, 2, 3, 3, 3]);
        sets.join(4_usize, 1);
        assert!(sets.same(1_u32, 3) && !sets.same(0_u32, 1));
        assert_eq!(sets.find(5_usize), 1);
        assert_eq!(sets.push(), 6);
        assert_eq!(sets.find(6_u32), 6);
    }

    #[test]
    fn signs_multiply_along_chains() {
        let mut sets = SignedUnionFind::new(4);
        sets.join(3, 2, true);
        sets.join(2, 1, true);
        assert_eq!([1, 2, 3].map(|k| sets.find(k)), [(1, false), (1, true), (1, false)]);
        // A contradiction changes nothing.
        sets.join(1, 3, true);
        assert_eq!(sets.find(3), (1, false));
        assert_eq!(sets.find(0), (0, false));
    }
}
