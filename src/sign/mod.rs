//! Signatures: who certified which data with which program, and that nothing was changed since.
//!
//! A seal is a hash, which anybody can make again. A signature needs the private key. It says who vouches for the content, not that
//! the content is right: [`crate::check`] and [`mod@crate::verify`] judge that. `docs/how-to/sign.md` says which bytes are signed.
//!
//! | file | for |
//! | --- | --- |
//! | `key` | Ed25519 keys in the files of OpenSSL |
//! | `statement` | what a signature says of its signer |
//! | `hex` | bytes as hexadecimal digits |
//! | `document` | certificate files |
//! | `database` | databases |
//!
//! ```
//! # let (folder, path) = netcert_testing::documentation::junction_region();
//! use netcert::sign::{PrivateKey, PublicKey, Signer, check_database, sign_database};
//! use netcert::store::Database;
//!
//! let [private, public] = ["authority.pem", "authority.pub.pem"].map(|name| folder.path().join(name));
//! PrivateKey::generate()?.write_new(&private, &public)?;
//!
//! let signer = Signer::new(Some("Road Authority X"), "2026-11-21T08:00:00.000Z")?;
//! let mut database = Database::open_to_change(&path)?;
//! sign_database(&mut database, &PrivateKey::read(&private)?, &signer)?;
//! database.close()?;
//!
//! let signatures = check_database(&mut Database::open(&path)?, &[PublicKey::read(&public)?])?;
//! assert_eq!(signatures[0].signer.as_deref(), Some("Road Authority X"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A certificate file has its signature inside:
//!
//! ```
//! # use netcert::corridor::Drawn;
//! # use netcert::stet::{Model, Options, certify};
//! # let points = vec![[0.0, 0.0], [60.0, 0.0], [120.0, 15.0]];
//! # let corridor = Drawn { points, width_m: Some(vec![7.0]), ..Drawn::default() }.corridor()?;
//! # let model = Model::new(netcert::vehicle::Catalogue::builtin()?.get("EU-SEMI16.5")?)?;
//! # let (options, never) = (Options::default(), netcert::stop::Stop::never());
//! # let certified = certify(&corridor.corridor, &model, &options, &never)?.expect("stations");
//! # let file = netcert::certificate::text(&corridor, &model, &certified, &options)?;
//! use netcert::sign::{PrivateKey, Refusal, Signer, check_document, sign_document};
//!
//! let key = PrivateKey::generate()?;
//! let signed = sign_document(&file, &key, &Signer::new(None, "2026-11-21T08:00:00.000Z")?)?;
//! assert_eq!(check_document(&signed, &[key.public()])?.key.fingerprint(), key.public().fingerprint());
//!
//! // Another key did not sign it, and the file without a signature has none.
//! let other = PrivateKey::generate()?.public();
//! assert!(matches!(check_document(&signed, &[other]), Err(Refusal::OtherKey { .. })));
//! assert!(matches!(check_document(&file, &[other]), Err(Refusal::Unsigned)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod database;
mod document;
mod hex;
mod key;
mod statement;

pub use database::{check_database, sign_database};
pub use document::{NotSigned, check_document, sign_document};
pub use key::{KeyError, PrivateKey, PublicKey};
pub use statement::{Refusal, SignError, Signed, Signer};
