//! Signatures: who certified which data with which program, and that nothing was changed since.
//!
//! A seal is a hash, which anybody can make again. A signature needs the private key. It says who vouches for the content, not that
//! the content is right: [`crate::check`] and [`mod@crate::verify`] judge that. `docs/how-to/sign.md` says which bytes are signed.
//!
//! | file | for |
//! | --- | --- |
//! | `key` | Ed25519 keys in the files of OpenSSL |
//! | `statement` | what a signature says of its signer |
//! | `document` | certificate files |
//! | `database` | databases |

mod database;
mod document;
mod key;
mod statement;

pub use database::{check_database, sign_database};
pub use document::{NotSigned, check_document, sign_document};
pub use key::{KeyError, PrivateKey, PublicKey};
pub use statement::{Refusal, SignError, Signed, Signer};
