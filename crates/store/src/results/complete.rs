//! Whether a set has every edge or turn exactly once.

use crate::results::compact::CompactCertificate;

/// Why a set may not be stored: an edge or turn, and what is wrong with it.
pub(crate) type Fault = (u32, &'static str);

/// Checks that the rows, sorted by edge, have every edge exactly once.
pub(crate) fn check_complete(rows: &[CompactCertificate], edges: u32) -> Result<(), Fault> {
    let mut complete = Complete::new(edges);
    rows.iter().for_each(|row| complete.look_at(row));
    complete.finish().map(|_| ())
}

/// Looks at the rows of a set in order, to find whether every edge is there exactly once.
pub(crate) struct Complete {
    edges: u32,
    rows: u32,
    fault: Option<Fault>,
}

impl Complete {
    pub(crate) fn new(edges: u32) -> Self {
        Self { edges, rows: 0, fault: None }
    }

    pub(crate) fn look_at(&mut self, row: &CompactCertificate) {
        self.rows += 1;
        if row.fid != self.rows && self.fault.is_none() {
            let twice = row.fid < self.rows;
            let (fid, detail) =
                if twice { (row.fid, "it has two certificates") } else { (self.rows, "it has no certificate") };
            self.fault = Some((fid.saturating_sub(1), detail));
        }
    }

    /// The number of rows.
    pub(crate) fn finish(self) -> Result<u32, Fault> {
        match self.fault {
            Some(fault) => Err(fault),
            None if self.rows < self.edges => Err((self.rows, "it has no certificate")),
            None if self.rows > self.edges => Err((self.edges, "the network has no such edge")),
            None => Ok(self.rows),
        }
    }
}
