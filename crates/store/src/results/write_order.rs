//! Certificates and plans that wait until they can be written in order. Strokes finish in any order and for several vehicles at the same
//! time. Inserting certificates in that order would leave half-empty pages, and the file would depend on the threads.

use std::io;
use std::iter::Peekable;
use std::path::Path;

use netcert_rows::StoredPlan;

use crate::columns::set_no::SetNo;
use crate::file::companions::sorter;
use crate::results::compact::CompactCertificate;
use netcert_files::sorter::{Sorted, Sorter};

/// Set, and index of the edge or turn.
type Key = (SetNo, u32);

/// Certificates of edges or of turns, with their plans.
pub(crate) struct CertificateSorter {
    certificates: Sorter<Key, CompactCertificate>,
    plans: Sorter<Key, StoredPlan>,
}

impl CertificateSorter {
    /// Nothing waits yet. Temporary files are made at `path` with a word after it.
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        let certificates = sorter(path, "-certificates")?;
        Ok(Self { certificates, plans: sorter(path, "-plans")? })
    }

    pub(crate) fn certificate(&mut self, set: SetNo, packed: CompactCertificate) -> io::Result<()> {
        self.certificates.push((set, packed.fid), &packed)
    }

    pub(crate) fn plan(&mut self, set: SetNo, plan: &StoredPlan) -> io::Result<()> {
        self.plans.push((set, plan.at), plan)
    }

    /// The same with other indices. Temporary files are made at `path` with a word after it.
    pub(crate) fn renumbered(self, path: &Path, numbers: &[u32]) -> io::Result<Self> {
        let mut new = Self::create(path)?;
        let number = |index: u32| {
            let number = numbers.get(index as usize).copied();
            number.ok_or_else(|| io::Error::other(format!("there is a certificate of turn {index}, but no such turn")))
        };
        for row in self.certificates.sorted()? {
            let ((set, fid), packed) = row?;
            new.certificate(set, CompactCertificate { fid: number(fid - 1)? + 1, ..packed })?;
        }
        for row in self.plans.sorted()? {
            let ((set, at), plan) = row?;
            new.plan(set, &StoredPlan { at: number(at)?, ..plan })?;
        }
        Ok(new)
    }

    /// Certificates and plans, each set by set.
    pub(crate) fn sorted(self) -> io::Result<(BySet<CompactCertificate>, BySet<StoredPlan>)> {
        Ok((BySet(self.certificates.sorted()?.peekable()), BySet(self.plans.sorted()?.peekable())))
    }
}

/// Rows of sets, one set after the other.
pub(crate) struct BySet<T>(Peekable<Sorted<Key, T>>)
where
    Sorted<Key, T>: Iterator<Item = io::Result<(Key, T)>>;

impl<T> BySet<T>
where
    Sorted<Key, T>: Iterator<Item = io::Result<(Key, T)>>,
{
    /// The set of the next row. `None` if there is none.
    pub(crate) fn next_set(&mut self) -> io::Result<Option<SetNo>> {
        let set = self.0.peek().and_then(|row| row.as_ref().ok()).map(|((set, _), _)| *set);
        match set {
            Some(set) => Ok(Some(set)),
            None => self.0.next().transpose().map(|_| None),
        }
    }

    /// The rows that come next, as long as they are of a set.
    pub(crate) fn of(&mut self, set: SetNo) -> impl Iterator<Item = io::Result<T>> {
        let next = move || self.0.next_if(|row| row.as_ref().is_ok_and(|((of, _), _)| *of == set) || row.is_err());
        std::iter::from_fn(next).map(|row| row.map(|(_, row)| row))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::osm::facts::Policy;
    use crate::verdict::{UnknownReason, Verdict};
    use netcert_rows::Conclusion;

    fn set(vehicle_no: u32, policy: Policy) -> SetNo {
        SetNo { vehicle_no, policy }
    }

    #[test]
    fn sets_come_back_in_order_whatever_the_order_they_came_in() {
        let folder = tempfile::tempdir().unwrap();
        let mut waiting = CertificateSorter::create(&folder.path().join("edges")).unwrap();
        let edges = 10_007_u32;
        for i in 0..edges {
            for set in [set(3, Policy::Lane), set(1, Policy::Carriageway), set(1, Policy::Lane)] {
                // 4001 and 10,007 share no factor, so every edge comes once, in a scattered order.
                let edge = (i * 4001 + set.vehicle_no) % edges;
                let none = Conclusion::bare(Verdict::Unknown(UnknownReason::Cut));
                let packed = CompactCertificate::conclusion(&none, edge).unwrap();
                waiting.certificate(set, packed).unwrap();
                if edge.is_multiple_of(10) {
                    waiting.plan(set, &StoredPlan::new(edge, &[1, 2]).unwrap()).unwrap();
                }
            }
        }
        let backwards: Vec<u32> = (0..edges).rev().collect();
        let renumbered = waiting.renumbered(&folder.path().join("again"), &backwards).unwrap();
        let (mut certificates, mut plans) = renumbered.sorted().unwrap();
        for expected in [set(1, Policy::Lane), set(1, Policy::Carriageway), set(3, Policy::Lane)] {
            assert_eq!(certificates.next_set().unwrap(), Some(expected));
            assert!(certificates.of(expected).map(|row| row.unwrap().fid).eq(1..=edges));
            assert!(plans.of(expected).map(|plan| plan.unwrap().at).eq((0..edges).filter(|at| at % 10 == 6)));
        }
        assert_eq!(certificates.next_set().unwrap(), None);
        assert!(plans.next_set().unwrap().is_none());
    }
}
