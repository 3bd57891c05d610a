//! `netcert stats --relative-to REF`: on how much road of each verdict a vehicle needs no more room than a reference.
//!
//! The comparison stands in a table and in members of its own. The counts by verdict stay as they are without it.

use std::io::Write;

use netcert::rows::{RelativeCount, SetKey};
use netcert::store::{CertifiedSet, Database};
use netcert::words::{Named, VerdictKind, verdict_words};
use serde_json::{Value, json};

use crate::cli::output::km;
use crate::cli::output::table::Table;

/// The shown sets beside a reference vehicle.
pub(crate) struct Compared<'a> {
    reference: &'a str,
    sets: Vec<(CertifiedSet, Vec<RelativeCount>)>,
}

impl<'a> Compared<'a> {
    /// Reads and compares sets, each named by vehicle and policy.
    pub(crate) fn read<'s>(
        database: &mut Database,
        sets: impl Iterator<Item = SetKey<'s>>,
        reference: &'a str,
    ) -> anyhow::Result<Self> {
        let mut all = Vec::new();
        for SetKey { vehicle, policy } in sets {
            let Some(set) = database.certified_set(vehicle, policy)? else { continue };
            let other = database.reference(&set, reference)?;
            let counts = database.relative_counts(&set, &other)?;
            all.push((set, counts));
        }
        Ok(Self { reference, sets: all })
    }

    /// Prints kilometres by verdict, and how many of them need no more room than the reference.
    pub(crate) fn tell(&self, out: &mut dyn Write) -> anyhow::Result<()> {
        let as_reference = format!(">as {}", self.reference);
        let mut table = Table::new(&["vehicle", "policy", "verdict", ">km", &as_reference, ""]);
        for (set, counts) in &self.sets {
            for kind in VerdictKind::ALL {
                let of = || counts.iter().filter(|count| verdict_words(count.verdict).0 == kind.name());
                // From 0: the sum of no numbers is −0.
                let metres = |sum: f64, count: &RelativeCount| sum + count.length_m;
                let (all, alike) = (of().fold(0.0, metres), of().filter(|count| count.as_reference).fold(0.0, metres));
                if all == 0.0 {
                    continue;
                }
                let words = if alike == 0.0 || *kind == VerdictKind::Safe {
                    String::new()
                } else {
                    format!("{}, but as {}", kind.name(), self.reference)
                };
                let start = [set.vehicle_id.as_str(), set.policy.name(), kind.name()].map(str::to_owned);
                table.row(start.into_iter().chain([km(all), km(alike), words]));
            }
        }
        writeln!(
            out,
            "\nBeside {} on the same road: where no more room is needed. It makes nothing safe.",
            self.reference
        )?;
        Ok(table.write(out, "  ")?)
    }

    fn json(&self) -> Value {
        let row = |set: &CertifiedSet, count: &RelativeCount| {
            let (verdict, reason) = verdict_words(count.verdict);
            json!({
                "vehicle_id": set.vehicle_id, "corridor": set.policy.name(), "verdict": verdict,
                "reason": (!reason.is_empty()).then_some(reason), "as_reference": count.as_reference,
                "edges": count.edges, "length_m": count.length_m,
            })
        };
        self.sets.iter().flat_map(|(set, counts)| counts.iter().map(move |count| row(set, count))).collect()
    }
}

/// The answer with the comparison in members of its own.
pub(crate) fn with_comparison(mut answer: Value, compared: Option<&Compared<'_>>) -> Value {
    if let Some(compared) = compared {
        answer["relative_to"] = json!(compared.reference);
        answer["relative"] = compared.json();
    }
    answer
}
