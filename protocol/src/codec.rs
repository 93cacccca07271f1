//! The one codec: MessagePack maps, with the type and its version in the encoding.

use crate::VERSION;
use serde::{Serialize, de::DeserializeOwned};
use sha2::{Digest, Sha256};
use thiserror::Error;

/// A message of the bus.
pub trait Message: Serialize + DeserializeOwned {
    /// Its name in the encoding `application/msgpack;<name>.v1`.
    const NAME: &'static str;
}

/// Declares messages and their names.
macro_rules! messages {
    ($($type:ty => $name:literal),+ $(,)?) => {
        $(impl $crate::codec::Message for $type {
            const NAME: &'static str = $name;
        })+
    };
}
pub(crate) use messages;

/// Why bytes are not the message expected.
#[derive(Debug, Error)]
pub enum CodecError {
    /// Another type or another version.
    #[error("this is `{found}`, expected `{expected}`: the other side runs another version of Isola, or is not Isola")]
    Encoding {
        /// What came.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// Malformed.
    #[error("malformed `{name}` message: {source}")]
    Malformed {
        /// Name of the message.
        name: &'static str,
        /// Where and why.
        source: rmp_serde::decode::Error,
    },
}

/// Encoding of a message.
pub fn encoding<M: Message>() -> String {
    format!("application/msgpack;{}.v{VERSION}", M::NAME)
}

/// Bytes of a message.
pub fn encode<M: Message>(message: &M) -> Vec<u8> {
    rmp_serde::to_vec_named(message)
        .expect("messages are maps, sequences and numbers: all of them have MessagePack forms")
}

/// The message in `bytes` that came with `encoding`.
pub fn decode<M: Message>(bytes: &[u8], found: &str) -> Result<M, CodecError> {
    let expected = encoding::<M>();
    if found != expected {
        return Err(CodecError::Encoding { found: found.to_string(), expected });
    }
    decode_stored(bytes)
}

/// The message in `bytes` of a store.
pub fn decode_stored<M: Message>(bytes: &[u8]) -> Result<M, CodecError> {
    rmp_serde::from_slice(bytes).map_err(|source| CodecError::Malformed { name: M::NAME, source })
}

/// SHA-256 in hexadecimal digits.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
