//! The one codec: MessagePack maps, with the type and its version in the encoding.

use crate::VERSION;
use serde::Serialize;
use sha2::{Digest, Sha256};
use thiserror::Error;

/// A message of the bus. Both ways are compiled once, here, and not again wherever a message is sent or read.
pub trait Message: Sized {
    /// Its name in the encoding `application/msgpack;<name>.v11`.
    const NAME: &'static str;

    /// Its bytes.
    fn to_bytes(&self) -> Vec<u8>;

    /// The message in these bytes.
    ///
    /// # Errors
    /// If they are none of this type.
    fn from_bytes(bytes: &[u8]) -> Result<Self, rmp_serde::decode::Error>;
}

/// Declares messages and their names.
macro_rules! messages {
    ($($type:ty => $name:literal),+ $(,)?) => {
        $(impl $crate::codec::Message for $type {
            const NAME: &'static str = $name;

            fn to_bytes(&self) -> Vec<u8> {
                $crate::codec::encode_part(self)
            }

            fn from_bytes(bytes: &[u8]) -> Result<Self, rmp_serde::decode::Error> {
                rmp_serde::from_slice(bytes)
            }
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
    message.to_bytes()
}

/// Bytes of a message or of a part of one.
pub(crate) fn encode_part<T: Serialize>(part: &T) -> Vec<u8> {
    let mut bytes = Vec::new();
    encode_onto(&mut bytes, part);
    bytes
}

/// Bytes of a message or of a part of one, at the end of others. They are counted first, which takes next to no time: to grow
/// step by step to megabytes takes longer than to write them.
pub(crate) fn encode_onto<T: Serialize>(bytes: &mut Vec<u8>, part: &T) {
    let mut count = Count(0);
    let counted = rmp_serde::encode::write_named(&mut count, part);
    bytes.reserve(count.0);
    counted
        .and_then(|()| rmp_serde::encode::write_named(bytes, part))
        .expect("messages are maps, sequences and numbers: all of them have MessagePack forms");
}

/// Counts bytes that are written.
struct Count(usize);

impl std::io::Write for Count {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0 += bytes.len();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// The message in `bytes` that came with `encoding`.
///
/// # Errors
/// If it is of another kind or version, or no MessagePack of this kind.
pub fn decode<M: Message>(bytes: &[u8], found: &str) -> Result<M, CodecError> {
    let expected = encoding::<M>();
    if found != expected {
        return Err(CodecError::Encoding { found: found.to_string(), expected });
    }
    decode_stored(bytes)
}

/// Part of a message in `bytes` that came with `encoding`: fields that `P` has. The others are passed over, and take no memory.
pub(crate) fn decode_part<M: Message, P: serde::de::DeserializeOwned>(
    bytes: &[u8],
    found: &str,
) -> Result<P, CodecError> {
    let expected = encoding::<M>();
    if found != expected {
        return Err(CodecError::Encoding { found: found.to_string(), expected });
    }
    rmp_serde::from_slice(bytes).map_err(|source| CodecError::Malformed { name: M::NAME, source })
}

/// The message in `bytes` of a store.
///
/// # Errors
/// If they are no MessagePack of this kind.
pub fn decode_stored<M: Message>(bytes: &[u8]) -> Result<M, CodecError> {
    M::from_bytes(bytes).map_err(|source| CodecError::Malformed { name: M::NAME, source })
}

/// SHA-256 in hexadecimal digits.
pub fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// Bytes in hexadecimal digits.
pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
