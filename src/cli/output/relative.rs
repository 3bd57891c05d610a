//! The comparison of a row or route with a reference vehicle: in words, as columns and as members.

use std::io::Write;

use netcert::rows::{Cell, CertificateRow, CertificateStanding, Relative};
use netcert::store::{ATTESTED, DRIVABLE_BY, ReferenceCertificates, StoreError};

/// The comparison of a row, if one is asked for.
pub(crate) fn beside(
    reference: &mut Option<ReferenceCertificates<'_>>,
    index: u32,
    certificate: &CertificateRow,
) -> Result<Option<Relative>, StoreError> {
    reference.as_mut().map(|reference| reference.relative(index, CertificateStanding::of(certificate))).transpose()
}

/// What follows the scope of `safe` in an answer that compares.
pub(crate) fn scope(reference: &str) -> String {
    if reference == DRIVABLE_BY {
        return " `as_reference` compares with vehicles that the register of measurements knows to go there, and says nothing elsewhere: by \
                their certificates on the same road, the vehicle needs no more room than one of them. It makes nothing safe and is no \
                permit."
            .to_owned();
    }
    if reference == ATTESTED {
        return " `as_reference` compares with vehicles that a sign on the map, or the register of measurements, says to go there, as far as \
                they are certified in this database, and says nothing elsewhere: by their certificates on the same road, the vehicle needs \
                no more room than one of them. It makes nothing safe and is no permit."
            .to_owned();
    }
    format!(
        " `as_reference` compares with {reference} alone: by their certificates on the same road, the vehicle needs no more room \
         than {reference}. It makes nothing safe and is no permit."
    )
}

/// The additional columns of a table for people: `relative_m`, and a word for `as_reference`.
pub(crate) fn words(relative: Relative) -> [String; 2] {
    let relative_m = relative.relative_m.map_or_else(String::new, |m| format!("{m:+.3} m"));
    let word = match relative {
        Relative { as_reference: true, .. } => "yes",
        Relative { relative_m: Some(_), .. } => "no",
        Relative { relative_m: None, .. } => "",
    };
    [relative_m, word.to_owned()]
}

/// The additional members of a JSON object.
pub(crate) fn members(relative: Relative) -> impl Iterator<Item = (String, serde_json::Value)> {
    let names = Relative::COLUMNS.map(|(name, _)| name.to_owned());
    names.into_iter().zip(relative.cells().map(|cell: Cell<'_>| cell.into()))
}

/// Prints the comparison of a route with a reference in one line.
pub(crate) fn tell(out: &mut dyn Write, id: &str, relative: Relative) -> std::io::Result<()> {
    let Some(relative_m) = relative.relative_m else {
        return writeln!(out, "  relative              no comparison with {id}: it has no RSC on this way");
    };
    let words = match relative_m {
        _ if relative.as_reference => "no more room is needed than it needs here",
        m if m < 0.0 => "more room is needed than it needs here",
        _ => "a hinge, the steering lock or the law stops it here",
    };
    writeln!(out, "  relative     {relative_m:>+8.3} m  beside {id}: {words}")
}
