//! Which points of a study a run computes.

use crate::sweep::compute::Shard;

/// Points of a file; the last file of a study may have fewer.
pub(crate) const PART_LENGTH: u64 = 65_536;
/// Blocks of points for each shard where a file has points of several, so that all have about the same work.
const BLOCKS: u64 = 16;

/// The points of a run: all of its study, or those of a shard, which takes every n-th block of points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Share {
    points: u64,
    /// Number of points of a block: a whole file if there are at least as many files as shards.
    block: u64,
    shard: Shard,
}

impl Share {
    pub(crate) fn new(points: u64, shard: Option<Shard>) -> Self {
        let shard = shard.unwrap_or(Shard { part: 1, of: 1 });
        let block = if points.div_ceil(PART_LENGTH) >= shard.of {
            PART_LENGTH
        } else {
            (points / shard.of.saturating_mul(BLOCKS)).max(1)
        };
        Self {
            points,
            block,
            shard,
        }
    }

    /// The shard; 1/1 for all points.
    pub(crate) fn shard(&self) -> Shard {
        self.shard
    }

    pub(crate) fn contains(&self, point: u64) -> bool {
        point < self.points && (point / self.block) % self.shard.of == self.shard.part - 1
    }

    /// Number of points.
    pub(crate) fn count(&self) -> u64 {
        let Shard { part, of } = self.shard;
        let blocks = self.points.div_ceil(self.block);
        if part > blocks {
            return 0;
        }
        let of_shard = (blocks - part) / of + 1;
        let has_last = (blocks - part).is_multiple_of(of);
        let missing = blocks * self.block - self.points;
        of_shard * self.block - if has_last { missing } else { 0 }
    }

    /// The point at a position among those of the share.
    pub(crate) fn point(&self, position: u64) -> u64 {
        let block = (position / self.block) * self.shard.of + self.shard.part - 1;
        block * self.block + position % self.block
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_is_in_one_shard() {
        for points in [1, 2, 3, 200, 65_536, 65_537, 200_000, 700_000] {
            for of in [1, 2, 3, 7, 64, u64::MAX] {
                let parts =
                    (1..=of.min(64)).map(|part| Share::new(points, Some(Shard { part, of })));
                let mut all: Vec<u64> = Vec::new();
                for share in parts {
                    let own: Vec<u64> = (0..points).filter(|k| share.contains(*k)).collect();
                    assert_eq!(share.count(), own.len() as u64, "{share:?}");
                    let by_position: Vec<u64> =
                        (0..share.count()).map(|p| share.point(p)).collect();
                    assert_eq!(own, by_position, "{share:?}");
                    all.extend(own);
                }
                all.sort_unstable();
                let expected = if of == u64::MAX {
                    points.min(64)
                } else {
                    points
                };
                assert!(
                    all.into_iter().eq(0..expected),
                    "{points} points, {of} shards"
                );
            }
        }
    }

    #[test]
    fn shards_have_about_the_same_work() {
        let counts = |points, of| {
            let share = |part| Share::new(points, Some(Shard { part, of })).count();
            let counts = (1..=of).map(share);
            [counts.clone().min(), counts.max()].map(Option::unwrap_or_default)
        };
        for (points, of) in [(10, 3), (200, 3), (1000, 7), (60_000, 8), (400_000, 64)] {
            let [least, most] = counts(points, of);
            assert!(
                most - least <= 1 + points / of / 16,
                "{points}, {of}: {least} to {most}"
            );
        }
        // Whole files.
        assert_eq!(counts(4 * PART_LENGTH, 3), [PART_LENGTH, 2 * PART_LENGTH]);
    }
}
