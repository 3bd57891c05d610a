//! Signs databases, and checks their signatures.
//!
//! What is signed is a statement: a line of JSON with the signer, the extract, every certified vehicle with its settings, and a hash of
//! every table. It is stored as it was signed, in a table that the statement does not cover.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::hex::{hex, unhex};
use super::key::{PrivateKey, PublicKey};
use super::statement::{Refusal, SignError, Signed, Signer};
use crate::store::{Database, SignatureRecord};

/// Signs what the database holds now. An older signature of the same key is replaced.
///
/// # Errors
/// Nothing is certified in the database, or it cannot be read or changed.
pub fn sign_database(database: &mut Database, key: &PrivateKey, signer: &Signer) -> Result<(), SignError> {
    let content = database.content()?;
    let sets = sets(database)?;
    if sets.is_empty() {
        return Err(SignError::NothingCertified { path: database.path().to_owned() });
    }
    let mut statement = serde_json::Map::new();
    // A certificate file begins with another member, so that no statement can be taken for one.
    statement.insert("signed".to_owned(), json!("netcert database"));
    statement.extend(signer.members(key));
    statement.insert("runs".to_owned(), Value::Array(runs(database)?));
    statement.insert("sets".to_owned(), Value::Array(sets));
    statement.insert("content".to_owned(), json!(content));
    let statement = Value::Object(statement).to_string();
    let value = hex(&key.sign(statement.as_bytes()));
    let record = SignatureRecord { public_key: hex(&key.public().to_bytes()), statement, value };
    Ok(database.add_signature(&content, &record)?)
}

/// Checks the signatures of a database. With `keys`: the first one that holds and is of one of them. Without: each one, with the key that
/// it names itself; there is at least one.
///
/// # Errors
/// See [`Refusal`]. Without `keys` all signatures must hold.
pub fn check_database(database: &mut Database, keys: &[PublicKey]) -> Result<Vec<Signed>, Refusal> {
    let records = database.signatures()?;
    let mut first = None;
    let mut held = Vec::new();
    let mut content: Option<BTreeMap<String, String>> = None;
    for record in &records {
        let checked = of_key(record, keys).and_then(|(signed, of)| {
            let now = match content.take() {
                Some(now) => now,
                None => database.content()?,
            };
            compare(signed, &of, content.insert(now))
        });
        match checked {
            Ok(signed) => held.push(signed),
            // Of the given keys a later signature may hold. What is wrong with a given key's own signature says more than another key.
            Err(refusal) if matches!(first, None | Some(Refusal::OtherKey { .. })) => first = Some(refusal),
            Err(_) => {}
        }
    }
    match first {
        Some(refusal) if keys.is_empty() || held.is_empty() => Err(refusal),
        _ if held.is_empty() => Err(Refusal::Unsigned),
        _ => match database.integrity()? {
            None => Ok(held),
            Some(detail) => Err(held[0].changed(vec![detail])),
        },
    }
}

/// The signer of a statement whose signature holds, and the hashes in it.
fn of_key(record: &SignatureRecord, keys: &[PublicKey]) -> Result<(Signed, Value), Refusal> {
    let unreadable = || Refusal::Unreadable("the table signature".to_owned());
    let mut statement: Value = serde_json::from_str(&record.statement).map_err(|_| unreadable())?;
    let signed = Signed::read(&statement)?;
    signed.among(keys)?;
    let value = unhex(&record.value).ok_or_else(unreadable)?;
    let agrees = record.public_key == hex(&signed.key.to_bytes()) && statement["signed"] == "netcert database";
    if !agrees || !signed.key.signed(record.statement.as_bytes(), &value) {
        return Err(signed.changed(vec!["the signature itself".to_owned()]));
    }
    Ok((signed, statement["content"].take()))
}

/// Compares the hashes of a statement with those of the tables.
fn compare(signed: Signed, of: &Value, now: &BTreeMap<String, String>) -> Result<Signed, Refusal> {
    let Some(of) = of.as_object() else { return Err(Refusal::Unreadable("content".to_owned())) };
    let differs = |table: &&String| of.get(*table).and_then(Value::as_str) != Some(now[*table].as_str());
    let mut changed: Vec<String> = now.keys().filter(differs).cloned().collect();
    changed.extend(of.keys().filter(|table| !now.contains_key(*table)).cloned());
    if changed.is_empty() { Ok(signed) } else { Err(signed.changed(changed)) }
}

/// The runs that made the database: the extract with its hash, and the program.
fn runs(database: &mut Database) -> Result<Vec<Value>, SignError> {
    let runs = database.runs()?.into_iter().map(|(run, _)| {
        json!({
            "command": run.command,
            "input_name": run.input_name,
            "input_blake3": run.input_blake3,
            "replication_timestamp": run.replication_timestamp,
            "netcert_version": run.netcert_version,
        })
    });
    Ok(runs.collect())
}

/// What is certified: each vehicle by the hash of its definition, with the settings of its certificates.
fn sets(database: &mut Database) -> Result<Vec<Value>, SignError> {
    let mut sets = Vec::new();
    for set in database.certified()? {
        let settings: Value = serde_json::from_str(set.written_settings()?).unwrap_or_default();
        sets.push(json!({
            "vehicle_id": set.vehicle_id,
            "vehicle_blake3": set.vehicle_blake3,
            "settings": settings,
        }));
    }
    Ok(sets)
}
