//! Certificate files, as `netcert verify FILE` checks them. The target seals the text, so that the fuzzer need not keep the hash right; as it
//! stands a text is confirmed only with its seal. Of a confirmed certificate that says `safe` both numbers are 0 or more, and a check that is
//! repeated has the same result.
#![no_main]

use libfuzzer_sys::fuzz_target;
use netcert_base::watch::{Patience, set_patience};
use netcert_files::seal;
use netcert_verify::check;
use serde_json::Value;

fuzz_target!(init: set_patience(Patience::seconds(5, 10)), |text: &str| {
    if seal::body(text).is_err() {
        assert!(!check::certificate(text).confirmed());
    }
    let sealed = seal::sealed_body(text.trim_end().trim_end_matches('}'));
    let report = check::certificate(&sealed);
    if !report.confirmed() {
        return;
    }
    let document: Value = serde_json::from_str(&sealed).expect("what was confirmed");
    if document["safe"] == true {
        let numbers = [&document["rsc_m"], &document["hinge_margin_deg"]];
        assert!(numbers.iter().all(|number| number.as_f64().is_some_and(|number| number >= 0.0)), "{numbers:?}");
    }
    assert_eq!(check::certificate(&sealed), report);
});
