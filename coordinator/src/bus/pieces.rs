//! Large messages that come in pieces: kept until they are whole, no more bytes at a time than there is room for.

use super::held::Held;
use protocol::pieces::{Piece, PieceReply};
use std::collections::HashMap;
use std::sync::atomic::AtomicUsize;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use zenoh::bytes::ZBytes;
use zenoh::query::Query;

/// What nothing has come of for so long is dropped: who sent it is gone, or begins again.
const FORGOTTEN: Duration = Duration::from_secs(60);

/// Messages of which there are pieces.
pub(super) struct Pieces {
    /// Largest message, bytes; as much room is there for all of them.
    most: usize,
    held: Arc<AtomicUsize>,
    partial: Mutex<HashMap<String, Partial>>,
}

/// What has come of a message.
struct Partial {
    bytes: Vec<u8>,
    is_here: Vec<bool>,
    heard: Instant,
    _held: Held,
}

/// What a payload that has come is.
#[derive(Debug, PartialEq)]
pub(super) enum Arrived {
    /// A message.
    Whole(ZBytes),
    /// Of a message of so many bytes, more than is taken.
    TooLarge(usize),
    /// A piece, answered with this.
    Piece(PieceReply),
}

impl Pieces {
    /// Puts messages of at most so many bytes together.
    pub fn new(most: usize) -> Self {
        Self { most, held: Arc::default(), partial: Mutex::default() }
    }

    /// Takes what came with a query.
    ///
    /// # Errors
    /// If it is not the piece that it claims to be.
    pub fn take_from(&self, query: &Query) -> Result<Arrived, String> {
        self.take(query.payload().cloned().unwrap_or_default(), query.attachment(), Instant::now())
    }

    fn take(&self, payload: ZBytes, attached: Option<&ZBytes>, now: Instant) -> Result<Arrived, String> {
        let Some(attached) = attached else {
            let size = payload.len();
            return Ok(if size > self.most { Arrived::TooLarge(size) } else { Arrived::Whole(payload) });
        };
        let piece = Piece::read(attached).map_err(|error| error.to_string())?;
        if piece.size > self.most {
            return Ok(Arrived::TooLarge(piece.size));
        }
        let bytes = piece.bytes();
        if bytes.is_empty() || bytes.len() != payload.len() {
            return Err(format!(
                "piece {} of a message of {} bytes has {} bytes, not {}",
                piece.number,
                piece.size,
                payload.len(),
                bytes.len()
            ));
        }
        let mut all = self.partial.lock().unwrap_or_else(PoisonError::into_inner);
        all.retain(|_, partial| now.saturating_duration_since(partial.heard) < FORGOTTEN);
        if !all.contains_key(&piece.message) {
            let Some(held) = Held::of(&self.held, piece.size, self.most) else {
                return Ok(Arrived::Piece(PieceReply::Busy));
            };
            let (bytes, is_here) = (vec![0; piece.size], vec![false; piece.count()]);
            all.insert(piece.message.clone(), Partial { bytes, is_here, heard: now, _held: held });
        }
        let partial = all.get_mut(&piece.message).expect("it is there, or was put there");
        if partial.bytes.len() != piece.size {
            return Err(format!("a message of {} bytes has become one of {}", partial.bytes.len(), piece.size));
        }
        partial.bytes[bytes].copy_from_slice(&payload.to_bytes());
        (partial.is_here[piece.number], partial.heard) = (true, now);
        if partial.is_here.iter().all(|is_here| *is_here) {
            let bytes = all.remove(&piece.message).map(|partial| partial.bytes).unwrap_or_default();
            return Ok(Arrived::Whole(ZBytes::from(bytes)));
        }
        let is_last = piece.number + 1 == piece.count();
        Ok(Arrived::Piece(if is_last { PieceReply::Missing } else { PieceReply::Taken }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::codec::encode;
    use protocol::pieces::PIECE;

    const SIZE: usize = 2 * PIECE + 5;

    /// A piece of a message of zeros, ones and twos.
    fn piece(message: &str, number: usize) -> (ZBytes, ZBytes) {
        let piece = Piece { message: message.into(), number, size: SIZE };
        (ZBytes::from(vec![number as u8; piece.bytes().len()]), ZBytes::from(encode(&piece)))
    }

    fn take(pieces: &Pieces, (payload, attached): (ZBytes, ZBytes), now: Instant) -> Result<Arrived, String> {
        pieces.take(payload, Some(&attached), now)
    }

    fn whole() -> Vec<u8> {
        let mut bytes = vec![0; SIZE];
        bytes[PIECE..2 * PIECE].fill(1);
        bytes[2 * PIECE..].fill(2);
        bytes
    }

    #[test]
    fn pieces_become_the_message() {
        let (pieces, now) = (Pieces::new(SIZE), Instant::now());
        let taken = Ok(Arrived::Piece(PieceReply::Taken));
        // In any order, and twice.
        for number in [1, 0, 0] {
            assert_eq!(take(&pieces, piece("a", number), now), taken);
        }
        assert_eq!(take(&pieces, piece("a", 2), now), Ok(Arrived::Whole(ZBytes::from(whole()))));
        // Nothing of it is left.
        assert_eq!(take(&pieces, piece("a", 2), now), Ok(Arrived::Piece(PieceReply::Missing)));
    }

    #[test]
    fn there_is_room_for_so_much() {
        let (pieces, now) = (Pieces::new(SIZE), Instant::now());
        assert_eq!(take(&pieces, piece("a", 0), now), Ok(Arrived::Piece(PieceReply::Taken)));
        assert_eq!(take(&pieces, piece("b", 0), now), Ok(Arrived::Piece(PieceReply::Busy)));
        let later = now + FORGOTTEN;
        assert_eq!(take(&pieces, piece("b", 0), later), Ok(Arrived::Piece(PieceReply::Taken)));
        assert_eq!(Pieces::new(SIZE - 1).take(ZBytes::from(whole()), None, now), Ok(Arrived::TooLarge(SIZE)));
        assert_eq!(take(&Pieces::new(SIZE - 1), piece("a", 0), now), Ok(Arrived::TooLarge(SIZE)));
    }

    #[test]
    fn what_is_no_piece_is_refused() {
        let (pieces, now) = (Pieces::new(10 * SIZE), Instant::now());
        assert!(take(&pieces, (ZBytes::from(vec![0; 7]), piece("a", 0).1), now).is_err());
        assert!(take(&pieces, (ZBytes::new(), piece("a", 3).1), now).is_err());
        assert!(take(&pieces, (ZBytes::new(), piece("a", usize::MAX).1), now).is_err());
        assert!(take(&pieces, (ZBytes::from(vec![0; PIECE]), ZBytes::from(b"?")), now).is_err());
        take(&pieces, piece("a", 0), now).unwrap();
        let longer = encode(&Piece { message: "a".into(), number: 0, size: SIZE + 1 });
        assert!(take(&pieces, (ZBytes::from(vec![0; PIECE]), ZBytes::from(longer)), now).is_err());
    }
}
